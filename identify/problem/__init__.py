"""The nonlinear least-squares problem: segments, unknowns, residuals, derivatives and the step."""

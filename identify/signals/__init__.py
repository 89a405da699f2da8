"""Pure functions of arrays: spectra, noise, the analytic signal, odds."""

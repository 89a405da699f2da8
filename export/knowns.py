"""Which inputs, states and start values an expression of the model depends on: FMI's dependencies."""

from __future__ import annotations

from ..model.equations import Equations, SurfaceKind, signed
from ..model.law import Expression


class Knowns:
    """Names of what expressions of the equations ``eq`` depend on."""

    def __init__(self, eq: Equations) -> None:
        import casadi as ca

        self._eq = eq
        states = {name: eq.z[i] for i, name in enumerate(eq.state_names)}
        self._knowns = {"F": eq.u, **states, "time": eq.t}
        starts = {}
        for i, name in enumerate(("x0", "v0", *(f"{name}0" for name in eq.state_names[2:]))):
            riders = [eq.z[k] for k, leader in enumerate(eq.follows) if leader == i]
            starts[name] = ca.vertcat(eq.z[i], *riders)
        parameters = {name: eq.p[i] for i, name in enumerate(eq.parameter_names)}
        self._initial = {"F": eq.u, **parameters, **starts, "time": eq.t}

    def of(self, expression: Expression) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of the inputs and states it is computed from; of inputs, parameters and start values at the start."""
        import casadi as ca

        written = signed(self._eq, expression)
        switched = bool(self._eq.kinds) and ca.depends_on(expression, self._eq.s)
        return (
            tuple(name for name, symbol in self._knowns.items() if ca.depends_on(written, symbol)),
            (
                *(name for name, symbol in self._initial.items() if ca.depends_on(written, symbol)),
                *(["smoothing"] if switched else []),
            ),
        )

    def of_event(self, eq: Equations, surface: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The same for an event indicator; at rest that of the velocity is how far the forces are from moving it."""
        import casadi as ca

        if eq.kinds[surface] is not SurfaceKind.VELOCITY:
            return self.of(eq.surfaces[surface])
        return self.of(ca.vertcat(eq.surfaces[surface], eq.zdot[1]))

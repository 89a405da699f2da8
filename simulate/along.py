"""One law evaluated along a measured motion, its inner states integrated with it, in generated C."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import engine
from ..model.law import Expression, Law, Motion
from .compiler import loaded_library
from .generated_c import generated_c
from .recursion import driven_by_lines

_DOUBLES = ctypes.POINTER(ctypes.c_double)
#: Rate of an inner state times the step: Heun's method is then good to a few per cent of that state.
_TURN = 0.5
_MOST_PARTS = 64


class Along:
    """What a law makes of a motion that is given.

    For a force law with strengths the values are its derivatives with respect to these, one column each (the
    force is proportional to them); else its force; for a law on the force's path the force that arrives, and behind it
    the derivatives with respect to strengths; for a sensor's curve that is learnt what these add to a displacement.
    """

    def __init__(self, law: Law, recorded: str = "displacement") -> None:
        import casadi as ca

        self.law = law
        x, v, t, u, a = (ca.SX.sym(name) for name in "xvtua")
        motion = Motion(x=x, v=v, t=t, recorded=recorded, a=a)
        p = ca.SX.sym("p", len(law.parameters))
        given = {parameter.name: p[i] for i, parameter in enumerate(law.parameters)}
        made: Expression = ca.SX(0)
        if law.drive:
            made = law.drive(motion, given, u)
        elif law.force:
            made = law.force(motion, given)
        elif law.record and law.learnt:
            made = law.record(motion, given, x)
        inner = ca.vertcat(ca.SX(0, 1), *motion.symbols)
        rates = ca.vertcat(ca.SX(0, 1), *motion.rates)
        strengths = [i for i, parameter in enumerate(law.parameters) if parameter.strength]
        slopes = ca.jacobian(made, p)[:, strengths].T
        if law.learnt and strengths:  # in proportion to its heights, but for a mass that these would make too small
            slopes = ca.substitute(slopes, p[strengths], ca.DM.zeros(len(strengths)))
        values = ca.vertcat(made, slopes) if law.drive else slopes if strengths else made
        turning = ca.densify(ca.jacobian(rates, inner)) if inner.numel() else ca.SX(0, 0)
        inputs = [inner, ca.vertcat(x, v, t, u), p, ca.vertcat(ca.SX(0, 1), *motion.signs)]
        #: Whether it does the same all the time, whatever the motion.
        self.constant = not ca.depends_on(values, ca.vertcat(x, v, t, u, a, inner, *motion.signs))
        self._carried = ca.depends_on(values, a)
        if self._carried:  # at the place of the recorded force, which no force of the motion is made of
            values = ca.substitute(values, a, u)
        self._slopes = ca.Function("slopes", inputs, [turning])
        self._reaches = ca.Function("reaches", [p], [ca.vertcat(ca.SX(0, 1), *motion.reaches)])
        self._signs = len(motion.signs)
        if motion.signs:
            plain = ca.vertcat(*[ca.sign(surface) for surface in motion.surfaces])
            values, rates = ca.substitute([values, rates], [ca.vertcat(*motion.signs)], [plain])
        self._filter = None if law.drive is None else _linear(inner, u, p, made, rates)
        z = ca.SX.sym("z", inner.numel())
        given_motion = ca.SX.sym("motion", 4)
        values, rates = ca.substitute([values, rates], [ca.vertcat(x, v, t, u)], [given_motion])
        if inner.numel():
            values, rates = ca.substitute([values, rates], [inner], [z])
        self.values = values.numel()
        self.phases = any(state.free for state in motion.states)
        self.follows = [{"displacement": 0, "velocity": 1}.get(state.follows or "") for state in motion.states]
        arguments = [z, given_motion, p]
        generator = ca.CodeGenerator("law.c", {"casadi_int": "int", "with_header": False})
        generator.add(ca.Function("dp_value", arguments, [ca.densify(values)]))
        generator.add(ca.Function("dp_rates", arguments, [ca.densify(rates)]))
        body = generated_c(generator)
        sizes = f"#define DP_INNER {inner.numel()}\n#define DP_VALUES {self.values}\n"
        head = '#define CASADI_SYMBOL_EXPORT static\n#include "law.c"\n'
        main = head + sizes + engine.included(engine.ALONG)
        sources = {"law.c": body, engine.ALONG: engine.text(engine.ALONG), "all.c": main}
        library = loaded_library(sources, "all.c")
        self._along = library.dp_along
        self._along.restype = None
        self._along.argtypes = [
            _DOUBLES,
            _DOUBLES,
            ctypes.c_long,
            ctypes.c_double,
            ctypes.c_int,
            _DOUBLES,
            _DOUBLES,
        ]

    def __call__(
        self,
        parameters: Mapping[str, float],
        motion: np.ndarray,
        dt: float,
        shift: np.ndarray | float = 0.0,
        parts: int | None = None,
    ) -> np.ndarray:
        """(values, n) along a motion.

        Args:
            parameters: of the law, by name.
            motion: (n, 4) displacement, velocity, time, force at points ``dt`` apart, in order of time.
            dt: s.
            shift: of the inner states at the first point from what they follow, (inner,) or one for all.
            parts: steps of the inner states from point to point; as many as they ask for where None.
        """
        motion = np.ascontiguousarray(motion, float)
        if self._carried:
            motion = np.column_stack([motion[:, :3], np.gradient(motion[:, 1], dt)])
        p = np.array([parameters[parameter.name] for parameter in self.law.parameters])
        begin = np.array([0.0 if leader is None else motion[0, leader] for leader in self.follows] or [0.0])
        begin += shift
        if self._filter is not None:
            system = tuple(np.array(part) for part in self._filter(p))
            return driven_by_lines(system, motion[:, 3], dt)[None, :]
        out = np.empty((motion.shape[0], self.values))
        parts = parts or self._parts(begin, motion, p, dt)
        self._along(
            p.ctypes.data_as(_DOUBLES),
            begin.ctypes.data_as(_DOUBLES),
            motion.shape[0],
            dt,
            parts,
            motion.ctypes.data_as(_DOUBLES),
            out.ctypes.data_as(_DOUBLES),
        )
        return out.T

    def rate(self, parameters: Mapping[str, float], motion: np.ndarray) -> float:
        """Rate in 1/s of the fastest inner state where a motion (n, 4) is fastest, at rest and at its reach."""
        if not self.follows:
            return 0.0
        p = np.array([parameters[parameter.name] for parameter in self.law.parameters])
        row, reach = motion[int(np.argmax(np.abs(motion[:, 1])))], np.array(self._reaches(p)).ravel()
        fastest = 0.0
        for place in (0.0 * reach, reach, -reach):
            for sign in (1.0, -1.0):
                matrix = np.array(self._slopes(place, row, p, [sign] * self._signs))
                if np.all(np.isfinite(matrix)):
                    fastest = max(fastest, float(np.max(np.abs(np.linalg.eigvals(matrix)))))
        return fastest

    def force(self, parameters: Mapping[str, float], motion: np.ndarray, dt: float) -> np.ndarray:
        """(n,) force per unit mass of a force law along a motion; arguments as above."""
        made = self(parameters, motion, dt)
        strengths = [parameters[p.name] for p in self.law.parameters if p.strength]
        return np.array(strengths) @ made if strengths else made[0]

    def _parts(self, begin: np.ndarray, motion: np.ndarray, p: np.ndarray, dt: float) -> int:
        """Steps from point to point: Heun's method must follow the fastest inner state on either side of a switch."""
        if not self.follows:
            return 1
        fastest = 0.0
        for sign in (1.0, -1.0):
            row = motion[int(np.argmax(np.abs(motion[:, 1])))]
            matrix = np.array(self._slopes(begin[: len(self.follows)], row, p, [sign] * self._signs))
            if np.all(np.isfinite(matrix)):
                fastest = max(fastest, float(np.max(np.abs(np.linalg.eigvals(matrix)))))
        return int(np.clip(np.ceil(fastest * dt / _TURN), 1, _MOST_PARTS))


def _linear(inner: Expression, force: Expression, p: Expression, made: Expression, rates: Expression) -> Any:
    """(p) -> A, B, C, D of ``inner' = A inner + B force``, ``made = C inner + D force``; None where not linear."""
    import casadi as ca

    if not inner.numel():
        return None
    known = ca.vertcat(inner, force)
    slopes = ca.jacobian(ca.vertcat(rates, made), known)
    free = [symbol for symbol in ca.symvar(ca.vertcat(rates, made)) if not ca.depends_on(ca.vertcat(known, p), symbol)]
    if free or ca.depends_on(slopes, known):  # the motion or a switch has a part in it
        return None
    count = inner.numel()
    parts = slopes[:count, :count], slopes[:count, count], slopes[count, :count], slopes[count, count]
    return ca.Function("linear", [p], [ca.densify(part) for part in parts])

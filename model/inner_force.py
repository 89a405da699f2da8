"""The force of all laws together, per unit mass, evaluated in numbers along a prescribed motion."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from .equations import SurfaceKind, equations, signed

if TYPE_CHECKING:
    from .oscillator import Oscillator


def without_memory(oscillator: Oscillator) -> tuple[Oscillator, Oscillator | None]:
    """What pulls at the mass, apart: the laws that depend on displacement and velocity, and those with a memory.

    Laws of the drive and of the sensor are no part of either, nor are forces that nobody recorded (of free phase).

    Returns:
        The oscillator with the former only, and one whose terms are the latter only (its Eq. 17 is to be ignored), or
        None where there is no such law.
    """
    eq = equations(oscillator)
    owners = [name.rpartition(".")[0] for name in eq.state_names[2:]]
    outside = {owner for owner, state in zip(owners, eq.inner, strict=True) if state.free}
    forces = [term for term in oscillator.terms if term.law.force and term.effect not in outside]
    plain = tuple(term for term in forces if term.effect not in owners)
    memory = tuple(term for term in forces if term.effect in owners)
    return replace(oscillator, terms=plain), replace(oscillator, terms=memory) if memory else None


class InnerForce:
    """All laws of one oscillator with its values: what stands in the bracket of Eq. 17 beside the acceleration.

    Laws that depend on time are taken at t = 0; those of the drive and of the sensor have no part in it. Raises
    BadInput for laws with a memory (further states): their force does not follow from displacement and velocity.
    """

    def __init__(self, oscillator: Oscillator) -> None:
        import casadi as ca

        oscillator, memory = without_memory(oscillator)
        if memory is not None:
            raise BadInput(
                f"the force of {' and '.join(t.effect for t in memory.terms)} depends on the motion before: it is "
                "no function of displacement and velocity; use the describing functions, or simulate the model"
            )
        eq = equations(oscillator)
        values = oscillator.values()
        known = ca.vertcat(eq.t, eq.u, eq.u_rate, eq.p)
        given = ca.DM([0.0, 0.0, 0.0, *(values[name] for name in eq.parameter_names)])
        a = ca.SX.sym("a")
        force = (eq.moving - 1) * a - eq.moving * eq.zdot[1]  # at u = 0 the acceleration is minus the inner force
        force, moving = (ca.substitute(part, known, given) for part in (force, ca.SX(eq.moving)))
        #: Whether a mass beyond that of Eq. 17 moves, whose force is in proportion to the acceleration.
        self.carries = not eq.moving.is_constant()
        self._moving = ca.Function("moving", [eq.z], [ca.densify(moving)])
        surfaces = ca.substitute(signed(eq, eq.surfaces), known, given)
        self._force = ca.Function("force", [eq.z, eq.s, a], [force])
        self._surfaces = ca.Function("surfaces", [eq.z], [surfaces])
        self._no_signs = ca.DM(0, 1)
        self._on_velocity = np.array([kind == SurfaceKind.VELOCITY for kind in eq.kinds], dtype=bool)

    def surfaces(self, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Switching functions (surfaces, m) at displacements and velocities (m,)."""
        if not self._on_velocity.size:
            return np.zeros((0, x.size))
        return np.array(self._surfaces(np.stack([x, v])))

    def __call__(self, x: np.ndarray, v: np.ndarray, a: np.ndarray | None = None) -> np.ndarray:
        """Force per unit mass at displacements, velocities and accelerations of any one shape, in their unit per s².

        Without accelerations these are zero; only a mass beyond that of Eq. 17 feels them.
        """
        z = np.stack([np.ravel(x), np.ravel(v)])
        return self._evaluate(z, np.sign(self.surfaces(z[0], z[1])), a).reshape(x.shape)

    def moving(self, x: np.ndarray) -> np.ndarray:
        """The mass that moves at displacements of any shape, in parts of that of Eq. 17."""
        return np.array(self._moving(np.stack([np.ravel(x), np.zeros(x.size)]))).reshape(x.shape)

    def static(self, x: np.ndarray) -> np.ndarray:
        """Force at rest without friction: velocity zero, and every sign of the velocity zero too."""
        z = np.stack([np.ravel(x), np.zeros(x.size)])
        s = np.sign(self.surfaces(z[0], z[1]))
        s[self._on_velocity] = 0.0
        return self._evaluate(z, s).reshape(x.shape)

    def _evaluate(self, z: np.ndarray, s: np.ndarray, a: np.ndarray | None = None) -> np.ndarray:
        pulled = 0.0 if a is None else np.ravel(a)[None]
        return np.array(self._force(z, s if s.size else self._no_signs, pulled))

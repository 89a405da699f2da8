"""The force of a model's laws along a motion that is given, with its slopes: what a smoother linearises."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ...model import Oscillator
from ...model.equations import equations, signed
from ...model.library import find
from ...model.oscillator import Term
from ...simulate.along import Along


@cache
def along_law(effect: str) -> Along:
    """A law of the library in C, for evaluation along a motion; built once.

    Without strengths: ``Along`` would give the derivatives with respect to these, which leave out what else it does.
    """
    law = find(effect)
    plain = tuple(replace(parameter, strength=False) for parameter in law.parameters)
    return Along(replace(law, parameters=plain))


def numbers(term: Term) -> dict[str, float]:
    """Values of a term's parameters, by name."""
    return {name: parameter.value for name, parameter in term.parameters.items()}


def term_force(term: Term, motion: np.ndarray, dt: float) -> np.ndarray:
    """(n,) force per unit mass of one term along a motion (n, 4) as ``Along`` takes it.

    For a law on the force's path the force that arrives. Inner states begin where they follow, phases at zero.
    """
    return along_law(term.effect)(numbers(term), motion, dt)[0]


class OwnForce:
    """All force laws of an oscillator with its values.

    Eq. 17 with its slopes in displacement and velocity, its signs as they are; of further terms the force alone.
    """

    def __init__(self, oscillator: Oscillator) -> None:
        import casadi as ca

        self.terms = tuple(term for term in oscillator.terms if term.law.force is not None)
        eq = equations(replace(oscillator, terms=(), response=replace(oscillator.response, quantity="displacement")))
        values = oscillator.values()
        known = ca.vertcat(eq.t, eq.u, eq.u_rate, eq.p)
        given = ca.DM([0.0, 0.0, 0.0, *(values[name] for name in eq.parameter_names)])
        force = -eq.zdot[1]  # at u = 0 the acceleration is minus the inner force
        slopes = ca.jacobian(force, eq.z)
        expressions = ca.substitute([signed(eq, force), signed(eq, ca.densify(slopes))], [known], [given])
        self._function = ca.Function("own_force", [eq.z], expressions)

    def __call__(self, motion: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Force per unit mass (n,) and its slopes in displacement (n,), 1/s², and velocity (n,), 1/s.

        Args:
            motion: (n, 4) displacement, velocity, time, force, ``dt`` apart.
            dt: s.
        """
        force, slopes = self._function(motion[:, :2].T)
        force = np.array(force).ravel()
        slopes = np.array(slopes)  # one (1, 2) block a point, side by side
        for term in self.terms:
            force = force + term_force(term, motion, dt)
        return force, slopes[0, 0::2], slopes[0, 1::2]

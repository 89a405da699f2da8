"""A spring force that is learnt from the motion, where no law of the library has its shape.

The stiffness changes from one level to another as the displacement passes three places, a factor of five apart, and so
does its difference between the two sides at two of them. Beyond the largest motion that was recorded it goes on
without turning over, as a polynomial would not.
"""

from collections.abc import Mapping

from ..law import Expression, Law, LawParameter, Motion

#: Where the stiffness changes, as parts of the reach: within the motion and beyond, a factor of five apart.
PLACES = {"near": 0.1, "middle": 0.5, "far": 2.5}
_SIDES = {"side-near": 0.1, "side-far": 2.5}


def _force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
    import casadi as ca

    u = motion.x / p["reach"]
    even = sum(p[name] * u**2 / (u**2 + place**2) for name, place in PLACES.items())
    odd = sum(p[name] * u / ca.sqrt(u**2 + place**2) for name, place in _SIDES.items())
    return motion.x * (even + odd)


def _stored(motion: Motion, p: Mapping[str, Expression]) -> Expression:
    """The integral of the force over the displacement."""
    import casadi as ca

    u = motion.x / p["reach"]
    energy = sum(p[name] * (u**2 - place**2 * ca.log1p(u**2 / place**2)) / 2 for name, place in PLACES.items()) + sum(
        p[name] * (u * ca.sqrt(u**2 + place**2) - place**2 * ca.asinh(u / place)) / 2 for name, place in _SIDES.items()
    )
    return p["reach"] ** 2 * energy


LAW = Law(
    name="free/spring",
    path="restoring",
    parameters=(
        LawParameter("near", "1/s2", "stiffness per unit mass that sets in at a tenth of the reach", strength=True),
        LawParameter("middle", "1/s2", "the same at half the reach", strength=True),
        LawParameter("far", "1/s2", "the same at 2.5 times the reach", strength=True),
        LawParameter("side-near", "1/s2", "stiffness that one side has more, at a tenth of the reach", strength=True),
        LawParameter("side-far", "1/s2", "the same at 2.5 times the reach", strength=True),
        LawParameter("reach", "X", "largest displacement of the recordings", 1e-12, probes=(1.0,), scale=True),
    ),
    force=_force,
    stored=_stored,
    equation="x ({near} u²/(u² + 0.01) + {middle} u²/(u² + 0.25) + {far} u²/(u² + 6.25) "
    "+ {side-near} u/sqrt(u² + 0.01) + {side-far} u/sqrt(u² + 6.25)); u = x / {reach}",
    sentence="A spring force learnt from the motion, of any smooth shape: how it differs from Eq. 17 is known, its "
    "cause is not.",
    phrase="a spring force of a shape that no law of the library has",
    source="regression on bounded functions of the displacement; Worden and Tomlinson 2001, chapter 7",
    curves="The backbone takes any smooth shape; with a stiffness that differs between the sides the middle of the "
    "motion moves with the amplitude.",
    learnt=True,
)

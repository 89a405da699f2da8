"""A damping that is learnt from the motion, where no law of the library has its shape.

The damping changes from one level to another as the motion passes three sizes, a factor of five apart. The size is that
of displacement and speed together, which of a rig that swings is its amplitude at every instant: what a damping
that depends on the place and one that depends on the speed do to the decay, it does too.
"""

from collections.abc import Mapping

from ..law import Expression, Law, LawParameter, Motion
from .free_spring import PLACES


def _force(motion: Motion, p: Mapping[str, Expression]) -> Expression:
    size = (motion.x / p["reach"]) ** 2 + (motion.v / p["speed"]) ** 2
    return motion.v * sum(p[name] * size / (size + place**2) for name, place in PLACES.items())


LAW = Law(
    name="free/damping",
    path="dissipation",
    parameters=(
        LawParameter("near", "1/s", "damping per unit mass that sets in at a tenth of the reach", strength=True),
        LawParameter("middle", "1/s", "the same at half the reach", strength=True),
        LawParameter("far", "1/s", "the same at 2.5 times the reach", strength=True),
        LawParameter("reach", "X", "largest displacement of the recordings", 1e-12, probes=(1.0,), scale=True),
        LawParameter("speed", "X/s", "its speed", 1e-12, probes=(1.0,), scale=True),
    ),
    force=_force,
    equation="x' ({near} a²/(a² + 0.01) + {middle} a²/(a² + 0.25) "
    "+ {far} a²/(a² + 6.25)); "
    "a² = (x / {reach})² + (x' / {speed})²",
    sentence="A damping learnt from the motion, of any smooth course over the amplitude: how it differs from Eq. 17 is "
    "known, its cause is not.",
    phrase="a damping whose course over the amplitude no law of the library has",
    source="regression on bounded functions of the amplitude; Feldman 2011, chapter 10, for damping over amplitude",
    curves="The damping curve takes any smooth shape; the backbone stays.",
    learnt=True,
)

"""Viscous friction that is larger in one direction.

It stores nothing. Being half a difference, it takes power in one direction and gives as much of the ordinary viscous
damping's back in the other: only the two together never give.
"""

from ..law import Law, LawParameter

LAW = Law(
    name="asymmetric-friction",
    path="dissipation",
    parameters=(
        LawParameter("viscous", "1/s", "half the difference of the viscous damping of both directions", strength=True),
    ),
    force=lambda motion, p: p["viscous"] * motion.v * motion.sign(motion.v),
    equation="{viscous} |x'|",
    sentence="Damping that is larger in one direction than in the other, as of a valve or a one-way damper.",
    phrase="friction that is larger in one direction",
    source="Feldman 2011, chapter on asymmetric systems",
    curves="The mean of the motion shifts with its amplitude; backbone and damping curve stay in first order.",
)

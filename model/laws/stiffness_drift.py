"""A spring that changes steadily during the record.

It stores as a spring of its present stiffness does; what the change of stiffness feeds in, ``rate x²/2`` per unit mass,
is negative dissipated power.
"""

from ..law import Law, LawParameter

LAW = Law(
    name="stiffness-drift",
    path="environment",
    parameters=(
        LawParameter(
            "rate",
            "1/s3",
            "change of stiffness per unit mass and second",
            strength=True,
            size=lambda s: s.omega**2 / s.duration,
        ),
    ),
    force=lambda motion, p: p["rate"] * motion.t * motion.x,
    stored=lambda motion, p: p["rate"] * motion.t * motion.x**2 / 2,
    equation="{rate} t x",
    sentence="The spring changes while it is being recorded: it warms up, creeps or loosens.",
    phrase="a spring that changes during the record",
    source="Mathieu and Hill type of slow parameter change, Nayfeh and Mook 1979, section 5.1",
    curves="Each record has a backbone that moves with time; early and late passes of the same amplitude disagree.",
)

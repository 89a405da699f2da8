"""A spring that goes over to another stiffness during the record.

It stores as a spring of its present stiffness does; what the change of stiffness feeds in is negative dissipated power.
"""

from ..law import Expression, Law, LawParameter


def _stiffness(motion, p) -> Expression:
    import casadi as ca

    return p["change"] * (1 - ca.exp(-motion.t / p["time"]))


LAW = Law(
    name="stiffness-drift/settling",
    path="environment",
    parameters=(
        LawParameter("change", "1/s2", "change of stiffness in the long run, per unit mass", strength=True),
        LawParameter("time", "s", "time constant", lower=1e-9, probes=(0.1, 0.3), size=lambda s: s.duration),
    ),
    force=lambda motion, p: _stiffness(motion, p) * motion.x,
    stored=lambda motion, p: _stiffness(motion, p) * motion.x**2 / 2,
    equation="{change} (1 - exp(-t / {time})) x",
    sentence="The spring goes over to another stiffness during the record, fast at first: it warms up or settles.",
    phrase="a spring that settles at another stiffness during the record",
    source="first-order warming, Incropera and DeWitt 2007, section 5.1",
    curves="Each record has a backbone that moves with time and comes to rest.",
)

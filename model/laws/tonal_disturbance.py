"""A periodic force that nobody recorded: what it feeds in is negative dissipated power."""

from ..law import Expression, Law, LawParameter


def _force(motion, p) -> Expression:
    import casadi as ca

    phase = motion.state("phase", "rad", free=True)
    motion.rate(phase, p["frequency"])
    return -p["amplitude"] * ca.cos(phase)


LAW = Law(
    name="tonal-disturbance",
    path="environment",
    parameters=(
        LawParameter("amplitude", "X/s2", "amplitude of the force per unit mass", strength=True),
        LawParameter("frequency", "rad/s", "its frequency", lower=0.0, probes="lines"),
    ),
    force=_force,
    equation="-{amplitude} cos({frequency} t + phase)",
    sentence="A periodic force that was not recorded: a fan, a pump, the mains; its phase is another in each record.",
    phrase="a periodic force that was not recorded",
    source="Den Hartog 1956, section 2.5",
    curves="None; a line at one frequency in every record, whatever the force.",
)

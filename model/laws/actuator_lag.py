"""An amplifier or actuator that follows its command with a lag."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    follower = motion.state("force", "Q")
    motion.rate(follower, (force - follower) / p["time"])
    return follower


LAW = Law(
    name="actuator-lag",
    path="excitation",
    parameters=(LawParameter("time", "s", "time constant", lower=1e-9, probes=(0.1,)),),
    drive=_drive,
    equation="F → G, {time} G' = F - G",
    sentence="The force reaches the mass later and weaker than recorded: an amplifier or coil with a lag of first "
    "order.",
    phrase="a force that reaches the mass with a lag",
    source="textbook low-pass of first order, Franklin, Powell, Emami-Naeini 2015, section 3.3",
    curves="None in free decay; in forced records the damping seems larger or smaller by the work of the late force.",
)

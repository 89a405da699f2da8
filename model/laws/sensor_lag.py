"""A sensor or filter that follows the motion with a lag."""

from ..law import Expression, Law, LawParameter


def _record(motion, p, signal) -> Expression:
    follower = motion.state("signal", "Y", follows=motion.recorded)
    motion.rate(follower, (signal - follower) / p["time"])
    return follower


LAW = Law(
    name="sensor-lag",
    path="measurement",
    parameters=(LawParameter("time", "s", "time constant", lower=1e-9, probes=(0.1,)),),
    record=_record,
    equation="record r → s, {time} s' = r - s",
    sentence="The record shows the motion later and smaller than it is: a sensor or filter with a lag of first order.",
    phrase="a sensor that follows the motion with a lag",
    source="textbook low-pass of first order, Franklin, Powell, Emami-Naeini 2015, section 3.3",
    curves="In forced records the same as a late force; in free decay it hardly shows.",
)

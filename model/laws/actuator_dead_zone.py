"""A force that must exceed a threshold before any of it arrives."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    return motion.beyond(force - p["threshold"]) - motion.beyond(-force - p["threshold"])


LAW = Law(
    name="actuator-dead-zone",
    path="excitation",
    parameters=(LawParameter("threshold", "Q", "force of which nothing arrives", lower=0.0, probes=(0.02, 0.08, 0.2)),),
    drive=_drive,
    equation="F → F - {threshold} sgn(F) beyond ±{threshold}, else nothing",
    sentence="Small forces do not reach the mass: a valve overlap, a crossover in the amplifier, a slack coupling.",
    phrase="a dead zone of the actuator in which small forces are lost",
    source="Gelb and Vander Velde 1968, section 2.3",
    curves="None in free decay; at low levels the response is smaller than the recorded force makes it.",
)

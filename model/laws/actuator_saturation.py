"""An actuator that gives no more than so much."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    return force - motion.beyond(force - p["limit"]) + motion.beyond(-force - p["limit"])


LAW = Law(
    name="actuator-saturation",
    path="excitation",
    parameters=(LawParameter("limit", "Q", "largest force", lower=0.0, probes=(0.95, 0.85, 0.7, 0.5)),),
    drive=_drive,
    equation="F → F, but no more than ±{limit}",
    sentence="The actuator gives no more than a certain force, whatever was recorded: an amplifier at its limit.",
    phrase="an actuator that gives no more than a certain force",
    source="Gelb and Vander Velde 1968, section 2.3",
    curves="None in free decay; at high levels the response is smaller than the recorded force makes it.",
)

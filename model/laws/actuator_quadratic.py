"""A force that grows with the square of its command, as a propeller's thrust or the pull of a magnet."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    size = motion.sign(force) * force
    return force + p["part"] * (size / p["level"] - 1) * force


LAW = Law(
    name="actuator-quadratic",
    path="excitation",
    parameters=(
        LawParameter(
            "part", "1", "part of the force that grows with its square", 0.0, 1.0, probes=(0.3, 1.0), strength=True
        ),
        LawParameter("level", "Q", "largest force of the recordings", lower=1e-12, probes=(1.0,), scale=True),
    ),
    drive=_drive,
    equation="F → F + {part} (|F| / {level} - 1) F",
    sentence="The force grows with the square of its command, in part or wholly: the thrust of a propeller over its "
    "speed, the pull of a magnet over its current.",
    phrase="a force that grows with the square of its command",
    source="momentum theory of the propeller, Glauert 1935; Maxwell's stress of a magnet",
    curves="None in free decay; at low levels the response is smaller than the recorded force makes it.",
)

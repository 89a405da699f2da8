"""A pure delay between force and response channel."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    """Padé's all-pass (120 - 60 q + 12 q² - q³) / (120 + 60 q + 12 q² + q³), q = s delay, in controllable form."""
    fast = 1 / p["delay"]
    a, b, c = (motion.state(f"force-{i}", "Q") for i in "abc")
    motion.rate(a, fast * b)
    motion.rate(b, fast * c)
    motion.rate(c, fast * (force - 12 * c - 60 * b - 120 * a))
    return 240 * a + 24 * c - force


LAW = Law(
    name="time-delay",
    path="either",
    parameters=(LawParameter("delay", "s", "by how much the response is late", lower=1e-9, probes=(0.1,)),),
    drive=_drive,
    equation="F → F(t - {delay})",
    sentence="Force and response were not recorded at the same instant: a delay of the electronics or of a digital "
    "filter.",
    phrase="a delay between the recorded force and the recorded motion",
    source="Padé approximation of third order, its phase right to (omega delay)^7 / 100800 rad; Baker and "
    "Graves-Morris 1996",
    curves="None in free decay; in forced records the phase falls in proportion to the frequency.",
)

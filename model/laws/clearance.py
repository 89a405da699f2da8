"""A spring that touches only after a gap has closed, on both sides alike."""

from ..law import Law, LawParameter

LAW = Law(
    name="clearance",
    path="restoring",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness beyond the gap per unit mass", strength=True, lower=0.0),
        LawParameter("gap", "X", "half of the free play", lower=0.0, probes=(0.1, 0.25, 0.4, 0.55, 0.7, 0.85)),
    ),
    force=lambda motion, p: p["stiffness"] * (motion.beyond(motion.x - p["gap"]) - motion.beyond(-motion.x - p["gap"])),
    equation="{stiffness} (x beyond ±{gap})",
    sentence="A part of the spring, no stiffer than the rest, that acts only beyond a free play on both sides.",
    source="Feldman 2011, Hilbert Transform Applications in Mechanical Vibration, chapter on piecewise springs",
    curves="The backbone is flat up to the gap and rises beyond it towards sqrt(omega0² + stiffness), with a corner "
    "at the gap; the damping curve stays.",
    proper=lambda p, base: p["stiffness"] <= base["omega0"] ** 2,
    twin="two-sided-stop",
)

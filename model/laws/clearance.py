"""A spring that touches only after a gap has closed, on both sides alike."""

from ..law import Expression, Law, LawParameter


def _depths(motion, p) -> tuple[Expression, Expression]:
    return motion.x - p["gap"], -motion.x - p["gap"]


def _force(motion, p) -> Expression:
    right, left = _depths(motion, p)
    return p["stiffness"] * (motion.beyond(right) - motion.beyond(left))


def _stored(motion, p) -> Expression:
    return p["stiffness"] * sum(depth * motion.beyond(depth) for depth in _depths(motion, p)) / 2


LAW = Law(
    name="clearance",
    path="restoring",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness beyond the gap per unit mass", strength=True, lower=0.0),
        LawParameter("gap", "X", "half of the free play", lower=0.0, probes=(0.1, 0.25, 0.4, 0.55, 0.7, 0.85)),
    ),
    force=_force,
    stored=_stored,
    equation="{stiffness} (x beyond ±{gap})",
    sentence="A part of the spring, no stiffer than the rest, that acts only beyond a free play on both sides.",
    phrase="a part of the spring that acts only beyond a gap on both sides",
    source="Feldman 2011, Hilbert Transform Applications in Mechanical Vibration, chapter on piecewise springs",
    curves="The backbone is flat up to the gap and rises beyond it towards sqrt(omega0² + stiffness), with a corner "
    "at the gap; the damping curve stays.",
    proper=lambda p, base: p["stiffness"] <= base["omega0"] ** 2,
    twin="two-sided-stop",
)

"""A part of the spring that saturates: a magnet, a joint that begins to slip, a membrane."""

from ..law import Expression, Law, LawParameter


def _saturating(motion, p) -> Expression:
    import casadi as ca

    return p["stiffness"] * p["width"] * ca.tanh(motion.x / p["width"])


def _stored(motion, p) -> Expression:
    """``stiffness width² ln cosh(x / width)``, so that neither large nor small displacements lose it."""
    import casadi as ca

    size = ca.fabs(motion.x / p["width"])
    return p["stiffness"] * p["width"] ** 2 * (size + ca.log1p(ca.expm1(-2 * size) / 2))


LAW = Law(
    name="softening-stiffness",
    path="restoring",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness of that part at rest per unit mass", strength=True, lower=0.0),
        LawParameter("width", "X", "displacement at which it gives way", lower=1e-12, probes=(0.1, 0.25, 0.5, 1.0)),
    ),
    force=_saturating,
    stored=_stored,
    equation="{stiffness} {width} tanh(x / {width})",
    sentence="A part of the spring that gives way: it pulls in proportion at first and saturates beyond a "
    "displacement.",
    phrase="a part of the spring that gives way at large displacements",
    source="Kovacic and Rand 2013 on saturating restoring forces; tanh as the simplest monotonic one",
    curves="The backbone falls from sqrt(omega0² + stiffness) at rest to omega0 at large amplitudes; the damping "
    "curve stays.",
)

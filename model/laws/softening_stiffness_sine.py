"""A part of the spring that bends over, as gravity on a pendulum or a magnet's detent does."""

from ..law import Expression, Law, LawParameter


def _bending(motion, p) -> Expression:
    import casadi as ca

    return p["stiffness"] * p["width"] * ca.sin(motion.x / p["width"])


def _stored(motion, p) -> Expression:
    """``stiffness width² (1 - cos(x / width))``, by the half angle so that small displacements do not lose it."""
    import casadi as ca

    return 2 * p["stiffness"] * (p["width"] * ca.sin(motion.x / p["width"] / 2)) ** 2


LAW = Law(
    name="softening-stiffness/sine",
    path="restoring",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness of that part at rest per unit mass", strength=True, lower=0.0),
        LawParameter("width", "X", "displacement of one radian", lower=1e-12, probes=(0.3, 0.5, 0.8), in_radians=1.0),
    ),
    force=_bending,
    stored=_stored,
    equation="{stiffness} {width} sin(x / {width})",
    sentence="A part of the spring that bends over and turns round, as gravity on a pendulum does.",
    phrase="a part of the spring that bends over as gravity on a pendulum does",
    source="Nayfeh and Mook 1979, section 2.1 (pendulum)",
    curves="The squared backbone frequency loses stiffness (1 - 2 J1(A/width) width/A); the damping curve stays.",
)

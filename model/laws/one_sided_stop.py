"""A stop on one side: contact beyond a position.

It stores in its spring alone. A mass that leaves faster than the contact can follow takes nothing of that back: it then
goes into the contact's damper.
"""

from ..law import Expression, Law, LawParameter


def _depth(motion, p) -> tuple[Expression, Expression]:
    """On which side it is, and how far the mass is beyond it."""
    import casadi as ca

    side = ca.if_else(p["position"] < 0, -1, 1)
    return side, side * motion.x - ca.fabs(p["position"])


def _contact(motion, p) -> Expression:
    side, depth = _depth(motion, p)
    push = p["stiffness"] * depth + p["damping"] * side * motion.v
    return side * 0.5 * (1 + motion.sign(depth)) * motion.beyond(push)  # it pushes and never pulls


def _stored(motion, p) -> Expression:
    _, depth = _depth(motion, p)
    return p["stiffness"] * depth * motion.beyond(depth) / 2


LAW = Law(
    name="one-sided-stop",
    path="restoring",
    parameters=(
        LawParameter("stiffness", "1/s2", "contact stiffness per unit mass", strength=True, lower=0.0),
        LawParameter(
            "position",
            "X",
            "where the contact begins; negative: on the negative side",
            probes=(-0.85, -0.65, -0.45, -0.25, 0.25, 0.45, 0.65, 0.85),
        ),
        LawParameter("damping", "1/s", "contact damping per unit mass", strength=True, lower=0.0),
    ),
    force=_contact,
    stored=_stored,
    equation="({stiffness} (x - {position}) + {damping} x' beyond {position})",
    sentence="A stop or a second spring on one side only, which the mass reaches beyond a certain position.",
    phrase="a stop on one side",
    source="Shaw and Holmes 1983; contact as a spring and damper (Goldsmith 1960)",
    curves="The backbone is flat up to the position and rises beyond it; the motion is pushed to the free side; "
    "contact damping lifts the damping curve beyond the position.",
)

"""Stops on both sides: contact stiffer than the spring itself.

They store in their springs alone. A mass that leaves faster than the contact can follow takes nothing of that back: it
then goes into the contact's damper.
"""

from ..law import Expression, Law, LawParameter


def _depth(motion, p, side: int) -> Expression:
    return side * (motion.x - p["offset"]) - p["position"]


def _contact(motion, p) -> Expression:
    def push(side: int) -> Expression:
        """Of one contact, which never pulls."""
        depth = _depth(motion, p, side)
        law = p["stiffness"] * depth + p["damping"] * side * motion.v
        return 0.5 * (1 + motion.sign(depth)) * motion.beyond(law)

    return push(1) - push(-1)


def _stored(motion, p) -> Expression:
    depths = [_depth(motion, p, side) for side in (1, -1)]
    return p["stiffness"] * sum(depth * motion.beyond(depth) for depth in depths) / 2


def _cases(p) -> list[tuple[str, dict[str, float]]]:
    """The stop on either side alone, for where the other is never touched; both about the middle, undamped."""
    positions = [p["offset"] + side * p["position"] for side in (1, -1)]
    contact = {name: p[name] for name in ("stiffness", "damping")}
    single = [
        ("one-sided-stop", contact | {"position": position})
        for side, position in zip((1, -1), positions, strict=True)
        if side * position > 0  # a stop's side is the sign of its position
    ]
    return [*single, ("clearance", {"stiffness": p["stiffness"], "gap": p["position"]})]


LAW = Law(
    name="two-sided-stop",
    path="restoring",
    parameters=(
        LawParameter("stiffness", "1/s2", "contact stiffness per unit mass", strength=True, lower=0.0),
        LawParameter("position", "X", "where the contact begins", lower=0.0, probes=(0.25, 0.45, 0.65, 0.85)),
        LawParameter("damping", "1/s", "contact damping per unit mass", strength=True, lower=0.0),
        LawParameter("offset", "X", "middle between the stops", probes=(0.0,), shape=True),
    ),
    force=_contact,
    stored=_stored,
    equation="({stiffness} d + {damping} x' where d = x - {offset} is beyond ±{position})",
    sentence="Stops on both sides: a contact, stiffer than the spring, that the mass reaches beyond a certain "
    "amplitude.",
    phrase="stops on both sides",
    source="Shaw and Holmes 1983; contact as a spring and damper (Goldsmith 1960)",
    curves="The backbone is flat up to the position and rises steeply beyond it; contact damping lifts the damping "
    "curve there.",
    proper=lambda p, base: p["stiffness"] > base["omega0"] ** 2,
    cases=_cases,
)

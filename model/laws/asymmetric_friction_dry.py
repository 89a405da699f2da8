"""Dry friction that is larger in one direction.

It stores nothing, unlike the constant force of the same equation: it takes power in one direction and gives as much of
the ordinary dry friction's back in the other. Over a cycle both are the same.
"""

from ..law import Law, LawParameter

LAW = Law(
    name="asymmetric-friction/dry",
    path="dissipation",
    parameters=(
        LawParameter("dry", "X/s2", "half of what dry friction backwards is larger than forwards", strength=True),
    ),
    force=lambda motion, p: -p["dry"],
    equation="-{dry}",
    sentence="Dry friction that is larger in one direction: for every motion the same as a constant force.",
    phrase="dry friction that is larger in one direction",
    source="d - a forwards and d + a backwards is d sgn(v) - a, also at rest",
    curves="As of a constant force.",
    # friction is negative in neither direction
    proper=lambda p, base: abs(p["dry"]) <= base["dry"],
    twin="constant-force",
)

"""The viscous friction of Eqs. 7 and 17."""

from ..law import Law, LawParameter

LAW = Law(
    name="viscous-damping",
    path="dissipation",
    parameters=(LawParameter("viscous", "1/s", "viscous damping per unit mass, 2 h"),),
    force=lambda motion, p: p["viscous"] * motion.v,
    equation="{viscous} x'",
    sentence="Damping in proportion to the velocity.",
    phrase="damping in proportion to the speed",
    source="Feldman, Bucher, Rotberg, Eqs. 7 and 16 (viscous = 2 h)",
    curves="Lifts the damping curve evenly, by half of itself; the backbone stays.",
)

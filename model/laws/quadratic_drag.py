"""Drag that grows with the square of the velocity."""

from ..law import Law, LawParameter

LAW = Law(
    name="quadratic-drag",
    path="dissipation",
    parameters=(LawParameter("coefficient", "1/X", "quadratic drag per unit mass"),),
    force=lambda motion, p: p["coefficient"] * motion.v * motion.v * motion.sign(motion.v),
    equation="coefficient x'|x'|",
    sentence="Drag of a body moved fast through a fluid, growing with the square of the velocity.",
    source="Feldman 1997; Faltinsen 1990 (roll damping of ships)",
)

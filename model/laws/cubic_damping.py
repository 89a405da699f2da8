"""Damping that grows with the cube of the velocity."""

from ..law import Law, LawParameter

LAW = Law(
    name="cubic-damping",
    path="dissipation",
    parameters=(LawParameter("coefficient", "s/X2", "cubic damping per unit mass"),),
    force=lambda motion, p: p["coefficient"] * motion.v**3,
    equation="coefficient x'³",
    sentence="Damping that grows with the cube of the velocity, as in some dampers and seals.",
    source="Nayfeh and Mook 1979, section 3.3",
)

"""The quadratic spring: asymmetry."""

from ..law import Law, LawParameter

LAW = Law(
    name="quadratic-stiffness",
    path="restoring",
    parameters=(LawParameter("coefficient", "1/(X.s2)", "quadratic stiffness per unit mass"),),
    force=lambda motion, p: p["coefficient"] * motion.x**2,
    equation="coefficient x²",
    sentence="A spring that is stiffer on one side than on the other.",
    source="Nayfeh and Mook 1979, section 2.3",
)

"""The quintic spring: the next term of Eq. 3."""

from ..law import Law, LawParameter

LAW = Law(
    name="quintic-stiffness",
    path="restoring",
    parameters=(LawParameter("coefficient", "1/(X4.s2)", "quintic stiffness per unit mass"),),
    force=lambda motion, p: p["coefficient"] * motion.x**5,
    equation="coefficient x⁵",
    sentence="A spring that stiffens with the fourth power of the displacement.",
    source="Feldman, Bucher, Rotberg, Eqs. 3 and 6 (alpha5)",
)

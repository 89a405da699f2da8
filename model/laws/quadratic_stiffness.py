"""A spring that is stiffer on one side than on the other."""

from ..law import Law, LawParameter

LAW = Law(
    name="quadratic-stiffness",
    path="restoring",
    parameters=(LawParameter("coefficient", "1/(X.s2)", "quadratic stiffness per unit mass", strength=True),),
    force=lambda motion, p: p["coefficient"] * motion.x**2,
    stored=lambda motion, p: p["coefficient"] * motion.x**3 / 3,
    equation="{coefficient} x²",
    sentence="A spring that is stiffer on one side than on the other, as under a static load or with curvature.",
    phrase="a spring that is stiffer on one side than on the other",
    source="Nayfeh and Mook 1979, section 4.1",
    curves="The backbone bends down whatever the sign, by 5 c²/(12 omega0⁴) of itself per squared amplitude, and the "
    "motion shifts to the soft side; the damping curve stays.",
)

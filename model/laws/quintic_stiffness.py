"""Hardening or softening that grows faster than the cubic."""

from ..law import Law, LawParameter

LAW = Law(
    name="quintic-stiffness",
    path="restoring",
    parameters=(LawParameter("coefficient", "1/(X4.s2)", "quintic stiffness per unit mass", strength=True),),
    force=lambda motion, p: p["coefficient"] * motion.x**5,
    stored=lambda motion, p: p["coefficient"] * motion.x**6 / 6,
    equation="{coefficient} x⁵",
    sentence="Hardening (or softening) that grows faster than the cubic, felt at the largest amplitudes only.",
    phrase="a spring whose stiffness changes with the fourth power of the displacement",
    source="Feldman, Bucher, Rotberg, Eq. 6 (fourth power of the amplitude)",
    curves="Adds 5/8 c A⁴ to the squared backbone frequency; the damping curve stays.",
)

"""Damping that grows away from the middle."""

from ..law import Law, LawParameter

LAW = Law(
    name="displacement-dependent-damping",
    path="dissipation",
    parameters=(LawParameter("coefficient", "1/(X2.s)", "damping per squared displacement", strength=True),),
    force=lambda motion, p: p["coefficient"] * motion.x**2 * motion.v,
    equation="{coefficient} x² x'",
    sentence="Viscous damping that grows away from the middle, as of a squeezed film, a magnet or stretched cables.",
    phrase="viscous damping that depends on the displacement",
    source="van der Pol 1926; Nayfeh and Mook 1979, section 3.3",
    curves="The damping curve rises with the squared amplitude, 2 h = c A²/4, whatever the frequency; the backbone "
    "stays.",
)

"""Drag of a fluid."""

from ..law import Law, LawParameter

LAW = Law(
    name="quadratic-drag",
    path="dissipation",
    parameters=(LawParameter("coefficient", "1/X", "quadratic drag per unit mass", strength=True, lower=0.0),),
    force=lambda motion, p: p["coefficient"] * motion.v**2 * motion.sign(motion.v),
    equation="{coefficient} x' |x'|",
    sentence="Drag that grows with the square of the speed, as of a body in air or water.",
    phrase="drag that grows with the square of the speed",
    source="Morison et al. 1950; Feldman, Bucher, Rotberg, Eq. 7 for the form of the damping curve",
    curves="The damping curve rises in proportion to amplitude times frequency, 2 h = 8/(3 pi) c omega A; the "
    "backbone stays.",
)

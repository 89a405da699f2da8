"""Damping that grows with the cube of the speed."""

from ..law import Law, LawParameter

LAW = Law(
    name="cubic-damping",
    path="dissipation",
    parameters=(LawParameter("coefficient", "s/X2", "cubic damping per unit mass", strength=True, lower=0.0),),
    force=lambda motion, p: p["coefficient"] * motion.v**3,
    equation="{coefficient} x'³",
    sentence="Damping that grows with the cube of the speed, as of dampers with orifices or of van der Pol's kind.",
    phrase="damping that grows with the cube of the speed",
    source="Nayfeh and Mook 1979, section 3.3",
    curves="The damping curve rises with the square of amplitude and frequency, 2 h = 3/4 c omega² A²; the backbone "
    "stays.",
)

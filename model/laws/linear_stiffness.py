"""The linear spring of Eq. 17."""

from ..law import Law, LawParameter

LAW = Law(
    name="linear-stiffness",
    path="restoring",
    parameters=(LawParameter("omega0", "rad/s", "undamped angular frequency of the linear part", lower=0.0),),
    force=lambda motion, p: p["omega0"] ** 2 * motion.x,
    stored=lambda motion, p: p["omega0"] ** 2 * motion.x**2 / 2,
    equation="{omega0}² x",
    sentence="A spring whose force grows in proportion to the displacement.",
    phrase="a linear spring",
    source="Feldman, Bucher, Rotberg, Eqs. 2 and 17",
    curves="The backbone stands upright at omega0; the damping curve stays.",
)

"""The dry (Coulomb) friction of Eqs. 7 and 17, with true sticking."""

from ..law import Law, LawParameter

LAW = Law(
    name="dry-friction",
    path="dissipation",
    parameters=(LawParameter("dry", "X/s2", "dry friction force per unit mass", lower=0.0),),
    force=lambda motion, p: p["dry"] * motion.sign(motion.v),
    equation="{dry} sgn(x')",
    sentence="Friction of constant size against the motion; at rest it holds up to that size.",
    phrase="dry friction of constant size",
    source="Feldman, Bucher, Rotberg, Eqs. 7 and 17; sticking as a Filippov solution",
    curves="Adds 2 D/(pi omega A) to the damping curve, which grows towards small amplitudes; the backbone stays.",
)

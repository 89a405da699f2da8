"""A static load."""

from ..law import Law, LawParameter

LAW = Law(
    name="constant-force",
    path="restoring",
    parameters=(LawParameter("load", "X/s2", "static load per unit mass, positive along x", strength=True),),
    force=lambda motion, p: -p["load"],
    stored=lambda motion, p: -p["load"] * motion.x,
    equation="-{load}",
    sentence="A static load: gravity, a tilted table, a string that pulls; the motion is about another point of the "
    "spring.",
    phrase="a static load",
    source="Nayfeh and Mook 1979, section 4.1",
    curves="With a hardening spring the backbone rises at small amplitudes; the damping curve stays.",
)

"""The preloaded spring of Eqs. 1, 2 and 17: a step of force at the middle position."""

from ..law import Law, LawParameter

LAW = Law(
    name="preload",
    path="restoring",
    parameters=(LawParameter("preload", "X/s2", "preload force per unit mass, F0/m"),),
    force=lambda motion, p: p["preload"] * motion.sign(motion.x),
    stored=lambda motion, p: p["preload"] * motion.x * motion.sign(motion.x),
    equation="{preload} sgn(x)",
    sentence="A pre-tensioned spring that must first be lifted off its seat; raises the frequency of small motions.",
    phrase="a pre-tensioned spring that must first be lifted off its seat",
    source="Feldman and Braun 1993; Feldman, Bucher, Rotberg, Eqs. 1 and 2",
    curves="The backbone rises without end towards small amplitudes, and is twice omega0 at 0.414 F0/k; the "
    "damping curve stays.",
)

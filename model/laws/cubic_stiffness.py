"""The cubic spring of Eqs. 3 and 17: hardening when positive."""

from ..law import Law, LawParameter

LAW = Law(
    name="cubic-stiffness",
    path="restoring",
    parameters=(LawParameter("cubic", "1/(X2.s2)", "cubic stiffness per unit mass"),),
    force=lambda motion, p: p["cubic"] * motion.x**3,
    stored=lambda motion, p: p["cubic"] * motion.x**4 / 4,
    equation="{cubic} x³",
    sentence="A spring that stiffens (or softens) with the square of the displacement, as stretched beams do.",
    phrase="a spring whose stiffness changes with the square of the displacement",
    source="Feldman, Bucher, Rotberg, Eqs. 3, 6 and 17 (0.46 x³ there is in mm: 4.6e5 1/(m²s²) in SI)",
    curves="Adds 3/4 c A² to the squared backbone frequency; the damping curve stays.",
)

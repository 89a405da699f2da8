"""Friction that is larger at rest than in motion."""

from ..law import Expression, Law, LawParameter


def _friction(motion, p) -> Expression:
    import casadi as ca

    direction = motion.sign(motion.v)
    speed = ca.fmax(direction * motion.v, 0) / p["speed"]
    return p["excess"] * direction * ca.exp(-((speed + 1e-12) ** p["exponent"]))


LAW = Law(
    name="stribeck",
    path="dissipation",
    parameters=(
        LawParameter(
            "excess", "X/s2", "friction at rest above that in motion, per unit mass", strength=True, lower=0.0
        ),
        LawParameter("speed", "X/s", "speed at which it has fallen to 1/e", lower=1e-12, probes=(0.02, 0.06, 0.2, 0.5)),
        LawParameter("exponent", "1", "how it falls: 1 exponentially, 2 as a bell", 0.5, 3.0, (1.0, 2.0), shape=True),
    ),
    force=_friction,
    equation="{excess} exp(-|x' / {speed}|^{exponent}) sgn(x')",
    sentence="Friction that is larger at rest and falls with speed, as of lubricated or stick-slip contacts.",
    phrase="friction that is larger at rest and falls with speed",
    source="Stribeck 1902; Armstrong-Helouvry, Dupont, Canudas de Wit 1994, section 2",
    curves="The damping curve rises more steeply towards small amplitudes than dry friction alone makes it; the "
    "backbone stays.",
)

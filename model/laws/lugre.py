"""Friction of bristles that bend before they slide, with a damping of their own.

Where nothing is in excess, and the bristles have no damping, this is Dahl's friction. The bend stores; the damping of
the bristles can give more than is put in where it is large and the friction falls steeply (Barahona and Canudas 2000).
"""

from ..law import Expression, Law, LawParameter


def _force(motion, p) -> Expression:
    import casadi as ca

    bend = motion.state("bend", "X", reach=p["limit"])
    speed = motion.sign(motion.v) * motion.v
    slides = p["limit"] * (1 + p["excess"] * ca.exp(-((speed / p["speed"]) ** 2)))
    rate = motion.v - speed * bend / slides
    motion.rate(bend, rate)
    return p["stiffness"] * bend + p["damping"] * rate


LAW = Law(
    name="lugre",
    path="memory",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness of the bristles, per unit mass", strength=True, lower=0.0),
        LawParameter("damping", "1/s", "damping of the bristles, per unit mass", strength=True, lower=0.0),
        LawParameter("limit", "X", "bend at which they slide", lower=1e-12, probes=(0.01, 0.03, 0.1, 0.3)),
        LawParameter(
            "excess", "1", "friction at rest above that in motion, over it", 0.0, 20.0, (0.0, 0.5), shape=True
        ),
        LawParameter("speed", "X/s", "speed at which that has fallen to 1/e", 1e-12, probes=(0.05,), shape=True),
    ),
    force=_force,
    stored=lambda motion, p: p["stiffness"] * motion.inner("bend") ** 2 / 2,
    equation="{stiffness} z + {damping} z'; z' = x' - |x'| z / ({limit} (1 + {excess} exp(-(x' / {speed})²)))",
    sentence="Friction of a contact whose bristles bend before they slide: it depends on where the motion last turned, "
    "and may be larger at low speed.",
    phrase="friction of bristles that bend before they slide",
    source="Canudas de Wit, Olsson, Astrom, Lischinsky 1995",
    curves="As of hysteresis; with an excess the damping curve rises towards small amplitudes.",
)

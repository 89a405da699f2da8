"""A spring in series with a damper (Maxwell): the spring stores, the damper takes ``stiffness rate (x - q)²``."""

from ..law import Expression, Law, LawParameter


def _force(motion, p) -> Expression:
    damper = motion.state("damper", "X", follows="displacement")
    motion.rate(damper, p["rate"] * (motion.x - damper))
    return p["stiffness"] * (motion.x - damper)


LAW = Law(
    name="viscoelastic",
    path="memory",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness of the branch per unit mass", strength=True, lower=0.0),
        LawParameter("rate", "1/s", "how fast the branch relaxes", lower=0.0, probes=(0.05, 0.3, 1.0, 3.0)),
    ),
    force=_force,
    stored=lambda motion, p: p["stiffness"] * (motion.x - motion.inner("damper")) ** 2 / 2,
    equation="{stiffness} (x - q); q' = {rate} (x - q)",
    sentence="A spring in series with a damper (rubber, polymer, a gas volume behind an orifice): stiff when moved "
    "fast, soft when moved slowly.",
    phrase="a spring in series with a damper",
    source="Maxwell 1867; Zener 1948 (standard linear solid)",
    curves="Stiffness and damping depend on the frequency and not on the amplitude: the backbone is shifted as a "
    "whole, and the damping is largest where omega is near the rate.",
)

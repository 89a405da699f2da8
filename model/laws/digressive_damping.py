"""A damper whose force is steep at low speed and flat at high speed, in either direction its own."""

from ..law import Expression, Law, LawParameter


def _force(motion, p) -> Expression:
    import casadi as ca

    return p["force"] * (1 + p["asymmetry"] * motion.sign(motion.v)) * ca.tanh(motion.v / p["speed"])


LAW = Law(
    name="digressive-damping",
    path="dissipation",
    parameters=(
        LawParameter("force", "X/s2", "force that it comes to, per unit mass", strength=True, lower=0.0),
        LawParameter("speed", "X/s", "speed of the bend", lower=1e-12, probes=(0.03, 0.1, 0.3)),
        LawParameter("asymmetry", "1", "more of it one way and less the other", -1.0, 1.0, (0.0,), shape=True),
    ),
    force=_force,
    equation="{force} (1 + {asymmetry} sgn(x')) tanh(x' / {speed})",
    sentence="A damper whose force rises steeply at low speed and flattens at high speed, as that of a shock absorber "
    "whose valves open.",
    phrase="a damper that is steep at low speed and flat at high",
    source="Dixon 2007, The Shock Absorber Handbook, section 6; smoothed by a tanh",
    curves="The damping curve falls with amplitude; the backbone stays.",
)

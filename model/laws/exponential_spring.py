"""A spring whose force grows exponentially to one side and comes to an end to the other, as a diode's voltage."""

from ..law import Expression, Law, LawParameter

#: Of the exponent, beyond which no motion goes.
_MOST = 60.0


def _grown(motion, p) -> Expression:
    import casadi as ca

    return ca.exp(ca.fmin(motion.x / p["length"], _MOST))


LAW = Law(
    name="exponential-spring",
    path="restoring",
    parameters=(
        LawParameter("force", "X/s2", "force that it has at the far end, per unit mass", strength=True),
        LawParameter("length", "X", "over which it grows by e, where x raises it", probes=(-0.5, -0.2, 0.2, 0.5)),
    ),
    force=lambda motion, p: p["force"] * (_grown(motion, p) - 1),
    stored=lambda motion, p: p["force"] * (p["length"] * (_grown(motion, p) - 1) - motion.x),
    equation="{force} (exp(x / {length}) - 1)",
    sentence="A spring whose force grows exponentially to one side: a layer that is pressed together, a junction of a "
    "semiconductor.",
    phrase="a spring that grows exponentially to one side",
    source="Shockley 1949; of rubber and tissue Fung 1967",
    curves="The backbone rises with amplitude and the middle of the motion moves; the damping curve stays.",
)

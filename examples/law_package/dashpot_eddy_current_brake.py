"""The brake of a conductor that moves in a magnet's field, as a law of a package of its own."""

from dashpot.model import Law, LawParameter

LAW = Law(
    name="eddy-current-brake",
    path="dissipation",
    parameters=(
        LawParameter("peak", "X/s2", "largest braking force per unit mass", strength=True, lower=0.0),
        LawParameter("speed", "X/s", "speed at which it brakes most", lower=1e-9, probes=(0.1, 0.3, 1.0)),
    ),
    force=lambda motion, p: 2 * p["peak"] * motion.v * p["speed"] / (p["speed"] ** 2 + motion.v**2),
    equation="2 {peak} x' {speed} / ({speed}² + x'²)",
    sentence="The brake of a conductor in a magnet's field: viscous at small speed, weaker beyond its best.",
    phrase="an eddy-current brake that weakens at large speed",
    source="Wouterse 1991, critical torque and speed of an eddy current brake",
    curves="The damping curve falls from that of a viscous damper as the speed passes that of the peak; the backbone "
    "stays.",
)

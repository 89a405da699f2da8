"""An actuator with a moving mass that drives the rig through a joint with play."""

from ..law import Expression, Law, LawParameter


def _drive(motion, p, force) -> Expression:
    y = motion.state("displacement", "X", follows="displacement")
    w = motion.state("velocity", "X/s", follows="velocity")
    apart, closing = y - motion.x, w - motion.v

    def push(side: int) -> Expression:
        """Contact on one side: a spring and a damper that push and never pull."""
        depth = side * apart - p["gap"]
        law = p["stiffness"] * depth + p["damping"] * side * closing
        return 0.5 * (1 + motion.sign(depth)) * motion.beyond(law)

    contact = push(1) - push(-1)
    motion.rate(y, w)
    motion.rate(w, (force - contact) / p["mass"] - p["guide"] * w)
    return contact


LAW = Law(
    name="actuator-backlash",
    path="excitation",
    parameters=(
        LawParameter("gap", "X", "half of the play", lower=0.0, probes=(0.003, 0.01, 0.03)),
        LawParameter(
            "mass",
            "Q.s2/X",
            "moving mass of the actuator",
            lower=1e-12,
            probes=(0.03, 0.1, 0.3),
            size=lambda s: s.mass or 1.0,
        ),
        LawParameter(
            "stiffness",
            "Q/X",
            "contact stiffness",
            lower=0.0,
            probes=(3.0, 30.0, 300.0),
            size=lambda s: (s.mass or 1.0) * s.omega**2,
        ),
        LawParameter(
            "damping",
            "Q.s/X",
            "contact damping",
            lower=0.0,
            probes=(0.1, 1.0),
            size=lambda s: (s.mass or 1.0) * s.omega,
        ),
        LawParameter("guide", "1/s", "damping of the actuator's own guide per its mass", probes=(0.0,), shape=True),
    ),
    drive=_drive,
    equation="F drives an actuator, {mass} (w'' + {guide} w') = F - P; P = {stiffness} d + {damping} d', pushing "
    "only, moves the mass, d = w - x beyond ±{gap}",
    sentence="Play between actuator and mass: the recorded force moves the actuator first, which then pushes, and "
    "lets go at each reversal.",
    phrase="play between actuator and mass",
    source="Nordin and Gutman 2002, section 2; Feldman, Bucher, Rotberg, section 5",
    curves="In forced records the mass seems larger or smaller and the response scatters at each reversal of the "
    "force; in free decay the actuator rattles along.",
    rugged=True,  # the contact rings faster than the rig moves
)

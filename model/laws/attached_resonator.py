"""A second mass on a spring of its own: both store, its damper takes ``mass-ratio damping (x' - y')²``."""

from ..law import Expression, Law, LawParameter


def _force(motion, p) -> Expression:
    y = motion.state("displacement", "X", follows="displacement")
    w = motion.state("velocity", "X/s", follows="velocity")
    pull = p["frequency"] ** 2 * (motion.x - y) + p["damping"] * (motion.v - w)
    motion.rate(y, w)
    motion.rate(w, pull)
    return p["mass-ratio"] * pull


def _stored(motion, p) -> Expression:
    stretch = motion.x - motion.inner("displacement")
    return p["mass-ratio"] * (motion.inner("velocity") ** 2 + p["frequency"] ** 2 * stretch**2) / 2


LAW = Law(
    name="attached-resonator",
    path="inertia",
    parameters=(
        LawParameter("mass-ratio", "1", "its mass over the main mass", strength=True, lower=0.0),
        LawParameter(
            "frequency",
            "rad/s",
            "its own frequency on a fixed foundation",
            lower=1e-9,
            probes=(0.3, 0.5, 0.7, 0.85, 0.95, 1.05, 1.2, 1.5, 2.0, 3.0),
        ),
        LawParameter("damping", "1/s", "its damping per its own mass", lower=0.0, probes=(0.02,)),
    ),
    force=_force,
    stored=_stored,
    equation="{mass-ratio} y''; y'' = {frequency}² (x - y) + {damping} (x' - y')",
    sentence="A second mass on a spring of its own: a loose cable, a bracket, a second mode of the structure.",
    phrase="a second mass on a spring of its own",
    source="Den Hartog 1956, section 3.3",
    curves="Two resonances; the backbone is shifted as a whole and the damping rises where the second one is tuned.",
)

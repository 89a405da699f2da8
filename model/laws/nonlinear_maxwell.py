"""A damper behind a spring: the spring gives before the damper yields.

The speed of the damper grows as a power of the force on both: 1 is Maxwell's branch, a large one yields at a force. The
spring stores; what the damper takes, ``stiffness z speed |z / limit|^exponent sgn z``, is never negative.
"""

from ..law import Expression, Law, LawParameter

#: Times the limit, beyond which the damper's speed grows no more: no motion is so fast.
_MOST = 50.0


def _force(motion, p) -> Expression:
    import casadi as ca

    z = motion.state("deflection", "X", reach=p["limit"])
    load = ca.fmin(ca.fabs(z / p["limit"]) + 1e-12, _MOST)
    motion.rate(z, motion.v - p["speed"] * motion.sign(z) * load ** p["exponent"])
    return p["stiffness"] * z


LAW = Law(
    name="nonlinear-maxwell",
    path="memory",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness of the spring, per unit mass", strength=True, lower=0.0),
        LawParameter(
            "limit", "X", "deflection of the spring at that speed", lower=1e-12, probes=(0.01, 0.03, 0.1, 0.3)
        ),
        LawParameter("speed", "X/s", "speed that the limit is stated at", lower=1e-12, probes=(0.3,), scale=True),
        LawParameter("exponent", "1", "of the speed over the force: 1 viscous, large yields", 1.0, 30.0, (1.5, 4.0)),
    ),
    force=_force,
    stored=lambda motion, p: p["stiffness"] * motion.inner("deflection") ** 2 / 2,
    equation="{stiffness} z; z' = x' - {speed} |z / {limit}|^{exponent} sgn(z)",
    sentence="A damper behind a spring: oil, a bushing or a mount gives elastically before the damper yields; its "
    "force rises steeply at low speed and flattens, and lags behind the motion.",
    phrase="a damper behind a spring",
    source="Norton 1929, Hoff 1954; of magnetorheological dampers Gamota and Filisko 1991",
    curves="The backbone falls with amplitude from sqrt(omega0² + stiffness); the damping curve has a maximum.",
)

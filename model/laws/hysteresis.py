"""Rate-independent hysteresis: a contact that gives elastically before it slides.

The elastic deflection z stores; sliding takes the rest, ``stiffness z (x' - z')`` per unit mass, which is never
negative while ``loading`` is at least one half (Erlicher and Point 2004).
"""

from ..law import Expression, Law, LawParameter


def _force(motion, p) -> Expression:
    import casadi as ca

    z = motion.state("deflection", "X", reach=p["limit"])
    load = ca.fabs(z / p["limit"]) + 1e-12
    loading = motion.sign(motion.v) * motion.sign(z)
    slide = load ** p["exponent"] * (p["loading"] * loading + 1 - p["loading"])
    motion.rate(z, motion.v * (1 - slide))
    return p["stiffness"] * z


LAW = Law(
    name="hysteresis",
    path="memory",
    parameters=(
        LawParameter("stiffness", "1/s2", "stiffness before it slides, per unit mass", strength=True, lower=0.0),
        LawParameter("limit", "X", "deflection at which it slides", lower=1e-12, probes=(0.02, 0.06, 0.2, 0.6)),
        LawParameter("exponent", "1", "sharpness of the bend: 1 gradual, large abrupt", 0.5, 20.0, (1.0,), shape=True),
        LawParameter(
            "loading",
            "1",
            "0.5: unloads elastically (Bouc-Wen), 1: bends while unloading too (Dahl)",
            0.5,
            1.0,
            (0.5, 1.0),
            shape=True,
        ),
    ),
    force=_force,
    stored=lambda motion, p: p["stiffness"] * motion.inner("deflection") ** 2 / 2,
    equation="{stiffness} z; z' = x' (1 - |z / {limit}|^{exponent} ({loading} sgn(x' z) + 1 - {loading}))",
    sentence="A contact that gives elastically before it slides (pre-sliding, micro-slip, a joint or wire rope): its "
    "force depends on where the motion last turned.",
    phrase="a contact that gives elastically before it slides",
    source="Bouc 1967, Wen 1976; Dahl 1968 for exponent 1 and loading 1; Jenkins for a large exponent",
    curves="The backbone falls with amplitude from sqrt(omega0² + stiffness); the damping curve has a maximum near "
    "twice the limit.",
)

"""A closed column of gas: its force grows without end as it is pressed together."""

from ..law import Expression, Law, LawParameter

#: Part of its length that a column has at least.
_SHORTEST = 1e-3


def _left(motion, p) -> Expression:
    import casadi as ca

    return ca.fmax(1 - motion.x / p["length"], _SHORTEST)


def _stored(motion, p) -> Expression:
    """The work of the pressure beyond that in the middle, from there: of an exponent of one a logarithm."""
    import casadi as ca

    left, n = _left(motion, p), p["exponent"]
    power = ca.if_else(ca.fabs(n - 1) < 1e-9, -ca.log(left), (left ** (1 - n) - 1) / (n - 1 + 1e-30))
    return p["force"] * (p["length"] * power - motion.x)


LAW = Law(
    name="gas-spring",
    path="restoring",
    parameters=(
        LawParameter("force", "X/s2", "its force in the middle, per unit mass", strength=True),
        LawParameter("length", "X", "of the column there, where x closes it", probes=(-4.0, -2.0, -1.2, 1.2, 2.0, 4.0)),
        LawParameter("exponent", "1", "1 slow and isothermal, 1.4 fast and adiabatic", 1.0, 1.67, (1.2,)),
    ),
    force=lambda motion, p: p["force"] * (_left(motion, p) ** -p["exponent"] - 1),
    stored=_stored,
    equation="{force} ((1 - x / {length})^-{exponent} - 1)",
    sentence="A closed column of gas, as in a gas strut, an air spring or the reservoir of a damper: its force grows "
    "without end as it is pressed together.",
    phrase="a closed column of gas",
    source="Poisson's law of a polytropic change of state; Dixon 2007, section 5",
    curves="The backbone rises with amplitude and the middle of the motion moves; the damping curve stays.",
)

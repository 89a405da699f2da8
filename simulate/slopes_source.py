"""The slopes of one oscillator's equations as C: what ``engine/carried.c`` takes derivatives along the motion by.

CasADi writes the entries of each Jacobian that are not zero, once for all unknowns; the products with their directions
are loops over unknowns side by side, which a compiler makes vectors of.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..model.equations import Equations
from ..model.law import Expression
from .kinks import Sided, sided

#: Unknowns side by side: two vectors of the widest registers that many machines have.
LANES = 8


@dataclass(frozen=True)
class Slopes:
    """The Jacobian of one vector of expressions.

    Attributes:
        name: in C: ``dp_NAME_slopes`` writes the entries, ``dp_NAME_pushes`` takes from them what each unknown pushes
            by itself, ``dp_NAME_along`` is one row's derivative.
        entries: by the states, those that are not zero, then for each row in ``pushed`` by all parameters, by nothing
            (a zero), and by the force.
        places: of each row, pairs of a state and where its entry is; None where the entry is one.
        pushed: for each row that parameters or force change, in this order.
        first: where the entries of the first of them begin.
        width: how many entries each of them has.
    """

    name: str
    entries: Expression
    places: tuple[tuple[tuple[int, int | None], ...], ...]
    pushed: tuple[int, ...]
    first: int
    width: int

    @property
    def function(self) -> str:
        """Name of CasADi's function."""
        return f"dp_law_{self.name}_slopes"


def slopes_of(eq: Equations) -> tuple[list[Slopes], Sided]:
    """Of the right-hand side, the surfaces and the outputs; and the sides of their kinks."""
    import casadi as ca

    parts = {"field": eq.zdot, "surface": eq.surfaces, "output": eq.y}
    arguments, by = [eq.z, eq.t, eq.u, eq.p, eq.s], ca.vertcat(eq.z, eq.p, eq.u)
    whole = sided(ca.densify(ca.vertcat(*parts.values())), arguments, ca.vertcat(eq.z, eq.t, eq.u), by)
    made, begin = [], 0
    for name, vector in parts.items():
        end = begin + vector.numel()
        made.append(_slopes(name, eq, whole.jacobian[begin:end, :]))
        begin = end
    return made, whole


def _slopes(name: str, eq: Equations, jacobian: Expression) -> Slopes:
    import casadi as ca

    by_state, by_push = jacobian[:, : eq.z.numel()], jacobian[:, eq.z.numel() :]
    entries: list[Expression] = []
    places: list[tuple[tuple[int, int | None], ...]] = []
    for row in range(jacobian.shape[0]):
        own: list[tuple[int, int | None]] = []
        for column in range(eq.z.numel()):
            if not by_state.sparsity().has_nz(row, column):
                continue
            entry = by_state[row, column]
            if entry.is_one():
                own.append((column, None))
            else:
                own.append((column, len(entries)))
                entries.append(entry)
        places.append(tuple(own))
    first, count = len(entries), eq.p.numel()
    pushed = tuple(row for row in range(jacobian.shape[0]) if by_push[row, :].nnz())
    for row in pushed:
        entries += [*ca.vertsplit(ca.densify(by_push[row, :count]).T), ca.SX(0), ca.densify(by_push[row, count])]
    return Slopes(name, ca.vertcat(ca.SX(0, 1), *entries), tuple(places), pushed, first, count + 2)


def further_functions(eq: Equations, state: list[Expression]) -> list[tuple[str, list[Expression], list[Expression]]]:
    """What is rarely asked for: slopes by the signs, and how fast the acceleration changes along given rates."""
    import casadi as ca

    rates, force_rate = ca.SX.sym("dz", eq.z.numel()), ca.SX.sym("du")
    point, way = ca.vertcat(eq.z, eq.t, eq.u), ca.vertcat(rates, 1, force_rate)
    return [
        ("dp_law_field_signs", state, [ca.jacobian(eq.zdot, eq.s)]),
        ("dp_law_output_signs", state, [ca.jacobian(eq.y, eq.s)]),
        ("dp_law_drift", [*state, rates, force_rate], [ca.jtimes(eq.zdot[1], point, way)]),
    ]


_CALLS = """
#define DP_CARRIES 1
#define DP_LANES {lanes}
#define DP_SIDES {sides}
{sizes}
/* Whether an output is a state, whose derivatives are known. */
static const int dp_output_is_state[] = {{{plain}}};
"""

_SIDES = """
/* On which sides of its kinks the motion is. */
DP_INLINE void dp_sides(const double *z, double t, double u, const double *p, const double *s, double *sides) {{
    const double *arg[5];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    res[0] = sides;
    dp_law_sides(arg, res, 0, 0, 0);
}}
"""

_SLOPES = """
DP_INLINE void dp_{name}_slopes_here(const double *z, double t, double u, const double *p, const double *s,
                                     const double *sides, double *j) {{
    const double *arg[6];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s, arg[5] = sides;
    res[0] = j;
    {function}(arg, res, 0, 0, 0);
}}

DP_APART void dp_{name}_slopes(const double *z, double t, double u, const double *p, const double *s, double *j) {{
    double sides[DP_SIDES];
    dp_sides(z, t, u, p, s, sides);
    dp_{name}_slopes_here(z, t, u, p, s, sides, j);
}}

/* What each unknown of a block pushes by itself; which: its place among parameters, nothing, force. */
DP_INLINE void dp_{name}_pushes(const double *j, const int *which, double (*pushed)[DP_LANES]) {{
    int k;
    (void)j, (void)which, (void)pushed;
{pushes}}}

/* Derivatives of one row by the unknowns of a block, those of the state given. */
DP_INLINE void dp_{name}_along(const double *restrict j, double (*restrict pushed)[DP_LANES],
                               const double (*restrict dz)[DP_LANES], int row, double *restrict out) {{
    int k;
    (void)j, (void)pushed, (void)dz;
    switch (row) {{
{rows}    default:
        memset(out, 0, DP_LANES * sizeof *out);
    }}
}}
"""

_FURTHER = """
/* Slopes by the signs, column by column. */
DP_APART void dp_field_by_signs(const double *z, double t, double u, const double *p, const double *s, double *out) {
    const double *arg[5];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    res[0] = out;
    dp_law_field_signs(arg, res, 0, 0, 0);
}

DP_APART void dp_output_by_signs(const double *z, double t, double u, const double *p, const double *s, double *out) {
    const double *arg[5];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    res[0] = out;
    dp_law_output_signs(arg, res, 0, 0, 0);
}

/* How fast the acceleration under signs s changes while states and force change at the rates dz, du. */
DP_APART void dp_drift(const double *z, double t, double u, const double *p, const double *s, const double *dz,
                       double du, double *out) {
    const double *arg[7];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s, arg[5] = dz, arg[6] = &du;
    res[0] = out;
    dp_law_drift(arg, res, 0, 0, 0);
}
"""


def carried_source(slopes: Sequence[Slopes], sides: Sided) -> str:
    """C text of the functions that ``engine/carried.c`` calls, behind those that CasADi made."""
    sizes = "\n".join(
        f"#define DP_{part.name.upper()}_SLOPES {max(1, part.entries.numel())}\n"
        f"#define DP_{part.name.upper()}_PUSHED {max(1, len(part.pushed))}"
        for part in slopes
    )
    output = slopes[-1]
    plain = (
        row not in output.pushed and all(place is None for _, place in places)
        for row, places in enumerate(output.places)
    )
    return (
        "#include <string.h>\n"
        + _CALLS.format(
            lanes=LANES, sizes=sizes, plain=", ".join(str(int(one)) for one in plain), sides=max(1, sides.sides.numel())
        )
        + _SIDES.format()
        + "".join(
            _SLOPES.format(name=part.name, function=part.function, pushes=_pushes(part), rows=_rows(part))
            for part in slopes
        )
        + _FURTHER
    )


def _pushes(part: Slopes) -> str:
    return "".join(
        f"    for (k = 0; k < DP_LANES; ++k) pushed[{i}][k] = j[{part.first + i * part.width} + which[k]];\n"
        for i in range(len(part.pushed))
    )


def _rows(part: Slopes) -> str:
    text = ""
    for row, places in enumerate(part.places):
        terms = [f"pushed[{part.pushed.index(row)}][k]"] if row in part.pushed else []
        terms += [f"dz[{state}][k]" if place is None else f"j[{place}] * dz[{state}][k]" for state, place in places]
        if terms:
            loop = f"for (k = 0; k < DP_LANES; ++k) out[k] = {' + '.join(terms)};"
            text += f"    case {row}:\n        {loop}\n        break;\n"
    return text

"""The laws of one oscillator as C: what ``engine/engine.c`` integrates."""

from __future__ import annotations

from ..model.equations import Equations, rates_feel_rest
from ..model.law import Expression
from ..model.physical import physical
from .generated_c import generated_c
from .slopes_source import carried_source, further_functions, slopes_of

_HEADER = """\
/* Generated: the equation of motion of one oscillator. */
/* What takes nearly all of the time is put in place and unrolled, unless the program is to be small. */
#if (defined(__clang__) || (defined(__GNUC__) && __GNUC__ >= 8)) && !defined(__OPTIMIZE_SIZE__)
#define DP_INLINE static inline __attribute__((always_inline))
#define DP_APART static __attribute__((noinline))
#ifdef __clang__
#define DP_UNROLL _Pragma("clang loop unroll(full)")
#else
#define DP_UNROLL _Pragma("GCC unroll 8")
#endif
#else
#define DP_INLINE static
#define DP_APART static
#define DP_UNROLL
#endif
#define CASADI_SYMBOL_EXPORT DP_INLINE
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
#include <math.h>

/* Exponents that a law begins with take a product; the general power would take most of its time. */
DP_INLINE double dp_raised(double x, double exponent) {
    return exponent == 1.0 ? x : exponent == 2.0 ? x * x : pow(x, exponent);
}
"""

_FOOTER = """
#undef CASADI_SYMBOL_EXPORT
#define DP_NZ {nz}
#define DP_NP {np}
#define DP_NS {ns}
#define DP_NY {ny}
#define DP_SURFACES_USE_FORCE {uses_force}
#define DP_RATES_FEEL_REST {feels_rest}
static const int dp_kind[DP_NS + 1] = {{{kinds}}};

DP_INLINE void dp_field_here(const double *z, double t, double u, const double *p, const double *s, double *f) {{
    const double *arg[5];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    res[0] = f;
    dp_law_field(arg, res, 0, 0, 0);
}}

DP_APART void dp_field(const double *z, double t, double u, const double *p, const double *s, double *f) {{
    dp_field_here(z, t, u, p, s, f);
}}

DP_INLINE void dp_surface_here(const double *z, double t, double u, double u_rate, const double *p, const double *s,
                               double *f, double *g, double *g_rate) {{
    const double *arg[6];
    double *res[3];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = &u_rate, arg[4] = p, arg[5] = s;
    res[0] = f, res[1] = g, res[2] = g_rate;
    dp_law_surface(arg, res, 0, 0, 0);
}}

DP_APART void dp_surface(const double *z, double t, double u, double u_rate, const double *p, const double *s,
                         double *f, double *g, double *g_rate) {{
    dp_surface_here(z, t, u, u_rate, p, s, f, g, g_rate);
}}

DP_APART void dp_output(const double *z, double t, double u, const double *p, const double *s, double *y) {{
    const double *arg[5];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    res[0] = y;
    dp_law_output(arg, res, 0, 0, 0);
}}
"""

_POWER = """
/* Energy and dissipated power. */
DP_APART void dp_power(const double *z, double t, double u, const double *p, const double *s, double *out) {
    const double *arg[5];
    double *res[1];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    res[0] = out;
    dp_law_power(arg, res, 0, 0, 0);
}
"""

_TANGENT = """
/* The machine in kg, N/m and N: DP_NM quantities. */
DP_APART void dp_physical(const double *p, double *out) {
    const double *arg[1];
    double *res[1];
    arg[0] = p;
    res[0] = out;
    dp_law_physical(arg, res, 0, 0, 0);
}

/* How rates, outputs, energy and dissipated power, surfaces, and the machine's quantities change in a direction of
 * states, time, force, parameters and signs. */
DP_APART void dp_tangent(const double *z, double t, double u, const double *p, const double *s, const double *dz,
                         double dt, double du, const double *dp, const double *ds, double *df, double *dy, double *dw,
                         double *dg, double *dm) {
    const double *arg[10];
    double *res[5];
    arg[0] = z, arg[1] = &t, arg[2] = &u, arg[3] = p, arg[4] = s;
    arg[5] = dz, arg[6] = &dt, arg[7] = &du, arg[8] = dp, arg[9] = ds;
    res[0] = df, res[1] = dy, res[2] = dw, res[3] = dg, res[4] = dm;
    dp_law_tangent(arg, res, 0, 0, 0);
}
"""


def law_source(eq: Equations, *, exported: bool = False, carried: bool = False) -> str:
    """C text that defines the sizes, the kinds of the surfaces and the functions that the engine calls.

    No text of a model file reaches it: names stay outside, parameters are an argument.

    Args:
        eq: the equations.
        exported: with what an importer asks for beyond the motion: ``dp_power`` writes energy and dissipated power, two
            values in ``Oscillator.energy_units``, ``dp_physical`` the machine in its own units, and ``dp_tangent``
            gives directional derivatives; a fit does without.
        carried: with the slopes that derivatives carried along a motion take (``slopes_source``).
    """
    import casadi as ca

    state = [eq.z, eq.t, eq.u, eq.p, eq.s]
    rates = [eq.z, eq.t, eq.u, eq.u_rate, eq.p, eq.s]
    generator = ca.CodeGenerator("law.c", {"casadi_int": "int", "with_header": False})
    functions = [
        ("dp_law_field", state, [eq.zdot]),
        ("dp_law_surface", rates, [eq.zdot, eq.surfaces, eq.surface_rates]),
        ("dp_law_output", state, [eq.y]),
    ]
    if exported:
        functions += [
            ("dp_law_power", state, [ca.vertcat(eq.energy, eq.dissipated)]),
            ("dp_law_physical", [eq.p], [physical(eq)]),
            ("dp_law_tangent", *_tangent(eq, state)),
        ]
    carrying = ""
    if carried:
        slopes, kinks = slopes_of(eq)
        carrying = carried_source(slopes, kinks)
        functions += [(part.function, [*state, kinks.sides], [part.entries]) for part in slopes]
        functions += [("dp_law_sides", state, [kinks.values]), *further_functions(eq, state)]
    for name, inputs, outputs in functions:
        # dense: a structural zero would otherwise be left out of the result array
        generator.add(ca.Function(name, inputs, [ca.densify(output) for output in outputs]))
    body = generated_c(generator).replace("static int casadi_f", "DP_INLINE int casadi_f")
    body = body.replace("=pow(", "=dp_raised(")
    uses_force = bool(eq.kinds) and bool(ca.depends_on(eq.surfaces, eq.u))
    return (
        _HEADER
        + body
        + _FOOTER.format(
            nz=eq.z.numel(),
            np=eq.p.numel(),
            ns=len(eq.kinds),
            ny=eq.y.numel(),
            uses_force=int(uses_force),
            feels_rest=int(rates_feel_rest(eq)),
            kinds=", ".join([*(str(int(kind)) for kind in eq.kinds), "0"]),
        )
        + (f"#define DP_NM {physical(eq).numel()}\n{_POWER}{_TANGENT}" if exported else "")
        + carrying
    )


def _tangent(eq: Equations, state: list[Expression]) -> tuple[list[Expression], list[Expression]]:
    """Arguments and results of ``dp_tangent``: the derivatives in one direction of the arguments ``state``."""
    import casadi as ca

    directions = [ca.SX.sym(f"d{name}", symbol.sparsity()) for name, symbol in zip("ztups", state, strict=True)]
    point, direction = ca.veccat(*state), ca.veccat(*directions)
    results = [
        ca.jtimes(expression, point, direction)
        for expression in (eq.zdot, eq.y, ca.vertcat(eq.energy, eq.dissipated), eq.surfaces, physical(eq))
    ]
    return [*state, *directions], results

"""The oscillator as CasADi functions for controller design: loadable with nothing but casadi.

``OUT.casadi``             right-hand side, exact: signs as they are, sticking included
``OUT.step.casadi``        discrete step, event-exact
``OUT.smooth.casadi``      right-hand side with every sign replaced by tanh(surface / width)
``OUT.smooth.step.casadi`` discrete step of the smooth right-hand side
``OUT.casadi.json``        names, units, values with errors, widths, step
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..model.equations import Equations, SurfaceKind, equations, signed
from ..model.law import Expression
from ..simulate.casadi_step import exact_field, exact_step, with_defaults
from ..simulate.core import internal_step
from ..simulate.runge_kutta import dormand_prince
from ..writing import replacing

if TYPE_CHECKING:
    from ..model import Oscillator

#: Smoothing width over the largest identified amplitude (or over omega0 times it, for velocities).
RELATIVE_WIDTH = 1e-3
#: Amplitude that stands in where the model file states no range: 1 in its own unit is as good a guess as any.
_DEFAULT_AMPLITUDE = 1e-2


def amplitude_of(oscillator: Oscillator) -> float:
    """Largest amplitude that the model was identified for, in the displacement's unit."""
    return oscillator.amplitude.max if oscillator.amplitude is not None else _DEFAULT_AMPLITUDE


def smoothing_widths(oscillator: Oscillator, eq: Equations) -> list[float]:
    """One width per switching surface: a thousandth of the motion's largest displacement or velocity."""
    amplitude = amplitude_of(oscillator)
    velocity = amplitude * oscillator.omega0.value
    return [RELATIVE_WIDTH * (velocity if kind is SurfaceKind.VELOCITY else amplitude) for kind in eq.kinds]


def functions(oscillator: Oscillator, dt: float = 1e-3) -> dict[str, Expression]:
    """The four casadi.Function objects by their file suffix.

    Args:
        oscillator: the model.
        dt: sample time of the discrete steps, s.

    Returns:
        ``casadi``: f(x, u, p) -> xdot; ``step.casadi``: step(x, u, p) -> x_next; both again under ``smooth.``.
        ``x`` is displacement and velocity; ``u`` the force (for a step also two values, at its start and its end, with
        a straight line between them); elements of ``p`` left at their default, inf, take the identified values.

    Raises:
        BadInput: where ``dt`` is longer than half a cycle, or shorter than a millionth of that.
    """
    import casadi as ca

    half_period = math.pi / oscillator.omega0.value
    if not 1e-6 * half_period <= dt <= half_period:
        raise BadInput(
            f"the step of {dt:g} s does not suit an oscillation of {2 * half_period:.3g} s a cycle; "
            f"choose one between {1e-6 * half_period:.2g} s and half a cycle, {half_period:.3g} s"
        )
    eq = equations(oscillator)
    values = oscillator.values()
    identified = list(values.values())
    widths = smoothing_widths(oscillator, eq)
    x, u, p = ca.SX.sym("x", eq.z.numel()), ca.SX.sym("u"), ca.SX.sym("p", eq.p.numel())
    names = (["x", "u", "p"], ["xdot"])
    options = {"default_in": [0.0, 0.0, ca.inf]}
    p_full = with_defaults(p, identified)

    exact = ca.Function("f", [x, u, p], [exact_field(eq, x, u, p_full, 0)], *names, options)
    plain = signed(eq, eq.zdot, ca.DM(widths) if widths else None)
    field = ca.Function("field", [eq.z, eq.t, eq.u, eq.p], [plain])
    smooth = ca.Function("f_smooth", [x, u, p], [field(x, 0, u, p_full)], *names, options)

    forces, given = ca.MX.sym("u", 2), ca.MX.sym("p", eq.p.numel())
    start = ca.MX.sym("x", eq.z.numel())
    names = (["x", "u", "p"], ["x_next"])
    event_step = exact_step(oscillator, dt, internal_step(oscillator, values, amplitude_of(oscillator)))
    step = ca.Function("step", [start, forces, given], [event_step(start, forces, given, 0, dt)], *names, options)

    slope = ca.Function("jacobian", [eq.z, eq.t, eq.u, eq.p], [ca.norm_fro(ca.jacobian(plain, eq.z)[1, 0])])
    steepest = math.sqrt(abs(float(slope([0.0, 0.0], 0.0, 0.0, identified))))
    count = max(1, math.ceil(dt * max(steepest, oscillator.omega0.value) * _SMOOTH_STEPS / (2 * math.pi)))
    state, force_line, h = start, (forces[1] - forces[0]) / dt, dt / count
    full = with_defaults(given, identified)
    for n in range(count):
        state = dormand_prince(lambda z, tau: field(z, 0, forces[0] + force_line * tau, full), state, n * h, h)
    smooth_step = ca.Function("step_smooth", [start, forces, given], [state], *names, options)
    return {"casadi": exact, "step.casadi": step, "smooth.casadi": smooth, "smooth.step.casadi": smooth_step}


#: Internal steps per period of the stiffest smoothed law.
_SMOOTH_STEPS = 60.0


def export_casadi(oscillator: Oscillator, path: Path, *, dt: float = 1e-3) -> tuple[Path, ...]:
    """Write the functions and their description beside one another; returns the paths written.

    Args:
        oscillator: the model.
        path: ``OUT.casadi``; the other names are made from it.
        dt: sample time of the discrete steps, s.
    """
    path = Path(path)
    stem = path.name.removesuffix(".casadi")
    written = []
    for suffix, function in functions(oscillator, dt).items():
        target = path.with_name(f"{stem}.{suffix}")
        with replacing(target) as temporary:
            function.save(str(temporary))
        written.append(target)
    target = path.with_name(f"{stem}.casadi.json")
    with replacing(target) as temporary:
        text = json.dumps(describe(oscillator, stem, dt), indent=2, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    return (*written, target)


def describe(oscillator: Oscillator, stem: str, dt: float) -> dict[str, Any]:
    """Names and units of everything that goes into and comes out of the functions."""
    eq = equations(oscillator)
    unit = oscillator.response.displacement_unit
    force_unit = oscillator.force_unit if oscillator.mass is not None else f"{unit}/s2"
    descriptions = oscillator.descriptions()
    units = [unit, f"{unit}/s"]
    return {
        "format": "dashpot-casadi/1",
        "name": oscillator.name,
        "equation": oscillator.equation(),
        "files": {
            f"{stem}.casadi": "xdot = f(x, u, p), exact",
            f"{stem}.step.casadi": "x_next = step(x, u, p), event-exact; u held, or [u, u_next] for a straight line",
            f"{stem}.smooth.casadi": "xdot = f_smooth(x, u, p), sgn(g) replaced by tanh(g / width)",
            f"{stem}.smooth.step.casadi": "x_next = step_smooth(x, u, p) of the smooth right-hand side",
        },
        "x": [{"name": name, "unit": u} for name, u in zip(eq.state_names, units, strict=True)],
        "u": [{"name": "F", "unit": force_unit}],
        "p": [
            {"name": name, "value": q.value, "std": q.std, "unit": q.unit, "description": descriptions[name]}
            for name, q in oscillator.parameters().items()
        ],
        "p_default": "inf in an element of p stands for the identified value",
        "step_s": dt,
        "smoothing_width": [
            {"surface": str(surface), "width": width, "unit": unit if kind is SurfaceKind.POSITION else f"{unit}/s"}
            for surface, width, kind in zip(
                ["x" if k is SurfaceKind.POSITION else "v" for k in eq.kinds],
                smoothing_widths(oscillator, eq),
                eq.kinds,
                strict=True,
            )
        ],
    }

"""The oscillator as CasADi functions for controller design: loadable with nothing but casadi.

``OUT.casadi``             right-hand side, exact: signs as they are, sticking included
``OUT.step.casadi``        discrete step, event-exact
``OUT.output.casadi``      response as recorded, displacement, velocity, acceleration
``OUT.smooth.casadi``      right-hand side with every sign replaced by tanh(surface / width)
``OUT.smooth.step.casadi`` discrete step of the smooth right-hand side
``OUT.casadi.json``        names, units, values with errors, state of the fit, widths, step
``OUT.smooth.step.c, .h``  the discrete smooth step and its Jacobian by state and force as C

All take the state ``x``, the force ``u`` and the parameters ``p``; where a law depends on the time itself there is a
last input ``t``, zero where it is left out. (CasADi takes positional arguments only in full number, so that an input
that changes nothing would be a burden to every caller.)
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..files.writing import together, write
from ..model import units
from ..model.equations import Equations, signed
from ..model.fit_state import state_of_fit
from ..model.law import Expression
from ..simulate.casadi_step import exact_field, exact_output, exact_step, with_defaults
from ..simulate.runge_kutta import dormand_prince
from .description import identifier_of
from .facts import Facts
from .plain_c import prefix_of
from .smoothing import Sample, Surface, check_step, surfaces
from .step_c import HEADER, SOURCE, step_c

if TYPE_CHECKING:
    from ..model import Oscillator

#: What follows the name of each file.
FUNCTIONS = ("casadi", "step.casadi", "output.casadi", "smooth.casadi", "smooth.step.casadi")
DESCRIPTION = "casadi.json"
#: Internal steps of the smooth step per period of the fastest motion, and per time constant of what merely decays.
_SMOOTH_STEPS = 60.0
_SMOOTH_STEPS_PER_DECAY = 2.0
#: Instructions of one stage, times internal steps, up to which the smooth step is written out; beyond, it calls itself.
_EXPANDED = 5000
#: What to give a step at the sample time of the recordings, by how their force ran between samples.
_STEP_TAKES = {
    "zero": "u: the recorded force was held from sample to sample",
    "linear": "[u, u_next]: the recorded force ran in straight lines between samples",
    "smooth": "[u, u_next], at 30 steps a cycle or more: the recorded force was smooth",
}


@dataclass(frozen=True, eq=False)
class Functions:
    """The casadi.Function objects by their file suffix, and the surfaces that two of them smooth."""

    by_suffix: dict[str, Expression]
    surfaces: tuple[Surface, ...]
    timed: bool


def depends_on_time(eq: Equations) -> bool:
    """Whether a law depends on the time itself."""
    import casadi as ca

    return bool(ca.depends_on(ca.vertcat(eq.zdot, eq.y, eq.surfaces), eq.t))


def functions(facts: Facts, dt: float = 1e-3) -> Functions:
    """The five functions.

    Args:
        facts: of the model.
        dt: sample time of the discrete steps, s.

    Returns:
        ``casadi``: f(x, u, p) -> xdot; ``step.casadi``: step(x, u, p) -> x_next; both again under ``smooth.``;
        ``output.casadi``: h(x, u, p) -> y. ``x`` is displacement, velocity, inner states; ``u`` the force (for a step
        also two values, at its start and its end, with a straight line between them); ``p`` left out, or an element of
        it that is inf, takes the identified value, in functions that CasADi derives too. Where a law depends on time,
        t is the last input of all.

    Raises:
        BadInput: where ``dt`` is longer than half a cycle or shorter than a millionth of that, or takes too many
            internal steps.
    """
    import casadi as ca

    oscillator, eq = facts.oscillator, facts.equations
    half_period = math.pi / oscillator.omega0.value
    if not 1e-6 * half_period <= dt <= half_period:
        raise BadInput(
            f"the step of {dt:g} s does not suit an oscillation of {2 * half_period:.3g} s a cycle; "
            f"choose one between {1e-6 * half_period:.2g} s and half a cycle, {half_period:.3g} s"
        )
    timed = depends_on_time(eq)
    identified = list(facts.values.values())
    check_step(dt, facts.longest)
    event_step = exact_step(oscillator, dt, facts.longest)
    smoothed = surfaces(oscillator, eq, facts.sample)
    names = ["x", "u", "p", "t"] if timed else ["x", "u", "p"]

    def function(name: str, inputs: list[Expression], result: Expression, output: str) -> Expression:
        return ca.Function(name, inputs[: len(names)], [result], names, [output])

    x, u, p = ca.SX.sym("x", eq.z.numel()), ca.SX.sym("u"), ca.SX.sym("p", eq.p.numel())
    t = ca.SX.sym("t") if timed else ca.SX(0)
    p_full = with_defaults(p, identified)
    plain = signed(eq, eq.zdot, ca.DM([surface.width for surface in smoothed]) if smoothed else None)
    field = ca.Function("field", [eq.z, eq.t, eq.u, eq.p], [plain])
    made = {
        "casadi": function("f", [x, u, p, t], exact_field(eq, x, u, p_full, t), "xdot"),
        "output.casadi": function("output", [x, u, p, t], exact_output(eq, x, u, p_full, t), "y"),
        "smooth.casadi": function("f_smooth", [x, u, p, t], field(x, t, u, p_full), "xdot"),
    }

    start, forces, given = ca.MX.sym("x", eq.z.numel()), ca.MX.sym("u", 2), ca.MX.sym("p", eq.p.numel())
    clock = ca.MX.sym("t") if timed else ca.MX(0)
    inputs = [start, forces, given, clock]
    made["step.casadi"] = function("step", inputs, event_step(start, forces, given, clock, dt), "x_next")

    pace = _pace(oscillator, eq, plain, facts.sample)
    check_step(dt, 1 / pace)
    count = max(1, math.ceil(dt * pace))
    state, force_line, h = start, (forces[1] - forces[0]) / dt, dt / count
    full = with_defaults(given, identified)
    for n in range(count):
        state = dormand_prince(
            lambda z, tau: field(z, clock + tau, forces[0] + force_line * tau, full), state, n * h, h
        )
    smooth_step = function("step_smooth", inputs, state, "x_next")
    if count * field.n_instructions() <= _EXPANDED:
        smooth_step = smooth_step.expand()  # scalar by scalar: an optimiser's derivatives cost about half
    made["smooth.step.casadi"] = smooth_step
    return Functions(made, tuple(smoothed), timed)


def _pace(oscillator: Oscillator, eq: Equations, smooth: Expression, sample: Sample) -> float:
    """Internal steps a second that the smooth right-hand side needs, from its eigenvalues along the motion."""
    import casadi as ca

    p = np.array(list(oscillator.values().values()))
    jacobian = ca.Function("jacobian", [eq.z, eq.t, eq.u, eq.p], [ca.densify(ca.jacobian(smooth, eq.z))])
    matrices = [np.array(jacobian(np.zeros(eq.z.numel()), 0.0, 0.0, p))]
    matrices += [np.array(jacobian(z, t, u, p)) for z, t, u in zip(sample.z.T, sample.t, sample.u, strict=True)]
    rates = np.linalg.eigvals(np.array([m for m in matrices if np.all(np.isfinite(m))] or [np.zeros((1, 1))]))
    steps = np.where(np.abs(rates.imag) > 0, _SMOOTH_STEPS / (2 * math.pi), _SMOOTH_STEPS_PER_DECAY)
    return max(float(np.max(steps * np.abs(rates))), _SMOOTH_STEPS / (2 * math.pi) * oscillator.omega0.value)


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
    facts = Facts(oscillator)
    made = functions(facts, dt)
    with together():
        for suffix, function in made.by_suffix.items():
            target = path.with_name(f"{stem}.{suffix}")
            write(target, serialised(function))
            written.append(target)
        header = f"{stem}.{HEADER}"
        texts = step_c(
            made.by_suffix["smooth.step.casadi"], prefix_of(identifier_of(oscillator.name)), oscillator.name, dt, header
        )
        for name, text in zip((f"{stem}.{SOURCE}", header), texts, strict=True):
            write(path.with_name(name), text)
            written.append(path.with_name(name))
        target = path.with_name(f"{stem}.{DESCRIPTION}")
        write(target, json.dumps(describe(facts, stem, dt, made), indent=2, ensure_ascii=False) + "\n")
    return (*written, target)


def serialised(function: Expression) -> bytes:
    """What ``function.save`` writes to a file, without a word where the disk is full."""
    import casadi as ca

    serializer = ca.StringSerializer()
    serializer.pack(function)
    return serializer.encode().encode("ascii")


def describe(facts: Facts, stem: str, dt: float, made: Functions) -> dict[str, Any]:
    """Names and units of everything that goes into and comes out of the functions."""
    oscillator, eq = facts.oscillator, facts.equations
    response = oscillator.response
    unit = response.displacement_unit
    force_unit = oscillator.force_unit if oscillator.mass is not None else units.compose("X/s2", unit)
    descriptions = oscillator.descriptions()
    state_units = [unit, units.compose("X/s", unit)]
    state_units += [units.compose(s.unit, unit, oscillator.force_unit, response.unit) for s in eq.inner]
    output_units = [response.unit, *state_units[:2], units.compose("X/s2", unit)]
    more = ", t" if made.timed else ""
    description: dict[str, Any] = {
        "format": "dashpot-casadi/1",
        "name": oscillator.name,
        "equation": oscillator.equation(),
        "files": {
            f"{stem}.casadi": f"xdot = f(x, u, p{more}), exact",
            f"{stem}.step.casadi": f"x_next = step(x, u, p{more}), event-exact; u held, "
            "or [u, u_next] for a straight line",
            f"{stem}.output.casadi": f"y = output(x, u, p{more}), exact; y[0] is the response as recorded",
            f"{stem}.smooth.casadi": f"xdot = f_smooth(x, u, p{more}), sgn(g) replaced by tanh(g / width)",
            f"{stem}.smooth.step.casadi": f"x_next = step_smooth(x, u, p{more}) of the smooth right-hand side",
        },
        "x": [
            {"name": name, "unit": unit, "starts_from": None if leader is None else eq.state_names[leader]}
            for name, unit, leader in zip(eq.state_names, state_units, eq.follows, strict=True)
        ],
        "u": [{"name": "F", "unit": force_unit, "hold": oscillator.hold, "step_takes": _STEP_TAKES[oscillator.hold]}],
        "p": [
            {"name": name, "value": q.value, "std": q.std, "unit": q.unit, "description": descriptions[name]}
            for name, q in oscillator.parameters().items()
        ],
        "p_default": "p left out (all zeros) stands for the identified values, inf in an element for its own",
        "y": [{"name": name, "unit": unit} for name, unit in zip(eq.output_names, output_units, strict=True)],
        "state_of_fit": state_of_fit(oscillator),
        "recordings": [dict(recording) for recording in oscillator.identified.recordings],
        "step_s": dt,
        "smoothing_width": [{"surface": g.text, "width": g.width, "unit": g.unit} for g in made.surfaces],
    }
    if made.timed:
        description["t"] = {"unit": "s", "default": 0.0, "meaning": "time; for a step that at its start"}
    return description

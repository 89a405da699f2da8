"""A linear model in the oscillator's place: about a point that a force holds, or about a motion of some amplitude.

About a point the laws' tangents count (Taylor). Where a force jumps it has none: dry friction and preload then have no
part in a small motion, which their steps rule in truth. About a motion the describing functions k(A, omega) and
d(A, omega) take the place of all spring and damping forces (Krylov and Bogoliubov 1937; ``describing``): a loop that is
designed with them meets the frequency and the damping that the rig has at that amplitude.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..files.arguments import number_of
from . import units
from .as_recorded import as_recorded
from .describing import HarmonicMotion
from .equations import Equations, SurfaceKind, equations
from .quantity import in_unit

if TYPE_CHECKING:
    from .oscillator import Oscillator

_TURNS = 50
_SETTLED, _RESTING = 1e-12, 1e-6  # change of an inner state, of itself; its rate, of itself, that is none
_NEAREST, _DOUBLINGS, _HALVINGS = 1e-9, 80, 60  # where a force's displacement is first looked for
#: Parameters of Eq. 17 that make a force: a motion's spring and damper stand in for all of them.
_FORCES = ("omega0", "cubic", "preload", "viscous", "dry")


@dataclass(frozen=True, eq=False, repr=False)
class LinearModel:
    """``dz/dt = A (z - z0) + B (u - u0)``, ``y - y0 = C (z - z0) + D (u - u0)``.

    Attributes:
        A, B, C, D: (n, n), (n, 1), (m, n), (m, 1), in the units of states, input and outputs.
        state, input, output: the point: z0 (n,), u0, y0 (m,).
        state_names, output_names: n and m names; first output: the response as recorded.
        state_units, output_units, input_unit: their units.
        amplitude, omega: of the motion that it is about, in the displacement's unit and rad/s; None about a point.
        notes: what the linear model leaves out, one sentence each.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    state: np.ndarray
    input: float
    output: np.ndarray
    state_names: tuple[str, ...]
    output_names: tuple[str, ...]
    state_units: tuple[str, ...]
    output_units: tuple[str, ...]
    input_unit: str
    amplitude: float | None = None
    omega: float | None = None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return describe(self)

    @property
    def poles(self) -> np.ndarray:
        """(n,) eigenvalues of A, 1/s, the slowest first."""
        found = np.linalg.eigvals(self.A)
        return found[np.lexsort((found.imag, np.abs(found)))]

    def to_scipy(self) -> Any:
        """A ``scipy.signal.StateSpace`` of A, B, C, D: of deviations from the point."""
        from .state_space import of_scipy

        return of_scipy((self.A, self.B, self.C, self.D))

    def to_control(self) -> Any:
        """A ``control.StateSpace`` of python-control, with the names of states, input and outputs.

        Raises BadInput where the package control is not installed.
        """
        from .state_space import of_control

        names = {"states": list(self.state_names), "inputs": ["F"], "outputs": list(self.output_names)}
        return of_control((self.A, self.B, self.C, self.D), names)

    def discrete(self, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """A (n, n) and B (n, 1) from sample to sample, dt seconds apart, the input held between; exact.

        Raises BadInput where dt is not above zero.
        """
        from scipy.linalg import expm

        dt = number_of(dt, "the sample time")
        if not 0 < dt < math.inf:
            raise BadInput(f"a sample time of {dt:g} s: give a positive number of seconds")
        n = self.A.shape[0]
        both = expm(dt * np.block([[self.A, self.B], [np.zeros((1, n + 1))]]))
        return both[:n, :n], both[:n, n:]


def linearise(
    oscillator: Oscillator,
    *,
    amplitude: float | str | None = None,
    frequency: float | str | None = None,
    displacement: float | str | None = None,
    force: float | str | None = None,
) -> LinearModel:
    """The linear model about a motion (``amplitude``) or about a point, whose trim is found by itself.

    Each is a number, or a text with a unit of its own such as "1 mm".

    Args:
        oscillator: the model.
        amplitude: of the motion about the middle, in the displacement's unit.
        frequency: of that motion, Hz; left out, the natural frequency at this amplitude.
        displacement: of the point; the force that holds it there is found.
        force: that holds the point; the displacement is found. With neither: the middle, and what holds it there.

    Raises:
        BadInput: for a motion and a point at once, an amplitude or frequency that is not above zero, a motion that does
            not exist, or a point that no force holds.
    """
    about = {"amplitude": amplitude, "frequency": frequency, "displacement": displacement, "force": force}
    found = [None if value is None else _in_unit_of(oscillator, value, name) for name, value in about.items()]
    return _linear(oscillator, *found)


def _in_unit_of(oscillator: Oscillator, given: float | str, name: str) -> float:
    """A length, a frequency or a force in the model's unit."""
    unit = {"frequency": "Hz", "force": _input_unit(oscillator)}.get(name, oscillator.response.displacement_unit)
    return in_unit(given, unit, name)


def _linear(
    oscillator: Oscillator,
    amplitude: float | None,
    frequency: float | None,
    displacement: float | None,
    force: float | None,
) -> LinearModel:
    oscillator = _without_disturbances(oscillator)
    point = displacement is not None or force is not None
    if amplitude is None and frequency is not None:
        raise BadInput(f"a frequency of {frequency:g} Hz without an amplitude is no motion; give both")
    if frequency is not None and not 0 < frequency < math.inf:
        raise BadInput(f"a frequency of {frequency:g} Hz: give a positive number")
    if amplitude is not None and point:
        raise BadInput("a motion (amplitude) or a point (displacement or force): give one of them")
    if displacement is not None and force is not None:
        raise BadInput("displacement and force of a point follow from each other; give one of them")
    if amplitude is not None:
        return _about_motion(oscillator, amplitude, frequency)
    for name, value in (("displacement", displacement), ("force", force)):
        if value is not None and not math.isfinite(value):
            raise BadInput(f"a {name} of {value:g}: give a finite number")
    at = _Point(oscillator)
    if force is not None:
        return at.linear(*at.held_by(force))
    return at.linear(*at.trim(displacement or 0.0))


def _without_disturbances(oscillator: Oscillator) -> Oscillator:
    """The oscillator without forces that nobody recorded, whose phase is free: they are inputs of their own."""
    eq = equations(oscillator)
    free = {name.rpartition(".")[0] for name, free in zip(eq.state_names, eq.free, strict=True) if free}
    return replace(oscillator, terms=tuple(term for term in oscillator.terms if term.effect not in free))


def _input_unit(o: Oscillator) -> str:
    """Unit of the force, or of the force per unit mass where the mass is not known."""
    return o.force_unit if o.mass is not None else units.compose("X/s2", o.response.displacement_unit)


def _length(oscillator: Oscillator, value: float, digits: int = 4) -> str:
    """A displacement as its recordings had it, in words."""
    shown, unit = as_recorded(oscillator, value, oscillator.response.displacement_unit)
    return f"{shown:.{digits}g} {unit}"


def _about_motion(oscillator: Oscillator, amplitude: float, frequency: float | None) -> LinearModel:
    motion = HarmonicMotion(oscillator)
    size = _length(oscillator, amplitude, 6)
    omega = motion.natural(amplitude)[0] if frequency is None else np.array([2 * math.pi * frequency])
    if not np.all(np.isfinite(omega)):
        raise BadInput(
            f"at an amplitude of {size} the spring holds no motion of its own; choose another amplitude, "
            "or give the frequency of the motion"
        )
    k, d = motion(amplitude, omega)
    if not (np.isfinite(k[0]) and np.isfinite(d[0])):
        raise BadInput(f"no periodic motion of {size} is found at this frequency; choose another")
    # what is neither spring nor damper stays: the actuator before the mass and the sensor behind it
    paths = tuple(term for term in oscillator.terms if not term.law.force)
    zeros = {name: replace(getattr(oscillator, name), value=0.0) for name in _FORCES}
    bare = _Point(replace(oscillator, terms=paths, **zeros))
    plain = bare.linear(np.zeros(bare.eq.z.numel()), 0.0, spring=float(k[0]), damper=float(d[0]))
    effects = " and ".join(term.effect for term in paths)
    notes = (f"{effects}: by the tangent at rest, whatever the amplitude",) if paths else ()
    covered = oscillator.amplitude
    if covered is not None and not covered.min <= amplitude <= covered.max:
        stated = f"{_length(oscillator, covered.min)} to {_length(oscillator, covered.max)}"
        notes += (f"the amplitude is outside what the model was identified in, {stated}",)
    return replace(plain, amplitude=float(amplitude), omega=float(omega[0]), notes=notes)


class _Point:
    """The equations of one oscillator with its values, their tangents, and where they are at rest."""

    def __init__(self, oscillator: Oscillator) -> None:
        import casadi as ca

        self.oscillator = oscillator
        self.eq: Equations = equations(oscillator)
        eq = self.eq
        known, given = ca.vertcat(eq.t, eq.p), ca.DM([0.0, *oscillator.values().values()])
        self._extra = [ca.SX.sym("k"), ca.SX.sym("d")]
        zdot, y, g = ca.substitute([eq.zdot, eq.y, eq.surfaces], [known], [given])
        pull = self._extra[0] * eq.z[0] + self._extra[1] * eq.z[1]
        acceleration = zdot[1] - pull
        zdot = ca.vertcat(zdot[0], acceleration, zdot[2:])
        y = ca.vertcat(y[0] - pull if eq.recorded == "acceleration" else y[0], y[1], y[2], acceleration)
        inputs = [eq.z, eq.u, eq.s, *self._extra]
        matrices = [ca.densify(ca.jacobian(f, x)) for f in (zdot, y) for x in (eq.z, eq.u)]
        self._tangents = ca.Function("tangents", inputs, matrices)
        self._value = ca.Function("value", inputs, [ca.densify(zdot), ca.densify(y)])
        self._surfaces = ca.Function("surfaces", [eq.z, eq.u], [ca.densify(g)])
        self._still = np.array([kind is SurfaceKind.VELOCITY for kind in eq.kinds], dtype=bool)

    def _signs(self, z: np.ndarray, u: float) -> np.ndarray:
        s = np.sign(np.array(self._surfaces(z, u))).ravel()
        s[self._still] = 0.0
        return s

    def _settled(self, x: float, u: float) -> tuple[np.ndarray, float]:
        """State (n,) with the inner states at rest at a displacement under a force, and the acceleration left there."""
        z = np.array([x, 0.0, *(x if leader == 0 else 0.0 for leader in self.eq.follows[2:])])
        for _ in range(_TURNS if z.size > 2 else 0):
            s = self._signs(z, u)
            rates = np.array(self._value(z, u, s, 0, 0)[0]).ravel()[2:]
            slopes = np.array(self._tangents(z, u, s, 0, 0)[0])[2:, 2:]
            change = np.linalg.lstsq(slopes, -rates, rcond=None)[0]
            z[2:] += change
            if np.all(np.abs(change) <= _SETTLED * np.abs(z[2:])):
                break
        rates = np.array(self._value(z, u, self._signs(z, u), 0, 0)[0]).ravel()
        resting = np.all(np.abs(rates[2:]) <= _RESTING * (1.0 + np.abs(z[2:])))
        return z, float(rates[1]) if resting else math.nan

    def trim(self, x: float) -> tuple[np.ndarray, float]:
        """State (n,) at rest at the displacement ``x`` and the force that holds it there, friction left out."""
        rest = self._settled(x, 0.0)[1]
        push = -math.copysign(1.0, rest)
        mass = 1.0 if self.oscillator.mass is None else self.oscillator.mass.value
        size = _root(lambda w: push * self._settled(x, push * w)[1], abs(rest), 0.5 * mass * abs(rest))
        if size is None:
            where = _length(self.oscillator, x, 6)
            raise BadInput(f"no force is found that holds the displacement {where}; choose one nearer to the middle")
        return self._settled(x, push * size)[0], push * size

    def held_by(self, force: float) -> tuple[np.ndarray, float]:
        """State (n,) at rest under ``force``, and that force: the nearest to the middle where there are several."""
        rest = self._settled(0.0, force)[1]
        way = math.copysign(1.0, rest)
        size = _root(lambda w: -way * self._settled(way * w, force)[1], abs(rest), _NEAREST)
        if size is None:
            raise BadInput(f"the spring holds no force of {force:g} {_input_unit(self.oscillator)}; give a smaller one")
        seated = size <= 1e-9 * _NEAREST  # a preloaded spring
        return self._settled(0.0 if seated else way * size, force)[0], force

    def linear(self, z: np.ndarray, u: float, *, spring: float = 0.0, damper: float = 0.0) -> LinearModel:
        """Tangents at a point, with a further spring and damper per unit mass."""
        o, eq, s = self.oscillator, self.eq, self._signs(z, u)
        a, b, c, d = (np.array(m) for m in self._tangents(z, u, s, spring, damper))
        y = np.array(self._value(z, u, s, spring, damper)[1]).ravel()
        length = o.response.displacement_unit
        speed, acceleration = units.compose("X/s", length), units.compose("X/s2", length)
        inner = [units.compose(i.unit, length, o.force_unit, o.response.unit) for i in eq.inner]
        jumps = [name for name in ("dry", "preload") if getattr(o, name).value and (name == "dry" or z[0] == 0.0)]
        notes = [f"{' and '.join(jumps)}: no tangent where a force jumps; an amplitude counts it"] if jumps else []
        return LinearModel(
            *(a, b, c, d),
            *(z, u, y),
            state_names=eq.state_names,
            output_names=eq.output_names,
            state_units=(length, speed, *inner),
            output_units=(o.response.unit, length, speed, acceleration),
            input_unit=_input_unit(o),
            notes=tuple(notes),
        )


def _root(value: Callable[[float], float], short: float, first: float) -> float | None:
    """Where ``value``, at zero -``short``, first rises above zero, looked for from ``first`` on; None: nowhere."""
    if short == 0.0:
        return 0.0
    low, high = 0.0, first
    for _ in range(_DOUBLINGS):
        if value(high) >= 0.0:
            break
        low, high = high, 2 * high
    else:
        return None
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (low, middle) if value(middle) >= 0.0 else (middle, high)
    return high


def describe(linear: LinearModel, step: float | None = None) -> str:
    """The linear model as text; with a sample time ``step``, s, the discrete A and B too, which may raise BadInput."""
    states = ", ".join(f"{n} {u}" for n, u in zip(linear.state_names, linear.state_units, strict=True))
    outputs = ", ".join(f"{n} {u}" for n, u in zip(linear.output_names, linear.output_units, strict=True))
    parts = [f"{_about(linear)}\n{_poles(linear)}", f"z: {states}\nu: force {linear.input_unit}\ny: {outputs}"]
    parts += [_matrix(name, getattr(linear, name)) for name in "ABCD"]
    if step is not None:
        a, b = linear.discrete(step)
        parts += [_matrix(f"A, {step:g} s", a), _matrix(f"B, {step:g} s, the force held", b)]
    parts += [f"note: {note}" for note in linear.notes]
    return "\n\n".join(parts)


def as_json(linear: LinearModel, step: float | None = None) -> dict[str, Any]:
    """The same as plain data for ``json.dumps``."""
    about = {
        "amplitude": linear.amplitude,
        "frequency_hz": None if linear.omega is None else linear.omega / (2 * math.pi),
        "state": linear.state.tolist(),
        "force": linear.input,
        "output": linear.output.tolist(),
    }
    poles = [
        {"real": float(p.real), "imaginary": float(p.imag), "frequency_hz": abs(p) / (2 * math.pi)}
        for p in linear.poles
    ]
    data: dict[str, Any] = {
        "format": "dashpot-linear/1",
        "about": about,
        "poles": poles,
        **{name: getattr(linear, name).tolist() for name in "ABCD"},
        "states": _named(linear.state_names, linear.state_units),
        "input": {"name": "F", "unit": linear.input_unit},
        "outputs": _named(linear.output_names, linear.output_units),
        "notes": list(linear.notes),
    }
    if step is not None:
        a, b = linear.discrete(step)
        data["discrete"] = {"step_s": step, "hold": "zero", "A": a.tolist(), "B": b.tolist()}
    return data


def _named(names: tuple[str, ...], units: tuple[str, ...]) -> list[dict[str, str]]:
    return [{"name": name, "unit": unit} for name, unit in zip(names, units, strict=True)]


def _about(linear: LinearModel) -> str:
    if linear.amplitude is not None and linear.omega is not None:
        length, hertz = linear.state_units[0], linear.omega / (2 * math.pi)
        return f"about a motion of amplitude {linear.amplitude:g} {length} at {hertz:.6g} Hz"
    at = f"{linear.state[0]:.6g} {linear.state_units[0]}, held by {linear.input + 0.0:.6g} {linear.input_unit}"
    return f"about the point {at}"


def _poles(linear: LinearModel) -> str:
    """The poles, a line each or for each pair: natural frequency and damping ratio, or a time constant."""
    lines = []
    for pole in linear.poles:
        size = abs(pole)
        if pole.imag > 0.0:
            lines.append(
                f"poles {pole.real:.6g} ± {pole.imag:.6g}i 1/s: {size / (2 * math.pi):.6g} Hz, "
                f"damping ratio {-pole.real / size:.4g}"
            )
        elif pole.imag == 0.0:
            constant = f", time constant {-1.0 / pole.real:.4g} s" if pole.real < 0.0 else ""
            lines.append(f"pole {pole.real:.6g} 1/s{constant}")
    return "\n".join(lines)


def _matrix(name: str, matrix: np.ndarray) -> str:
    cells = [[f"{value:.9g}" for value in row] for row in matrix]
    width = max(len(cell) for row in cells for cell in row)
    return f"{name} =\n" + "\n".join("  " + "  ".join(cell.rjust(width) for cell in row) for row in cells)

"""How widely each switching surface is smoothed: a thousandth of what it goes through in the model's own motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from ..model import units
from ..model.equations import Equations, SurfaceKind, signed
from ..model.law import Expression
from ..simulate.casadi_step import exact_step

if TYPE_CHECKING:
    from ..model import Oscillator

#: Smoothing width over half of the range of the surface's values in the motion.
RELATIVE_WIDTH = 1e-3
#: Amplitude that stands in where the model file states no range: 1 in its own unit is as good a guess as any.
_DEFAULT_AMPLITUDE = 1e-2
#: The motion that is looked at: so many points of so many cycles.
_CYCLES, _POINTS, _MOST_POINTS = 6, 60, 1200
#: Internal steps that a CasADi step may hold; the file grows with them.
MOST_STEPS = 2000


@dataclass(frozen=True)
class Surface:
    """One switching surface: its expression as text, its smoothing width and the unit of both."""

    text: str
    width: float
    unit: str


def amplitude_of(oscillator: Oscillator) -> float:
    """Largest amplitude that the model was identified for, in the displacement's unit."""
    return oscillator.amplitude.max if oscillator.amplitude is not None else _DEFAULT_AMPLITUDE


@dataclass(frozen=True, eq=False)
class Sample:
    """A motion of the model: states (states, n), times (n,) in s, forces (n,)."""

    z: np.ndarray
    t: np.ndarray
    u: np.ndarray


def check_step(dt: float, longest: float) -> None:
    """Make sure that a step of ``dt`` can be written out in internal steps no longer than ``longest``.

    Raises BadInput where it takes more than ``MOST_STEPS``.
    """
    if dt > MOST_STEPS * longest:
        raise BadInput(
            f"the step of {dt:g} s takes {dt / longest:.0f} internal steps, for the model's fastest motion needs steps "
            f"of {longest:.2g} s; choose one below {MOST_STEPS * longest:.2g} s, or leave out the law that is so fast"
        )


def sample_motion(oscillator: Oscillator, eq: Equations, longest: float) -> Sample:
    """The motion from the largest amplitude on, under a force at the natural frequency that about keeps it up.

    Args:
        oscillator: the model.
        eq: its equations.
        longest: longest internal step, s.

    Raises:
        BadInput: the model's fastest motion is too fast to be followed.
    """
    amplitude, omega = amplitude_of(oscillator), oscillator.omega0.value
    speed = amplitude * omega
    size = max(abs(oscillator.viscous.value) * speed + abs(oscillator.dry.value), 0.01 * omega * speed)
    size *= oscillator.mass.value if oscillator.mass is not None else 1.0
    period = 2 * math.pi / omega
    points = int(min(max(period / longest / 20, _POINTS), _MOST_POINTS))
    dt = period / points
    check_step(dt, longest)
    step = exact_step(oscillator, dt, longest)
    t = np.arange(_CYCLES * _POINTS + 1 if points == _POINTS else points + 1) * dt
    u = -size * np.sin(omega * t)  # along the velocity
    leaders = [amplitude, 0.0]
    z = np.array([*leaders, *(0.0 if leader is None else leaders[leader] for leader in eq.follows[2:])])
    p = list(oscillator.values().values())
    states = [z]
    for k in range(t.size - 1):
        z = np.array(step(z, [u[k], u[k + 1]], p, t[k], dt)).ravel()
        if not np.all(np.isfinite(z)):
            break
        states.append(z)
    return Sample(np.array(states).T, t[: len(states)], u[: len(states)])


def surfaces(oscillator: Oscillator, eq: Equations, sample: Sample | None) -> list[Surface]:
    """Text, width and unit of each surface.

    Displacement and velocity go from plus to minus the largest amplitude, or omega0 times it; for any other surface
    the half range is taken from ``sample``, which may be None where there is none.
    """
    import casadi as ca

    amplitude = amplitude_of(oscillator)
    names = texts(eq)
    ranges = np.zeros(len(eq.kinds))
    if sample is not None and eq.kinds:
        values = ca.Function("g", [eq.z, eq.t, eq.u, eq.p], [signed(eq, eq.surfaces)])
        p = np.tile(np.array(list(oscillator.values().values()))[:, None], sample.t.size)
        g = np.array(values(sample.z, sample.t[None, :], sample.u[None, :], p))
        ranges = np.where(np.ptp(g, axis=1) > 0, np.ptp(g, axis=1) / 2, np.max(np.abs(g), axis=1))
    given, surfaces = _units(oscillator, eq), []
    for i, kind in enumerate(eq.kinds):
        size = float(ranges[i]) or 1.0
        if kind is not SurfaceKind.OTHER:
            size = amplitude * (oscillator.omega0.value if kind is SurfaceKind.VELOCITY else 1.0)
        surfaces.append(Surface(names[i], RELATIVE_WIDTH * size, unit_of(eq, eq.surfaces[i], given)))
    return surfaces


@dataclass(frozen=True)
class MotionSize:
    """Sizes of a model's own motion: of its surfaces, their ranges and its states."""

    surfaces: tuple[Surface, ...]
    nominals: tuple[float, ...]

    @property
    def ranges(self) -> tuple[float, ...]:
        """Size that each surface goes through."""
        return tuple(surface.width / RELATIVE_WIDTH for surface in self.surfaces)


def motion_size(oscillator: Oscillator, eq: Equations, sampled: Callable[[], Sample]) -> MotionSize:
    """How large surfaces and states become; inner ones as in the motion at the natural frequency.

    Args:
        oscillator: the model.
        eq: its equations.
        sampled: that motion, called only where it is needed; it may raise BadInput.
    """
    amplitude = amplitude_of(oscillator)
    nominals = [amplitude, amplitude * oscillator.omega0.value or amplitude]
    sample = None
    if eq.inner or SurfaceKind.OTHER in eq.kinds:
        try:
            sample = sampled()
        except BadInput:  # no spring, or a motion too fast to be followed here: sizes of 1 are as good as any
            sample = None
    for i in range(len(eq.inner)):
        reached = 0.0 if sample is None else float(np.max(np.abs(sample.z[2 + i])))
        nominals.append(reached or 1.0)
    return MotionSize(tuple(surfaces(oscillator, eq, sample)), tuple(nominals))


def texts(eq: Equations, driven: str = "F") -> list[str]:
    """The surfaces as text, with the names of states and parameters; ``driven`` is that of the input."""
    import casadi as ca

    states = ca.vertcat(*[ca.SX.sym(name) for name in ("x", "v", *eq.state_names[2:])])
    names = ca.vertcat(*[ca.SX.sym(name) for name in eq.parameter_names])
    known, named = ca.vertcat(eq.z, eq.t, eq.u, eq.p), ca.vertcat(states, ca.SX.sym("t"), ca.SX.sym(driven), names)
    return [str(ca.substitute(eq.surfaces[i], known, named)) for i in range(len(eq.kinds))]


def _units(oscillator: Oscillator, eq: Equations) -> list[str]:
    """Units of states, time, force and parameters."""
    response = oscillator.response
    length = response.displacement_unit
    force = oscillator.force_unit if oscillator.mass is not None else units.compose("X/s2", length)
    inner = [units.compose(s.unit, length, oscillator.force_unit, response.unit) for s in eq.inner]
    parameters = [p.unit for p in oscillator.parameters().values()]
    return [length, units.compose("X/s", length), *inner, "s", force, *parameters]


def unit_of(eq: Equations, surface: Expression, given: Sequence[str]) -> str:
    """Unit of a surface, from how it grows when all in it is measured in other units; ``1`` where it is mixed.

    ``given`` has the units of states, time, input and parameters, in this order.
    """
    import casadi as ca

    factors = [units.factors(unit) for unit in given]
    symbols = ca.vertcat(eq.z, eq.t, eq.u, eq.p, eq.s)
    value = ca.Function("g", [symbols], [surface])
    random = np.random.default_rng(0)
    point = random.uniform(0.5, 1.5, symbols.numel())
    powers: dict[str, int] = {}
    for base in dict.fromkeys(symbol for factor in factors for symbol in factor):
        scaled = point.copy()
        scaled[: len(factors)] *= [2.0 ** factor.get(base, 0) for factor in factors]
        ratio = float(value(scaled)) / float(value(point))
        power = math.log2(ratio) if ratio > 0 else math.nan
        if not abs(power - round(power)) < 1e-6:
            return "1"
        powers[base] = round(power)
    return units.render({base: power for base, power in powers.items() if power})

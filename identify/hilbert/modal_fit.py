"""Eqs. 1, 6 and 7 fitted to instantaneous modal parameters over time, FREEVIB's and FORCEVIB's alike.

The laws are low-passed like the values they are fitted to, so that the low-pass bends neither preload nor friction; the
amplitude is that of the fundamental, and what further harmonics do to it is taken off (``further_harmonics``). Errors
are those of the sensors' white noise, followed to the samples (``modal_stretch``); where the curves miss the law by
more than that noise, they are as much larger. Where they miss it by far, other physics moves the rig, the parameters
stand in for it, and no error would hold: none is stated (``ModalFit.without_errors``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import BadInput
from ...model.backbone import preload_backbone
from ...model.fit_state import LACKING
from ..signals.odds import BY_CHANCE
from ..signals.registry import budget, numerics
from .further_harmonics import further_harmonics, peak_of
from .limits import LEAST_POINTS
from .modal_mass import MassFit
from .modal_result import LawFit, ModalFit
from .modal_stretch import CurveNoise, Stretch, curve_noise

_SETTLED = numerics(1e-9, "of its value", why="rounding")

_ROUNDS = budget(3, "rounds", why="the errors of the points depend on what is found")
EQ17: tuple[str, ...] = ("omega0", "cubic", "preload", "viscous", "dry")
_STEP = numerics(1e-4, "of a parameter", why="for a derivative")

#: Columns (p, n) of a law and their slopes with ln A, at a stretch's amplitudes.
_Law = Callable[[Stretch, np.ndarray], tuple[np.ndarray, np.ndarray]]


def modal_fit(stretches: Sequence[Stretch], mass: MassFit | None = None) -> ModalFit:
    """Fit Eqs. 1, 6 and 7 to one or several stretches of one method, with FORCEVIB's mass where they are driven.

    Raises:
        BadInput: too few points stand clear of the noise, or no positive stiffness comes out.
    """
    given = mass or MassFit(rows=tuple(np.zeros(0) for _ in stretches))
    spring, friction = spring_and_friction(stretches, given)
    squared = float(spring.value[0])
    covariance = _covariance((spring, friction), given)
    both = _law_fit("preload and polynomial", ("omega0", "cubic", "preload"), spring, covariance[1:4, 1:4])
    damping = _law_fit("viscous and dry", ("viscous", "dry"), friction, covariance[4:, 4:])
    of_spring = [curve.noise for curve in spring.curves]
    polynomial = tuple(
        _spring(s, given, _polynomial, 0.0, spring.value[:2], n) for s, n in zip(stretches, of_spring, strict=True)
    )
    polynomial = _Fit(polynomial, given)
    fits = {
        "preload": _preload_fit(stretches, given, spring, of_spring),
        "polynomial": _law_fit(
            "polynomial", ("omega0", "cubic"), polynomial, _covariance((polynomial,), given)[1:, 1:]
        ),
    }
    # of k = m omega0², F0 = m preload and F0/k, from 1/m, omega0² and the preload
    m = 1 / given.inverse if mass is not None else 1.0
    p = float(spring.value[2])
    slopes = np.zeros((3, len(covariance)))
    slopes[0, :2] = -(m**2) * squared, m
    slopes[1, [0, 3]] = -(m**2) * p, m
    slopes[2, [1, 3]] = -p / squared**2, 1 / squared
    derived: dict[str, float] = {"k": m * squared, "F0": m * p, "F0/k": p / squared}
    spread = np.sqrt(np.diag(slopes @ covariance @ slopes.T))
    errors: dict[str, float] = dict(zip(derived, map(float, spread), strict=True))
    if mass is None:
        derived, errors = ({"F0/k": d["F0/k"]} for d in (derived, errors))
    found = ModalFit(
        **fits,
        both=both,
        damping=damping,
        mass=m if mass is not None else None,
        mass_std=m**2 * given.std if mass is not None else float("inf"),
        derived=derived,
        derived_std=errors,
    )
    return found if found.over_noise <= LACKING else found.without_errors


def spring_and_friction(stretches: Sequence[Stretch], mass: MassFit, rounds: int = _ROUNDS) -> tuple[_Fit, _Fit]:
    """Eq. 6 with the preload, and Eq. 7, fitted in turn with what the harmonics that they make add to them.

    Raises:
        BadInput: too few points stand clear of the noise, or no positive stiffness comes out.
    """
    further = [(np.zeros(s.signal.time.size),) * 2 for s in stretches]
    noise: list[tuple[CurveNoise | None, CurveNoise | None]] = [(None, None) for _ in stretches]
    spring, friction = _Fit((), mass), _Fit((), mass)
    for k in range(rounds):
        each = list(zip(stretches, further, noise, strict=True))
        spring = _Fit(tuple(_spring(s, mass, _both, f[0], spring.value, n[0]) for s, f, n in each), mass)
        friction = _Fit(tuple(_damper(s, mass, f[1], friction.value, n[1]) for s, f, n in each), mass)
        if not spring.value[0] > 0:
            raise BadInput("The backbone leads to no positive stiffness: this is not the motion of one oscillator.")
        if k == 1:  # the first knows nothing of the laws' slopes; later ones would change weights only, and little
            noise = [(a.noise, b.noise) for a, b in zip(spring.curves, friction.curves, strict=True)]
        if k + 1 < rounds:
            found = dict(zip(EQ17, [*spring.value, *friction.value], strict=True))
            found["omega0"] = float(np.sqrt(found["omega0"]))
            further = [
                tuple(map(np.add, further_harmonics(a.stretch, found), _across(a, b, spring.value, friction.value)))
                for a, b in zip(spring.curves, friction.curves, strict=True)
            ]
    return spring, friction


@dataclass(frozen=True, eq=False)
class _Curve:
    """What one stretch gives for a fit: columns and target low-passed, the rest by sample."""

    stretch: Stretch
    target: np.ndarray  # (k,)
    columns: np.ndarray  # (p, k)
    passed: np.ndarray  # (p, n), complex: what passes of the law's columns, of which `columns` are one part
    plain: np.ndarray  # (p, k), the columns at an amplitude without noise
    slopes: np.ndarray  # (p, n), the columns' change with ln A
    noise: CurveNoise
    on_error: np.ndarray  # (n,), complex: the target's change with the equation's error
    on_mass: np.ndarray  # (k,), with 1/m
    squared: np.ndarray  # (n,)
    damping: np.ndarray  # (n,)


class _Fit:
    """Weighted least squares over the curves of several stretches."""

    def __init__(self, curves: tuple[_Curve, ...], mass: MassFit) -> None:
        self.curves, self.mass = curves, mass
        self.value: Any = None
        if not curves:
            return
        count = sum(c.noise.count for c in curves)
        if count < LEAST_POINTS:
            raise BadInput(
                "Too little of the motion stands clear of its noise and changes slowly enough to fit a curve to it; "
                "record a larger or longer motion."
            )
        normal: Any = sum(c.noise.weigh(c.plain) @ c.columns.T for c in curves)
        size = np.abs(np.diag(normal))
        if not np.all(size > 0):
            raise BadInput("A parameter of the law does nothing at the amplitudes of this motion; fit another law.")
        scale = 1 / np.sqrt(size)
        self.inverse = scale[:, None] * np.linalg.pinv(normal * np.outer(scale, scale), rcond=1e-14) * scale
        self.value = self.inverse @ sum(c.noise.weigh(c.plain) @ c.target for c in curves)
        rest = [c.target - self.value @ c.columns for c in curves]
        left = sum(float(c.noise.weigh(r) @ r) for c, r in zip(curves, rest, strict=True))
        self.misfit = left / count
        self.count = count

    def left(self) -> list[np.ndarray]:
        """What each curve misses the law by, point for point, over its error: see ``CurveNoise.whitened``."""
        return [c.noise.whitened(c.target - self.value @ c.columns) for c in self.curves]

    @property
    def holds(self) -> bool:
        """Whether what the law leaves may be noise."""
        from scipy.special import gammaincinv

        return bool(self.misfit * self.count < 2 * gammaincinv(self.count / 2, 1 - BY_CHANCE))

    def _widened(self) -> float:
        """By how much the variance is larger than that of the sensors' noise, where the law misses by more than that.

        What noise leaves is white. What a law leaves goes on for a while, and its mean is off by as much more: by the
        sum of its autocorrelation as long as that is positive (Bartlett 1946, Geyer 1992).
        """
        if self.holds:
            return max(1.0, self.misfit)
        left = self.left()
        square = sum(float(rest @ rest) for rest in left)
        total = 1.0
        for lag in range(1, max(rest.size for rest in left) // 4):
            together = sum(float(rest[lag:] @ rest[: rest.size - lag]) for rest in left if rest.size > lag) / square
            if together <= 0:
                break
            total += 2 * together
        return self.misfit * total

    def rows(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """How the values change with the equation's error, (p, n) complex, and with ln A, (p, n), of each stretch."""
        gains = [self.inverse @ c.noise.weigh(c.plain) for c in self.curves]
        with_mass = sum(gain @ c.on_mass for gain, c in zip(gains, self.curves, strict=True))
        rows = []
        wide = np.sqrt(self._widened())
        for gain, c, of_mass in zip(gains, self.curves, self.mass.rows, strict=True):
            by_sample = c.stretch.before_low_pass(gain)
            on_error = by_sample * c.on_error
            if of_mass.size:
                on_error = on_error + np.outer(with_mass, of_mass)
            rows.append((wide * on_error, -wide * by_sample * (self.value @ c.slopes)))
        return rows


def _covariance(fits: Sequence[_Fit], mass: MassFit) -> np.ndarray:
    """Of 1/m and the values of the fits, which share their stretches."""
    total = np.zeros(())
    for i, curve in enumerate(fits[0].curves):
        stretch, of_mass = curve.stretch, mass.rows[i]
        n = stretch.signal.time.size
        parts = [fit.rows()[i] for fit in fits]
        first = of_mass if of_mass.size else np.zeros(n)
        on_error = np.concatenate([first[None], *(part[0] for part in parts)])
        on_amplitude = np.concatenate([np.zeros((1, n)), *(part[1] for part in parts)])
        moved, drive = stretch.noise_weights(on_error, on_amplitude, curve.squared, curve.damping, mass.inverse)
        total = total + stretch.noise**2 * moved @ moved.T + stretch.force_noise**2 * drive @ drive.T
    if mass.inverse:  # the misfit of the equation that the mass was found from
        wide = np.ones(len(total))
        wide[0] = mass.std / np.sqrt(total[0, 0])
        total = total * np.outer(wide, wide)
    return total


def _law_fit(law: str, names: tuple[str, ...], fit: _Fit, covariance: np.ndarray) -> LawFit:
    value, std = fit.value.copy(), np.sqrt(np.diag(covariance))
    if names[0] == "omega0":
        if not value[0] > 0:
            raise BadInput(f"The backbone by {law} leads to no positive stiffness: this is not one oscillator.")
        value[0] = np.sqrt(value[0])
        std[0] /= 2 * value[0]
    values, stds = (dict(zip(names, numbers.tolist(), strict=True)) for numbers in (value, std))
    found = LawFit(law, values, stds, fit.misfit)
    return found if found.over_noise <= LACKING else found.without_errors


def _spring(
    stretch: Stretch,
    mass: MassFit,
    law: _Law,
    further: np.ndarray | float,
    value: np.ndarray | None = None,
    noise: CurveNoise | None = None,
) -> _Curve:
    s, ratio = stretch.signal, stretch.ratio
    drive = np.zeros(s.omega.size, complex) if ratio is None else ratio
    rest = s.equation_second - mass.inverse * drive
    growth, omega = np.real(s.equation_first), np.imag(s.equation_first)
    squared, damping = -np.real(rest) + growth * np.imag(rest) / omega, -0.5 * np.imag(rest) / omega
    columns, slopes = law(stretch, stretch.amplitude)
    passed = stretch.passed(columns)
    on_error = -1 - 1j * growth / omega
    on_amplitude = np.zeros(omega.size) if value is None else -(value @ slopes)
    return _Curve(
        stretch,
        stretch.low_pass(squared - further),
        stretch.low_pass(np.real(passed)),
        passed,
        stretch.low_pass(law(stretch, stretch.smooth_amplitude)[0]),
        slopes,
        noise or curve_noise(stretch, on_error, on_amplitude, squared, damping, mass.inverse),
        on_error,
        stretch.low_pass(np.real(drive) - np.imag(drive) * growth / omega),
        squared,
        damping,
    )


def _damper(
    stretch: Stretch,
    mass: MassFit,
    further: np.ndarray | float,
    value: np.ndarray | None = None,
    noise: CurveNoise | None = None,
) -> _Curve:
    s, ratio = stretch.signal, stretch.ratio
    drive = np.zeros(s.omega.size, complex) if ratio is None else ratio
    rest = s.equation_second - mass.inverse * drive
    growth, omega = np.real(s.equation_first), np.imag(s.equation_first)
    squared, damping = -np.real(rest) + growth * np.imag(rest) / omega, -0.5 * np.imag(rest) / omega
    dry = 4 / (np.pi * stretch.amplitude * np.abs(s.equation_first))
    columns = np.stack([np.ones_like(dry), dry])
    passed = stretch.passed(columns, s.equation_first)
    slopes = np.stack([np.zeros_like(dry), -dry])
    on_error = 1j / omega
    on_amplitude = np.zeros(omega.size) if value is None else -(value @ slopes)
    return _Curve(
        stretch,
        stretch.low_pass(2 * damping - further),
        stretch.low_pass(np.imag(passed) / omega),
        passed,
        stretch.low_pass(np.stack([np.ones_like(dry), dry * stretch.amplitude / stretch.smooth_amplitude])),
        slopes,
        noise or curve_noise(stretch, on_error, on_amplitude, squared, damping, mass.inverse),
        on_error,
        stretch.low_pass(np.imag(drive) / omega),
        squared,
        damping,
    )


def _across(spring: _Curve, friction: _Curve, stiff: np.ndarray, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What the low-pass brings of friction into the stiffness, (n,), and of the spring into the damping 2 h, (n,).

    A law that varies within the kernel passes with a phase of its own, where the frequency runs too.
    """
    first = spring.stretch.signal.equation_first
    slope = np.real(first) / np.imag(first)
    pull, drag = stiff @ spring.passed, damping @ friction.passed
    return np.real(drag) - slope * np.imag(drag + pull), np.imag(pull) / np.imag(first)


def _both(stretch: Stretch, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    columns = np.stack([np.ones_like(a), 0.75 * a**2, 4 / (np.pi * a)])
    return columns, columns * np.array([[0.0], [2.0], [-1.0]])


def _polynomial(stretch: Stretch, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    columns, slopes = _both(stretch, a)
    return columns[:2], slopes[:2]


def _preload_fit(
    stretches: Sequence[Stretch], mass: MassFit, start: _Fit, noise: Sequence[CurveNoise]
) -> LawFit | None:
    """Eq. 1, which is not linear in its parameters, by Gauss and Newton; None where no preload is in the curves."""
    theta = start.value[[0, 2]]

    def squares(stretch: Stretch, amplitude: np.ndarray, values: np.ndarray) -> np.ndarray:
        base = float(np.sqrt(values[0]))
        peak = peak_of(amplitude, stretch.signal.omega, float(values[1]))
        out = np.full(peak.size, values[0])
        out[stretch.inside] = preload_backbone(base, float(values[1]), peak[stretch.inside]) ** 2
        return out

    try:
        fit = start
        for _ in range(4 * _ROUNDS):

            def law(stretch: Stretch, a: np.ndarray, at: np.ndarray = theta) -> tuple[np.ndarray, np.ndarray]:
                steps = np.maximum(_STEP * np.abs(at), 1e-12)
                columns = [
                    (squares(stretch, a, at + step * unit) - squares(stretch, a, at - step * unit)) / (2 * step)
                    for step, unit in zip(steps, np.eye(2), strict=True)
                ]
                return np.stack(columns), np.stack([np.zeros(columns[0].size), -columns[1]])

            curves = []
            for s, known in zip(stretches, noise, strict=True):
                columns = law(s, s.amplitude)[0]
                curves.append(_spring(s, mass, law, squares(s, s.amplitude, theta) - theta @ columns, theta, known))
            fit = _Fit(tuple(curves), mass)
            done = np.all(np.abs(fit.value - theta) < _SETTLED * np.abs(theta))
            theta = fit.value
            if done:
                break
        return _law_fit("preload", ("omega0", "preload"), fit, _covariance((fit,), mass)[1:, 1:])
    except (BadInput, FloatingPointError):
        return None

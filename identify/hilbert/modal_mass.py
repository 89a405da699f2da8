"""FORCEVIB's mass: that of which instants of one amplitude show one stiffness and one damping, whatever the force.

Feldman 1994 takes two instants of the same amplitude: omega0² and h0 are the same at both, and the mass is all that is
unknown. Here all pairs count at once: in the equation of motion over X,

    X''/X + 2 h0(A) X'/X + omega0²(A) - (1/m) F/X = 0,

omega0² and h0 are any smooth functions of the amplitude, and 1/m is what least squares leave for it beside them.
F/X, the functions and the weights share the noise of what they are compared with. What that does to the normal
equations is known from the sensors' noise and is taken off (Fuller 1987, section 2.2): else a loud force sensor's mass
is too large.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ...recording.smoothing import convolved
from ..signals.registry import budget, numerics
from .forced_regression import backbone_basis, damping_basis
from .limits import LEAST_PAIRS
from .modal_stretch import Stretch

_ROUNDS = budget(3, "rounds", why="of reweighting")
_ROUNDS_WITH_NOISE = budget(6, "rounds", why="what the noise adds depends on what is found")
_A_CYCLE = numerics(8, "values a cycle", why="low-passed neighbours say the same")
_STEP = numerics(1e-4, "natural logarithm", why="of amplitude and speed, for the slopes of functions")


@dataclass(frozen=True, eq=False)
class MassFit:
    """1/m from several stretches, and how it follows from the equation's error at each sample of each.

    Attributes:
        inverse: 1/kg; 0 where there is no force, and the mass is not asked for.
        std: its standard error.
        of_force: what of that the noise of the force does, which grows with 1/m.
        rows: of each stretch (n,), complex: 1/m changes by the real part of their sum with the error.
    """

    inverse: float = 0.0
    std: float = 0.0
    of_force: float = 0.0
    rows: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True, eq=False)
class Slopes:
    """How functions change with the logarithm of the amplitude and of the speed, by sample."""

    springs: np.ndarray  # (p, n), with the amplitude
    dampers: np.ndarray  # (q, n), with the amplitude at one speed
    with_speed: np.ndarray  # (q, n), with the speed at one amplitude


def agreed(singles: Sequence[MassFit]) -> MassFit:
    """The mass of several stretches from that of each, weighted by what it says.

    A stretch whose 1/m is too large states too large an error: they are weighted by the errors at their common one.
    """
    each, std, of_force = np.array([(single.inverse, single.std, single.of_force) for single in singles]).T
    inverse = float(np.median(each))
    variance, share = std**2, np.ones(each.size) / each.size
    for _ in range(_ROUNDS):
        variance = std**2 + of_force**2 * ((inverse / each) ** 2 - 1)
        share = 1 / variance / np.sum(1 / variance)
        inverse = float(share @ each)
    rows = tuple(w * single.rows[0] for w, single in zip(share, singles, strict=True))
    return MassFit(inverse, float(1 / np.sqrt(np.sum(1 / variance))), rows=rows)


def mass_fit(stretch: Stretch, smoothed: float = 0.0, further: np.ndarray | float = 0.0) -> MassFit:
    """The mass of one driven stretch; `smoothed` and `further` as ``regressed`` has them.

    Raises:
        BadInput: too little motion above the noise; no positive mass, where force and response do not belong together.
    """
    first, clear = stretch.signal.equation_first, moving(stretch)
    level = float(np.max(stretch.amplitude[stretch.keep][clear]))
    top = float(np.max((np.abs(first) * stretch.amplitude)[stretch.keep][clear]))
    low = 1e-4  # where it is not clear it does not count, and must only stay a number
    a = np.maximum(stretch.amplitude / level, low)
    speed = np.maximum(np.abs(first) * stretch.amplitude / top, low)
    springs, dampers = backbone_basis(a), damping_basis(a, speed)
    more, less = 1 + _STEP, 1 - _STEP
    slopes = Slopes(
        (backbone_basis(more * a) - backbone_basis(less * a)) / (2 * _STEP),
        (damping_basis(more * a, speed) - damping_basis(less * a, speed)) / (2 * _STEP),
        (damping_basis(a, more * speed) - damping_basis(a, less * speed)) / (2 * _STEP),
    )
    return regressed(stretch, springs, dampers, further, smoothed, None if smoothed else slopes)[0]


def moving(stretch: Stretch) -> np.ndarray:
    """Where, of ``keep``, a driven stretch stands clear of its noise, (k,) of bool.

    Raises:
        BadInput: nowhere for long enough, or nothing drives it.
    """
    if stretch.ratio is None or np.count_nonzero(stretch.clear) < LEAST_PAIRS:
        raise BadInput(
            "The forced record has too little motion above its noise for FORCEVIB; force it harder or longer."
        )
    return stretch.clear


def regressed(
    stretch: Stretch,
    springs: np.ndarray,
    dampers: np.ndarray,
    further: np.ndarray | float = 0.0,
    smoothed: float = 0.0,
    slopes: Slopes | None = None,
) -> tuple[MassFit, np.ndarray]:
    """1/m and the factors (p + q,) of functions that omega0² and 2 h0 are made of, by least squares of the equation.

    Args:
        stretch: driven.
        springs: functions of omega0², (p, n).
        dampers: of 2 h0, (q, n).
        further: what else of the force over the mass is known, over X, (n,), complex, 1/s².
        smoothed: part of the stretch over which the columns are smoothed in the normal equations (instrumental
            variables): F/X and the amplitude share the noise of what they are compared with, and where the mass can
            hardly be distinguished from the functions that bends it by more than its error.
        slopes: of the functions, where the columns are not smoothed: what noise they share is taken off.

    Raises:
        BadInput: no positive mass, where force and response do not belong together.
    """
    s, ratio, clear = stretch.signal, stretch.ratio, stretch.clear
    first = s.equation_first
    assert ratio is not None  # `moving` is asked before
    columns = stretch.low_pass(np.concatenate([-ratio[None], stretch.passed(springs), stretch.passed(dampers, first)]))
    target = stretch.low_pass(s.equation_second + further)
    points = np.arange(0, clear.size, max(1, int(s.period / _A_CYCLE)))
    columns, target, clear = columns[:, points], target[points], clear[points]
    count, last = len(springs), max(1, int(np.count_nonzero(clear)))
    leant = _smooth(columns, clear, smoothed) if smoothed else columns
    squared, damping, inverse = s.omega**2, np.zeros(s.omega.size), 0.0
    value, gain, misfit = np.zeros(len(columns)), np.zeros((1, 1)), 1.0
    for k in range(_ROUNDS if slopes is None else _ROUNDS_WITH_NOISE):
        weight = np.where(clear, 1 / stretch.point_variance(squared, damping, inverse)[points], 0.0)
        scale = 1 / np.sqrt(np.sum(np.abs(columns) ** 2 * weight, axis=1))
        scaled, asked = columns * scale[:, None], leant.conj() * scale[:, None] * weight
        normal = np.real(asked @ scaled.T)
        added, again = np.zeros(len(columns)), np.zeros((len(columns),) * 2)
        if slopes is not None and k:
            shared, of_force = _shared(stretch, columns, dampers, slopes, (squared, damping, inverse), points)
            again[0, 0] = scale[0] ** 2 * float(of_force @ weight)  # large where the force is noisy: solved for
            added = scale * np.real(shared @ weight)
        back = np.linalg.pinv(normal - again, rcond=1e-13, hermitian=not smoothed)
        gain = -scale[:, None] * (back @ asked)
        value = np.real(gain @ target) + scale * (back @ added)
        left = target + value @ columns
        misfit = float(np.sum(weight * np.abs(left) ** 2)) / (2 * last)
        inverse, squared = float(value[0]), value[1 : 1 + count] @ springs
        damping = 0.5 * value[1 + count :] @ dampers
    if not inverse > 0:
        raise BadInput("FORCEVIB finds no positive mass: check the signs and units of force and response.")
    shares = np.zeros(stretch.clear.size, complex)
    shares[points] = gain[0]
    row = stretch.before_low_pass(shares)
    moved, drive = stretch.noise_weights(row[None], np.zeros((1, row.size)), squared, damping, inverse)
    of_force = stretch.force_noise**2 * float(np.sum(drive**2)) * max(1.0, misfit)
    variance = stretch.noise**2 * float(np.sum(moved**2)) * max(1.0, misfit) + of_force
    return MassFit(inverse, float(np.sqrt(variance)), float(np.sqrt(of_force)), (row,)), value[1:]


def _shared(
    stretch: Stretch,
    columns: np.ndarray,
    dampers: np.ndarray,
    slopes: Slopes,
    found: tuple[np.ndarray, np.ndarray, float],
    points: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Mean of each column's noise, conjugate, times the equation's error, (p, q), and what of it goes with 1/m."""
    squared, damping, inverse = found
    place, speed, drive, weight = stretch.shared_noise(squared, damping, inverse)[:, points]
    at = stretch.keep.start + points
    first = stretch.signal.equation_first[at].conj()
    with_speed = slopes.with_speed[:, at]
    rows = np.concatenate(
        [
            (-columns[0].conj() * place)[None],
            0.5 * slopes.springs[:, at] * place,
            0.5 * (slopes.dampers[:, at] + with_speed) * first * place + (dampers[:, at] + 0.5 * with_speed) * speed,
        ]
    )
    return rows + columns.conj() * weight, -np.real(drive) / (inverse or 1.0)


def _smooth(columns: np.ndarray, clear: np.ndarray, part: float) -> np.ndarray:
    """Columns (p, q) under Hann's window, half as wide as this part of the points, of those that are clear."""
    kernel = np.hanning(2 * max(1, round(part * np.count_nonzero(clear))) + 1)
    rows = np.concatenate([np.where(clear, columns, 0.0), clear[None].astype(complex)])
    smooth = convolved(rows, kernel)
    return smooth[:-1] / np.maximum(np.real(smooth[-1]), 1.0)

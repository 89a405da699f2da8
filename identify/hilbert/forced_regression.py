"""Mass, backbone and damping curve of a forced record by one regression over windows: for the start of the search.

The equation is FORCEVIB's (Feldman 1994), for the analytic signals of response and force

    X'' + 2 h0(A) X' + omega0^2(A) X = F_a / m,

but nothing is instantaneous: 1/m and the two curves, each a sum of functions of the envelope, come out of one linear
regression over the whole record, and products with windows (`weakform`) stand for the derivatives. FORCEVIB itself is
in `forcevib`.
The functions: powers of A, and the part of a preload in the backbone, 4 preload / (pi A), and of dry friction in the
damping, 4 dry / (pi V) with V the envelope of the velocity. Only the fundamental counts, because a harmonic of the
response obeys another equation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ...model.limits import LEAST, MOST
from ..signals.hilbert import LONG, analytic_signal
from ..signals.limits import (
    BELOW_NYQUIST,
    CLEAR_OF_NOISE,
    RESTING,
    ROUNDING,
    SHORTEST_PERIOD,
    WEIGHING_ROUNDS,
    WINDOW_CYCLES,
)
from ..signals.registry import budget, numerics, shown
from ..signals.signals import Signal, resting, thinned
from ..signals.weakform import Solution, solve, windows
from .limits import CURVE_LEAST, LOUD_PART, NEAR_FUNDAMENTAL

_WINDOWS = numerics(3, "windows", why="a short record is cut in so many")
_STILL = numerics(1e-4, "part of the largest", why="slower or smaller motion has no phase to divide by")
_WORTH = budget(8, "times what lies beside", why="a shorter part would be made of its edges")

_AT_ONCE = budget(2**16, "samples", why="whose envelope is made at once")
_BESIDE = numerics(40.0, "cycles", why="beside them: the transform has forgotten what is farther")
OVERLAP = numerics(4, "windows", why="over each sample; errors count as many")
CURVE_POINTS = shown(60, "points", why="of a curve")
_SAMPLES_A_CYCLE = numerics(12.0, "samples a cycle", why="of the highest frequency of a long record")


@dataclass(frozen=True)
class ForcedRegression:
    """Mass and curves of one forced record; the curves have shape (n,), amplitudes ascending."""

    mass: float
    mass_std: float
    amplitude: np.ndarray  # envelope, unit of the recording
    omega0: np.ndarray  # backbone, rad/s
    damping: np.ndarray  # h0(A) at omega0(A), 1/s; viscous / 2 of a linear system
    omega0_std: np.ndarray  # rad/s
    damping_std: np.ndarray  # 1/s
    per_point: float  # independent values per point of the curves
    misfit: float  # weighted mean square of the residual; 1 when noise explains it


def forced_regression(displacement: Signal, drive: Signal) -> ForcedRegression:
    """Regress mass and curves on a displacement and the force that drives it, sampled alike.

    Raises BadInput when the force is constant, the record has fewer than ten cycles above its noise, or no positive
    mass comes out (then force and response do not belong together, or their signs or units differ).
    """
    if np.ptp(drive.samples) == 0:
        raise BadInput("The regression needs a force; this record has none: treat it as a free decay.")
    factor = _more_than_enough(displacement, drive)
    recorded, velocity = displacement.fs, None
    if factor > 1:
        velocity = thinned(np.gradient(displacement.samples, 1 / recorded, edge_order=2), factor)
        displacement, drive = displacement.thinned(factor), drive.thinned(factor)
    x, force, fs = displacement.samples, drive.samples, displacement.fs
    amplitude, growth, rate = _envelope(x, fs, displacement.frequency)
    sigma = max(displacement.noise, ROUNDING * float(np.std(x)))
    f = float(np.median(np.abs(rate[amplitude > LOUD_PART * np.max(amplitude)]))) / (2 * np.pi)
    period = max(SHORTEST_PERIOD, round(fs / max(f, fs / x.size)))
    low, high = drive.band
    length = min(WINDOW_CYCLES, x.size / period / _WINDOWS) * period / fs
    view = windows(
        x.size, fs, length, min(low, f) - 1 / length, min(max(high, f) + 1 / length, BELOW_NYQUIST * fs), OVERLAP
    )

    level = float(np.quantile(amplitude, 0.995))
    amplitude = np.maximum(amplitude, _STILL * level)
    mean_omega = view.mean(rate * amplitude**2) / view.mean(amplitude**2)
    speed = np.hypot(growth, rate) * amplitude
    del growth, rate
    top_speed = float(np.quantile(speed, 0.995))
    speed = np.maximum(speed, _STILL * top_speed)
    correction = _gradient_gain(view.omega, recorded)  # what the central difference does to each bin

    backbone = [view.project(b * x) for b in _backbone(amplitude / level)]
    velocity = np.gradient(x, 1 / fs, edge_order=2) if velocity is None else velocity
    damping = [view.project(d * velocity) / correction for d in _damping(amplitude / level, speed / top_speed)]
    del velocity, speed
    columns = np.stack([view.project(force), *backbone, *damping], axis=-1)
    acceleration = view.project(x, 2)

    # the fundamental only, where it stands clear of the noise
    noise = sigma * np.sqrt(view.energy / fs)
    near = np.abs(view.omega - mean_omega[:, None]) < np.maximum(
        NEAR_FUNDAMENTAL * np.abs(mean_omega[:, None]), view.width
    )
    moving = view.mean((resting(x, sigma, period) | (amplitude < CLEAR_OF_NOISE * sigma)).astype(float)) < RESTING
    clear = near & moving[:, None] & (np.abs(columns[..., 1]) > CLEAR_OF_NOISE * noise)
    count, needed = np.count_nonzero(clear), CURVE_LEAST * columns.shape[-1]
    if count < needed:
        raise BadInput(
            f"Of the forced record {count} spectral lines about the frequency of its motion stand clear of the noise, "
            f"where a regression by amplitude needs {needed}; record longer, or force it harder."
        )
    omega = np.broadcast_to(view.omega, clear.shape)[clear]
    force_noise = max(drive.noise, ROUNDING * float(np.std(force))) * np.sqrt(view.energy / fs)
    target, columns = -acceleration[clear], columns[clear]
    stiffness, viscous, inverse_mass = float(np.median(omega)) ** 2, 0.0, 0.0
    result = Solution(np.zeros(columns.shape[1]), np.zeros((columns.shape[1],) * 2), 0.0)
    for _ in range(WEIGHING_ROUNDS):
        response = (stiffness - omega**2) ** 2 + (viscous * omega) ** 2 + (2 * omega * view.width) ** 2
        std = np.sqrt(noise**2 * response + (inverse_mass * force_noise) ** 2)
        result = solve(columns, target, std, 1.0 / OVERLAP)
        inverse_mass = -float(result.value[0])
        half = np.array([0.5])
        stiffness = float((backbone_basis(half).T @ result.value[1 : 1 + len(backbone)])[0])
        viscous = float((damping_basis(half, half).T @ result.value[1 + len(backbone) :])[0])
    if not LEAST <= inverse_mass <= MOST:
        raise BadInput("The regression finds no positive mass: check the signs and units of force and response.")

    # the curves, where the windows that were used have been
    seen = np.zeros(x.size, bool)
    for start in view.starts[clear.any(axis=1)]:
        seen[start + view.length // 4 : start + 3 * view.length // 4] = True
    smallest, largest = (float(q) for q in np.quantile(amplitude[seen], (0.005, 0.995)))
    grid = np.linspace(smallest, largest, CURVE_POINTS)
    rows = backbone_basis(grid / level).T
    k = slice(1, 1 + len(backbone))
    squared = rows @ result.value[k]
    good = squared > 0
    if not np.any(good):
        raise BadInput("The regression finds no positive stiffness: check that force and response belong together.")
    grid, rows, squared = grid[good], rows[good], squared[good]
    omega0 = np.sqrt(squared)
    squared_std = _errors(rows, result.covariance[k, k])
    d = slice(1 + len(backbone), None)
    rows = damping_basis(grid / level, omega0 * grid / top_speed).T
    return ForcedRegression(
        mass=1 / inverse_mass,
        mass_std=float(np.sqrt(result.covariance[0, 0])) / inverse_mass**2,
        amplitude=grid,
        omega0=omega0,
        damping=rows @ result.value[d] / 2,
        omega0_std=squared_std / (2 * omega0),
        damping_std=_errors(rows, result.covariance[d, d]) / 2,
        per_point=len(backbone) / grid.size,
        misfit=result.residual,
    )


def _errors(rows: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """(n,) standard errors along rows (n, k); infinite where rounding has left nothing of a variance."""
    variance = np.einsum("ij,jk,ik->i", rows, covariance, rows)
    return np.where(variance > 0.0, np.sqrt(np.maximum(variance, 0.0)), np.inf)


def _more_than_enough(displacement: Signal, drive: Signal) -> int:
    """How many times more samples a long record has than the regression needs."""
    if displacement.n < LONG:
        return 1
    return max(1, int(displacement.fs / (_SAMPLES_A_CYCLE * max(drive.band[1], displacement.frequency))))


def backbone_basis(a: np.ndarray) -> np.ndarray:
    """Functions of the relative amplitude that omega0^2(A) is made of, shape (8, n): a cubic spline and 1/A."""
    return np.stack(list(_backbone(a)))


def damping_basis(a: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Functions of relative amplitude and relative speed that 2 h0 is made of, shape (6, n)."""
    return np.stack(list(_damping(a, speed)))


def _backbone(a: np.ndarray) -> Iterator[np.ndarray]:
    yield from (np.ones_like(a), 1 / a, a, a**2)
    yield from (np.clip(a - knot, 0, None) ** 3 for knot in (0.2, 0.4, 0.6, 0.8))


def _damping(a: np.ndarray, speed: np.ndarray) -> Iterator[np.ndarray]:
    yield from (np.ones_like(a), 1 / speed, a, a**2)
    yield from (np.clip(a - knot, 0, None) ** 2 for knot in (0.33, 0.67))


def _envelope(x: np.ndarray, fs: float, frequency: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Amplitude, growth and rate of the phase, (n,) each, of a driven motion: see ``AnalyticSignal``.

    Of a long one in parts, each with cycles beside it to either side, beyond which no kernel reaches.
    """
    beside = int(np.ceil(_BESIDE * fs / frequency))
    part = max(_AT_ONCE, _WORTH * beside)
    made = np.empty((3, x.size))
    for begin in range(0, x.size, part) if x.size > 2 * part else (0,):
        end = begin + part if x.size > 2 * part else x.size
        first = max(0, begin - beside)
        signal = analytic_signal(x[first : end + beside], fs, undecay=0.0, frequency=frequency)
        own = slice(begin - first, begin - first + min(end, x.size) - begin)
        made[:, begin:end] = signal.amplitude[own], signal.growth[own], signal.omega[own]
    return made[0], made[1], made[2]


def _gradient_gain(omega: np.ndarray, fs: float) -> np.ndarray:
    """A central difference returns the derivative of exp(i omega t) times this."""
    return np.sinc(omega / (np.pi * fs))

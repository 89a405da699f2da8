"""Start values of Eq. 17 by one linear regression over windows of all recordings, free, forced, narrow or broad band.

    x'' + viscous x' + dry sgn x' + omega0^2 x + cubic x^3 + preload sgn x = F / m    (Eq. 17, per unit mass)

is linear in (1/m, viscous, omega0^2, cubic, preload, dry). Multiplied by oscillating windows (`weakform`) it needs no
derivative of the data, so that it also serves where there is no single amplitude to speak of (multisine, noise) and
at ten samples a cycle, where FORCEVIB has nothing to hold on to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ...recording.smoothing import with_polynomials
from ..signals.limits import BELOW_NYQUIST, CLEAR_OF_NOISE, RESTING, ROUNDING, WEIGHING_ROUNDS, WINDOW_CYCLES
from ..signals.registry import budget, numerics
from ..signals.signals import Signal, resting
from ..signals.weakform import solve, windows

_WINDOWS = numerics(4, "windows", why="a short record is cut in so many")
_DENSE = numerics(40, "samples a cycle", why="of the highest frequency: the instants of sign changes are met")
_DENSEST = budget(8, "times the samples", why="more would only take memory")

OVERLAP = numerics(4, "windows", why="over each sample; errors count as many")
COLUMNS = ("inverse_mass", "viscous", "stiffness", "cubic", "preload", "dry")
OPTIONAL = ("cubic", "preload", "dry")


@dataclass(frozen=True)
class Segment:
    """A stretch of displacement and of the force on it, None or zero where it rings freely."""

    displacement: Signal
    force: Signal | None


@dataclass(frozen=True)
class Rows:
    """Windows of one segment: x'' products (r,), those of the columns of `COLUMNS` (r, 6), what is needed to weigh."""

    acceleration: np.ndarray
    columns: np.ndarray
    omega: np.ndarray  # (r,), rad/s
    width: float  # rad/s, of the windows' band
    noise: float  # standard deviation of a product of x with a window
    force_noise: float


@dataclass(frozen=True)
class RegressionStart:
    """Parameters of Eq. 17 by regression, each with a standard deviation; mass None without force."""

    mass: float | None
    mass_std: float
    omega0: float
    omega0_std: float
    cubic: float
    cubic_std: float
    preload: float
    preload_std: float
    viscous: float
    viscous_std: float
    dry: float
    dry_std: float
    misfit: float  # weighted mean square of the residual; 1 when noise explains it


def linear_regression_start(displacement: Signal, force: Signal | None) -> RegressionStart:
    """Regress Eq. 17 on one recording: its displacement, and the force or None, sampled alike.

    Raises BadInput when there is no oscillation or no stiffness comes out positive.
    """
    return regress([Segment(displacement, force)])


def regress(segments: Sequence[Segment]) -> RegressionStart:
    """One regression over all `segments`. Raises BadInput as above."""
    return regress_rows([segment_rows(s) for s in segments])


def regress_rows(rows: Sequence[Rows], *, linear: bool = False) -> RegressionStart:
    """One regression over the rows of all segments, each weighed by its segment's noise. Raises BadInput as above.

    With ``linear`` mass, stiffness and viscous damping alone are regressed: another effect bends these least.
    """
    forced = any(r.force_noise > 0 for r in rows)
    use = [i for i in range(len(COLUMNS)) if (forced or i > 0) and not (linear and COLUMNS[i] in OPTIONAL)]
    columns = np.concatenate([r.columns for r in rows])
    target = -np.concatenate([r.acceleration for r in rows])
    if target.size < 2 * len(use):
        raise BadInput("The recordings are too short to regress the equation of motion on; record at least 10 cycles.")
    stiffness: float | None = None
    viscous, inverse_mass = 0.0, 0.0
    std = np.full(len(COLUMNS), np.inf)
    round_ = 0
    while True:  # the weights need the parameters: start from the frequency of each row, then repeat
        row_std = np.concatenate([_row_std(r, stiffness, viscous, inverse_mass) for r in rows])
        solution = solve(columns[:, use], target, row_std, independent=1.0 / OVERLAP)
        full = np.zeros(len(COLUMNS))
        full[use] = solution.value
        inverse_mass, viscous, stiffness = -float(full[0]), float(full[1]), float(full[2])
        round_ += 1
        if round_ < WEIGHING_ROUNDS:
            continue
        # what the recordings do not carry is 0, with the uncertainty it had while it was in; worst first
        std[use] = np.sqrt(np.diag(solution.covariance))
        weak = [(abs(full[i]) / std[i], i) for i in use if COLUMNS[i] in OPTIONAL]
        if not weak or min(weak)[0] >= 2:
            break
        use.remove(min(weak)[1])
    if forced and -(float(np.min(np.concatenate([r.omega for r in rows]))) ** 2) < stiffness <= 0:
        stiffness = (min(r.width for r in rows) / 10.0) ** 2  # a slide: a spring so soft that nothing shows it
    if not stiffness > 0:
        raise BadInput("The regression finds no positive stiffness: this is not the motion of one oscillator.")
    mass = 1 / inverse_mass if forced and inverse_mass > 0 else None
    omega0 = float(np.sqrt(stiffness))
    return RegressionStart(
        mass=mass,
        mass_std=float(std[0] * mass**2) if mass is not None else float("inf"),
        omega0=omega0,
        omega0_std=float(std[2] / (2 * omega0)),
        cubic=float(full[3]),
        cubic_std=float(std[3]),
        preload=float(full[4]),
        preload_std=float(std[4]),
        viscous=float(full[1]),
        viscous_std=float(std[1]),
        dry=float(full[5]),
        dry_std=float(std[5]),
        misfit=solution.residual,
    )


def segment_rows(segment: Segment) -> Rows:
    """Products of one segment with its windows, in the band where it moves; rows lost in noise are left out."""
    x, fs, drive = segment.displacement.samples, segment.displacement.fs, segment.force
    if drive is not None and np.ptp(drive.samples) == 0:
        drive = None  # a constant is the sensor's offset
    force = None if drive is None else drive.samples
    f = segment.displacement.frequency
    cycles = x.size * f / fs
    least = 4 if force is None else 2  # a force moves the mass at more than its largest line
    if cycles < least:
        raise BadInput(f"The recording has {cycles:.1f} cycles; the regression needs at least {least}.")
    if drive is None:
        low, high, length = 0.7 * f, 1.3 * f, min(WINDOW_CYCLES / 2, cycles / 2) / f
    else:
        low, high = drive.band
        length = min(WINDOW_CYCLES, cycles / _WINDOWS) / f
        low, high = min(low, f) - 1 / length, min(max(high, f) + 1 / length, BELOW_NYQUIST * fs)
    view = windows(x.size, fs, length, low, high, OVERLAP)
    # an offset of the sensor would shift the sign changes; a window has no transmission at whole multiples of its bins
    x = x - np.median(view.mean(x))
    factor = int(np.clip(np.ceil(_DENSE * high / fs), 1, _DENSEST))
    dense, speed = smooth_motion(x, fs, high, factor)
    fine = view.upsampled(factor)
    dt = 1 / (fs * factor)
    x0 = view.project(x)
    columns = np.stack(
        [
            view.project(force) if force is not None else np.zeros_like(x0),
            view.project(x, 1),
            x0,
            fine.project(dense**3),
            fine.project(_sign(dense, speed, dt)),
            fine.project(_sign(speed, np.gradient(speed, dt), dt)),
        ],
        axis=-1,
    )
    sigma = max(segment.displacement.noise, ROUNDING * float(np.std(x)))
    noise = sigma * np.sqrt(view.energy / fs)
    force_noise = 0.0
    if drive is not None:
        force_noise = max(drive.noise, ROUNDING * float(np.std(drive.samples))) * np.sqrt(view.energy / fs)
    acceleration = view.project(x, 2)
    omega = np.broadcast_to(view.omega, x0.shape)
    moving = view.mean(resting(x, sigma, round(fs / f)).astype(float)) < RESTING
    clear = (np.abs(x0) > CLEAR_OF_NOISE * noise) & moving[:, None]
    return Rows(acceleration[clear], columns[clear], omega[clear], view.width, float(noise), float(force_noise))


def smooth_motion(x: np.ndarray, fs: float, high: float, factor: int) -> tuple[np.ndarray, np.ndarray]:
    """`x` (n,) and its velocity on a grid `factor` times as dense, noise above a few times `high` Hz smoothed away."""
    from scipy.interpolate import make_interp_spline

    order = 4
    span = int(fs / (6 * high)) | 1  # a sixth of a cycle: a quartic follows three harmonics of it
    velocity = None
    if span > order + 1:
        velocity = with_polynomials(x, span, order, 1) * fs
        x = with_polynomials(x, span, order)
    if factor == 1 and velocity is not None:
        return x, velocity
    spline = make_interp_spline(np.arange(x.size), x, k=5)
    place = np.arange(x.size * factor) / factor
    place = np.minimum(place, x.size - 1)
    return spline(place), spline(place, 1) * fs


def _sign(y: np.ndarray, slope: np.ndarray, dt: float) -> np.ndarray:
    """Mean of sgn over each sample's interval, so that the instant of a sign change counts, not the sample it meets."""
    reach = np.abs(slope) * dt / 2
    return np.clip(y / np.where(reach > 0, reach, 1e-300), -1, 1)


def _row_std(rows: Rows, stiffness: float | None, viscous: float, inverse_mass: float) -> np.ndarray:
    """Standard deviation of the equation error of each row: what the noise of x and F leaves in it."""
    w = rows.omega
    k = w**2 if stiffness is None or stiffness <= 0 else stiffness
    response = (k - w**2) ** 2 + (viscous * w) ** 2 + (2 * w * rows.width) ** 2
    return np.sqrt(rows.noise**2 * response + (inverse_mass * rows.force_noise) ** 2)

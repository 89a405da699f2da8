"""A linear oscillator fitted with nothing of the product: the least that any answer has to beat.

    y'' + 2 h y' + omega0² y = gain F + constant

is solved exactly for a force in straight lines between samples. Frequency and damping are searched by nonlinear least
squares over a stretch that grows from few cycles to all; gain, initial state and an offset of the sensor follow from
linear least squares at each step (variable projection, Golub and Pereyra 1973).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

#: Samples a cycle below which straight lines are too coarse for the force, and it is first resampled.
_FINE = 30.0
#: Cycles of the first stretch, and starts there: of the frequency in that of the strongest line, of the damping ratio.
_FIRST_CYCLES = 6.0
_FREQUENCIES = (1.0, 0.5, 1.4)
_DAMPING = (0.003, 0.03, 0.3)
#: Frequencies in that of the strongest line at which a forced recording is tried as a whole.
_GRID = np.geomspace(0.1, 10.0, 41)
#: Of these starts so many go on to the whole recording; evaluations of one search.
_KEPT = 2
_SEARCH = 30


@dataclass(frozen=True)
class PlainFit:
    """A linear oscillator: rad/s, 1/s, gain (1/mass; None in free decay), and what it leaves.

    `nrmse` is rms(simulated - measured) / std(measured) over the stretch that was fitted, `simulated` (n,) its run.
    """

    omega0: float
    h: float
    gain: float | None
    nrmse: float
    simulated: np.ndarray


def fit(dt: float, response: np.ndarray, force: np.ndarray | None, quantity: str = "displacement") -> PlainFit:
    """Fit a linear oscillator to one recording.

    Args:
        dt: s between samples.
        response: (n,) measured.
        force: (n,), None in free decay.
        quantity: displacement, velocity or acceleration.
    """
    from scipy.optimize import least_squares

    measured = response / np.std(response)
    n = measured.size
    omega = _peak(measured, dt)
    fine, steps = _finer(force, 2 * np.pi / (omega * dt))

    def remainder(theta: np.ndarray, upto: int) -> np.ndarray:
        return _project(_columns(theta, dt, upto, fine, steps, quantity), measured[:upto])[1]

    lengths = [min(n, int(np.ceil(2 * np.pi * _FIRST_CYCLES / (omega * dt))))]
    while lengths[-1] < n:
        lengths.append(min(n, 3 * lengths[-1]))
    # beyond these the recording holds no cycle, or the oscillator does not move between two samples
    low, high = np.log([0.01 / (n * dt), 1e-4 / (n * dt)]), np.log([np.pi / dt, 30 * np.pi / dt])

    def search(theta: np.ndarray, upto: int) -> Any:
        inside = np.clip(theta, low + 1e-9, high - 1e-9)
        return least_squares(remainder, inside, bounds=(low, high), args=(upto,), max_nfev=_SEARCH)

    starts = [np.log([k * omega, k * damping * omega]) for k in _FREQUENCIES for damping in _DAMPING]
    tried = sorted((search(start, lengths[0]) for start in starts), key=lambda fit: fit.cost)
    kept = [fit.x for fit in tried[:_KEPT]] + [starts[0]]
    for upto in lengths[1:]:
        kept = [search(theta, upto).x for theta in kept]
    if force is not None:  # a drive that begins far from the resonance tells nothing of it in its first cycles
        grid = [np.log([k * omega, zeta * k * omega]) for k in _GRID for zeta in _DAMPING]
        kept += sorted(grid, key=lambda theta: float(np.sum(remainder(theta, n) ** 2)))[:_KEPT]
    best = min((search(theta, n) for theta in kept), key=lambda fit: fit.cost)
    columns = _columns(best.x, dt, n, fine, steps, quantity)
    weights, residual = _project(columns, measured)
    omega0, h = np.exp(best.x)
    gain = None if force is None else float(weights[-1] * np.std(response))
    return PlainFit(
        float(omega0), float(h), gain, float(np.sqrt(np.mean(residual**2))), response + np.std(response) * residual
    )


def held_out(
    plain: PlainFit, dt: float, response: np.ndarray, force: np.ndarray, quantity: str = "displacement"
) -> np.ndarray:
    """(n,) run of a fitted oscillator along another forced recording; initial state and offset are that recording's."""
    fine, steps = _finer(force, 2 * np.pi / (plain.omega0 * dt))
    columns = _columns(np.log([plain.omega0, plain.h]), dt, response.size, fine, steps, quantity)
    forced = (plain.gain or 0.0) * columns[:, -1]
    return response + _project(columns[:, :-1], response - forced)[1]


def _peak(measured: np.ndarray, dt: float) -> float:
    """rad/s of the strongest line, by a windowed Fourier transform."""
    moved = (measured - measured.mean()) * np.hanning(measured.size)
    n = 4 * measured.size
    line = 1 + int(np.argmax(np.abs(np.fft.rfft(moved, n))[1:]))
    return 2 * np.pi * line / (n * dt)


def _finer(force: np.ndarray | None, samples_a_cycle: float) -> tuple[np.ndarray | None, int]:
    """The force with so many samples more that straight lines between them do."""
    from scipy.signal import resample_poly

    steps = max(1, int(np.ceil(_FINE / samples_a_cycle)))
    if force is None or steps == 1:
        return force, 1
    return resample_poly(force, steps, 1, padtype="line"), steps


def _columns(theta: np.ndarray, dt: float, n: int, force: np.ndarray | None, steps: int, quantity: str) -> np.ndarray:
    """(n, 3 or 4): two free motions, an offset, and the forced motion from rest under a gain of one."""
    from scipy.linalg import expm
    from scipy.signal import cont2discrete, lfilter, ss2tf

    omega0, h = np.exp(theta)
    system = np.array([[0.0, 1.0], [-(omega0**2), -2 * h]])
    step = expm(system * dt)
    poles = np.array([1.0, -np.trace(step), np.exp(-2 * h * dt)])
    impulse = np.zeros(n)
    impulse[0] = 1.0
    free = [lfilter(first, poles, impulse) for first in ([1.0, -step[1, 1]], [0.0, step[0, 1]])]
    columns = [free[0], free[1] / max(float(np.max(np.abs(free[1]))), 1e-300), np.ones(n)]
    if force is not None:
        seen = {"displacement": [1.0, 0.0], "velocity": [0.0, 1.0], "acceleration": system[1]}[quantity]
        through = 1.0 if quantity == "acceleration" else 0.0
        continuous = (system, np.array([[0.0], [1.0]]), np.array([seen]), np.array([[through]]))
        discrete = cont2discrete(continuous, dt / steps, "foh")
        zeros, own = ss2tf(*discrete[:4])
        columns.append(lfilter(zeros[0], own, force[: n * steps])[::steps][:n])
    return np.column_stack(columns)


def _project(columns: np.ndarray, measured: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Weights of the columns by least squares, and (n,) what they make less what was measured."""
    size = np.maximum(np.max(np.abs(columns), axis=0), 1e-300)
    weights = np.linalg.lstsq(columns / size, measured, rcond=1e-10)[0]
    return weights / size, (columns / size) @ weights - measured

"""What the modes of one linear rig explain of a recording, with its noise and the periods that it may have."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..signals.registry import budget, numerics
from ..signals.signals import Signal
from .decay import Decay
from .limits import BEYOND, TAKES
from .rig_pieces import RigPieces, rig_pieces
from .shared_modes import SharedModes, shared_modes

_PARTS = numerics(16, "parts of a cycle", why="over which a motion is about straight")
_LINES = budget(2, "lines", why="of the motion and of its derivative, that a rig's own frequency is sought among")
_WEAK = budget(0.1, "part of the largest amplitude", why="a weaker line is not where the rig moves most")
_APART = budget(0.2, "of the logarithm", why="nearer periods show the same windows")
_FEW = budget((1.0, 2.0, 4.0), "cycles a record", why="where no line of a spectrum tells them")
_LEAST_SAMPLES = numerics(4, "samples", why="of a part that a damped sine and a constant are fitted to")
_LEAST = numerics(4.0, "samples a cycle", why="of the fourth differences fewer leave little but the noise")


def modes_of_response(
    response: Signal,
    free: Sequence[tuple[int, int]] | None = None,
    settled: Callable[[float, int], bool] | None = None,
    periods: Sequence[float] | None = None,
) -> SharedModes | None:
    """The pieces of a response that the modes of one linear rig explain; None where there are none.

    Args:
        response: of the rig.
        free: start and stop of each piece, in samples, where they are known.
        settled: see ``shared_modes``.
        periods: samples a cycle that it may have, where they are known.
    """
    x = response.samples
    if not np.ptp(x) > 0:
        return None
    return shared_modes(x, response.fs, still_noise(response), periods or periods_of(x), free, settled)


def all_that_moves(response: Signal, decays: Sequence[Decay]) -> bool:
    """Whether decays hold nearly all that a response moves, in squares, its noise aside: there is nothing else."""
    means, noise, block = _means(response, min(periods_of(response.samples), default=float(response.n)))
    steps = np.diff(means) ** 2 - 2 * noise**2
    return bool(np.sum(steps[_inside(decays, steps.size, block)]) >= TAKES * np.sum(steps) > 0.0)


def moving_in(response: Signal, decays: Sequence[Decay], omega: float) -> np.ndarray:
    """(n,) in which parts of a cycle of such a frequency (rad/s) the response moves, within decays.

    What rests or is held behind a motion is no part of it, however long it is, nor is a sensor's drift there.
    """
    means, noise, block = _means(response, 2 * np.pi / omega * response.fs)
    curvature = np.array([1.0, -2.0, 1.0])
    bent = np.abs(np.convolve(means, curvature, "valid")) > BEYOND * np.linalg.norm(curvature) * noise
    moves = np.convolve(bent, curvature**2, "same") > 0  # what swings is straight where it is fastest
    return moves & _inside(decays, moves.size, block)


def off_behind(
    response: Signal, piece: tuple[int, int], omega: np.ndarray, rate: np.ndarray
) -> tuple[float, bool] | None:
    """By what part of how modes would swing on a response is off in the cycle behind a piece; None where nothing is.

    Beyond twice the noise; and whether a whole cycle was recorded. What stops a motion is soon off by as much as it
    swings; where a law is missing, it is off by little so soon behind the place where that was first seen.

    Args:
        response: of the rig.
        piece: start and stop, in samples.
        omega, rate: (K,) natural frequencies, rad/s, and rates of fall, 1/s, of its modes, the main one first.
    """
    cycle = max(int(2 * np.pi / omega[0] * response.fs), _LEAST_SAMPLES)
    start, stop = piece
    first, last = max(start, stop - omega.size * cycle), min(stop + cycle, response.samples.size)
    if last - stop < _LEAST_SAMPLES or stop - first < _LEAST_SAMPLES * omega.size:
        return None
    t = np.arange(first - stop, last - stop)[:, None] / response.fs
    turn = np.sqrt(np.maximum(omega**2 - rate**2, 0.0))
    swing = np.hstack([np.exp(-rate * t) * np.cos(turn * t), np.exp(-rate * t) * np.sin(turn * t)])
    columns, x, inside = np.column_stack([swing, np.ones(len(t))]), response.samples[first:last], stop - first
    weights = np.linalg.lstsq(columns[:inside], x[:inside])[0]
    off = np.mean((x - columns @ weights)[inside:] ** 2) - (BEYOND * response.noise) ** 2
    size = np.mean((swing @ weights[:-1])[inside:] ** 2)
    return float(np.sqrt(max(off, 0.0) / size)) if size > 0 else np.inf, last == stop + cycle


def _means(response: Signal, period: float) -> tuple[np.ndarray, float, int]:
    """Means of parts of a cycle of so many samples, their noise, and the samples of a part."""
    x, block = response.samples, max(1, int(min(period, response.n) / _PARTS))
    means = x[: x.size // block * block].reshape(-1, block).mean(axis=1)
    return means, response.noise / np.sqrt(block), block


def _inside(decays: Sequence[Decay], n: int, block: int) -> np.ndarray:
    """(n,) which differences between means are within decays."""
    inside = np.zeros(n, bool)
    for decay in decays:
        inside[decay.start // block : max(decay.stop // block - 1, 0)] = True
    return inside


def pieces_of_rig(response: Signal, quantity: str) -> RigPieces | None:
    """The pieces of a response that one rig of Eq. 17 explains; None where there are none."""
    x = response.samples
    if not np.ptp(x) > 0:
        return None
    few = [x.size / cycles for cycles in _FEW]
    shortest = min([period for period in periods_of(x) if period not in few] or few)
    return rig_pieces(x, response.fs, still_noise(response), shortest, quantity)


def still_noise(response: Signal) -> float:
    """Standard deviation of the white noise: the smaller of two bounds, for a motion with jumps leaks into a spectrum.

    The median of the fourth differences, which no jump moves, has the noise and what the motion turns within five
    samples; steps of a converter are at least what the spectrum is given.
    """
    differences = np.abs(np.diff(response.samples, 4))
    if not differences.size:
        return response.noise
    by_differences = float(np.median(differences)) / 0.6745 / np.sqrt(70.0)
    return min(response.noise, by_differences) if by_differences > 0 else response.noise


def periods_of(x: np.ndarray) -> list[float]:
    """Samples a cycle that a motion (n,) may have."""
    n = x.size
    periods = [n / few for few in _FEW if n / few >= _LEAST]
    straight = x - np.linspace(x[0], x[-1], n)
    size = 2 ** int(np.ceil(np.log2(2 * n)))
    for signal in (straight, np.diff(x)):
        power = np.abs(np.fft.rfft((signal - np.mean(signal)) * np.hanning(signal.size) ** 0.25, size)) ** 2
        power[: int(np.ceil(4.0 * size / n))] = 0.0  # the few cycles are tried anyway
        power[int(size / _LEAST) :] = 0.0
        largest = float(np.max(power))
        for _ in range(_LINES):
            k = int(np.argmax(power))
            if power[k] <= _WEAK**2 * largest:
                break
            period = size / k
            if all(abs(np.log(period / known)) > _APART for known in periods):
                periods.append(period)
            power[int(k / 1.4) : int(k * 1.4) + 1] = 0.0
    return periods

"""The free pieces of a recording without a force, in its own samples."""

from __future__ import annotations

import numpy as np

from ..signals.signals import Signal
from .damped_windows import fit_windows
from .pieces import Piece
from .segmentation import segmented
from .shared_modes import SharedModes, shared_modes

#: Lines of the spectrum, of the motion and of its derivative, that a rig's own frequency is sought among.
_LINES = 2
#: A line of less than this part of the largest amplitude is not where the rig moves most.
_WEAK = 0.1
#: Cycles that a record may hold where no line of a spectrum tells them.
_FEW = (1.0, 2.0, 4.0)
#: A motion that begins anew leaves more than this of the cycles beside its beginning to one that runs on.
_BREAKS = 0.1
#: Fewest samples a cycle; of the fourth differences leave little but the noise.
_LEAST = 4.0


def pieces_of(response: Signal) -> tuple[Piece, ...]:
    """All pieces of a response, in order of time: free, held or moved."""
    return segmented(response.samples, response.fs, still_noise(response), periods_of(response.samples))[0]


def modes_of_response(response: Signal) -> SharedModes | None:
    """The pieces of a response that the modes of one linear rig explain; None where there are none."""
    x = response.samples
    return shared_modes(x, response.fs, still_noise(response), periods_of(x)) if np.ptp(x) > 0 else None


def goes_on(response: Signal, edge: int, omega: float) -> bool:
    """Whether one motion of ``omega`` rad/s runs on across a sample: it leaves little of the cycles beside it."""
    cycle = round(2 * np.pi / omega * response.fs)
    near = response.samples[max(0, edge - cycle) : edge + cycle]
    thin = max(1, cycle // (2 * int(_LEAST) ** 2))
    means = near[: near.size // thin * thin].reshape(-1, thin).mean(axis=1)
    left = fit_windows(means[None, :], omega / response.fs * thin, slope=True).rss[0]
    return bool(left < _BREAKS**2 * np.sum((means - np.mean(means)) ** 2))


def still_noise(response: Signal) -> float:
    """Standard deviation of the white noise: the smaller of two bounds, for a motion with jumps leaks into a spectrum.

    The median of the fourth differences, which no jump moves, has the noise and what the motion turns within five
    samples; steps of a converter are at least what the spectrum is given.
    """
    differences = np.abs(np.diff(response.samples, 4))
    if differences.size < 8:
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
            if all(abs(np.log(period / known)) > 0.2 for known in periods):
                periods.append(period)
            power[int(k / 1.4) : int(k * 1.4) + 1] = 0.0
    return periods

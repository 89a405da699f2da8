"""Which modes a recording shows where its motion is free, and what share of the motion each holds.

There each mode rings at a frequency of its own and dies away. Windows of some cycles follow one another. A peak of
their spectra that is the same in several of them, beyond what noise does by chance, no multiple of the strongest one's
frequency at that time, and that falls, is a mode; a multiple is a harmonic of a nonlinear spring, which moves as the
fundamental does, and a line that does not fall is a disturbance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...errors import BadInput
from ...recording.recording import Recording
from ...recording.smoothing import harris
from ..signals.hilbert import dominant_frequency
from ..signals.limits import BELOW_NYQUIST, SEVERAL
from ..signals.odds import ABOVE_NOISE, DECISIVE
from ..signals.registry import numerics
from ..signals.signals import response_of
from .decays import find_decays, linear_modes
from .limits import FALLS, ORDERS, SAME_MODE
from .mode import Mode

_WINDOWS = numerics((16.0, 64.0), "cycles a window", why="short ones follow a frequency that moves, long ones separate")
_STEP = numerics(4, "of a window", why="by which windows follow one another")
_GLIDES = numerics(1.25, "times", why="the range, from one window to the next, in which the strongest line is sought")
_LOBE = numerics(
    4.0, "lines", why="half the main lobe of a Blackman-Harris window: nearer ones are one peak (Harris 1978)"
)
_LEAK = numerics(
    1e-6, "of the power", why="side lobes lie 92 dB below a peak; a decay within the window lifts them to this"
)
_ABOUT = numerics(32, "lines", why="to each side, of whose median a few peaks are no part")
_BETWEEN = numerics(0.25, "lines", why="by which a parabola through logarithms is off at most")
#: To which part of themselves frequencies of the longest window agree.
_AGREES = _BETWEEN / _WINDOWS[1]


def modes_of(recordings: Sequence[Recording], *, whole: bool = False, struck: bool = False) -> list[Mode]:
    """Modes that the free motion of recordings shows, in order of frequency: those of a linear rig with their errors.

    Args:
        recordings: of one rig.
        whole: whether recordings without free motion are looked at as a whole.
        struck: whether modes of a linear rig are looked for behind a hammer's blows, which takes a second or two.
    """
    linear = max((linear_modes(recording, struck=struck) for recording in recordings), key=len, default=())
    if linear:
        return sorted(linear, key=lambda mode: mode.frequency)
    stretches: list[tuple[np.ndarray, float, float]] = []
    for recording in recordings:
        x, fs, noise = np.asarray(recording.response, float), recording.fs, response_of(recording).noise
        spans = [(decay.start, decay.stop) for decay in find_decays(recording)]
        spans = spans or ([(0, x.size)] if whole else [])
        stretches += [(x[a:b], fs, noise) for a, b in spans]
    if not stretches:
        return []
    loudest = max(stretches, key=lambda s: float(np.sum((s[0] - np.mean(s[0])) ** 2)) / s[1])
    try:
        strongest = dominant_frequency(loudest[0], loudest[1])
    except BadInput:
        return []
    tracks = [
        track
        for stretch in stretches
        for cycles in _WINDOWS
        for track in _tracks(*stretch, strongest, cycles, falling=not whole)
    ]
    return _shares(_merged(tracks), stretches, strongest)


@dataclass(frozen=True)
class _Track:
    """A line through windows: its frequency in each (m,), Hz, and its power (m,)."""

    frequency: np.ndarray
    power: np.ndarray


def _tracks(x: np.ndarray, fs: float, noise: float, strongest: float, cycles: float, *, falling: bool) -> list[_Track]:
    """The strongest line of a stretch (n,), and every other that is no harmonic of it, by windows that overlap."""
    size = round(cycles * fs / strongest)
    if x.size < size * (1 + (SEVERAL - 1) / _STEP):
        return []
    window = harris(size)
    starts = range(0, x.size - size + 1, size // _STEP)
    spectra = np.array(
        [np.abs(np.fft.rfft((x[a : a + size] - np.mean(x[a : a + size])) * window)) ** 2 for a in starts]
    )
    white = noise**2 * float(np.sum(window**2))
    chance = np.log(spectra.size) + DECISIVE
    least = white * chance
    main = _followed(spectra, strongest * size / fs)
    heights = spectra[np.arange(main.size), main]
    main, spectra = main[heights > least], spectra[heights > least]
    if main.size < SEVERAL:
        return []
    line = fs / size
    exact = np.array([_between_lines(row, k) for row, k in zip(spectra, main, strict=True)])
    tracks = [_Track(exact * line, np.array([_power(row, k) for row, k in zip(spectra, main, strict=True)]))]
    peaks = [
        [k for k in _peaks(row, least) if row[k] > chance * _level(row, k) and not _is_harmonic(row, k, loud, moved)]
        for row, loud, moved in zip(spectra, exact, _moves(exact), strict=True)
    ]
    open_tracks: list[list[tuple[int, float]]] = []
    closed: list[list[tuple[int, float]]] = []
    for w, places in enumerate(peaks):
        still = []
        taken: set[int] = set()
        for track in open_tracks:
            near = [k for k in places if abs(k - track[-1][1]) <= _LOBE / 2 and k not in taken]
            if not near:
                closed.append(track)
                continue
            k = min(near, key=lambda k: abs(k - track[-1][1]))
            taken.add(k)
            still.append([*track, (w, _between_lines(spectra[w], k))])
        open_tracks = still + [[(w, _between_lines(spectra[w], k))] for k in places if k not in taken]
    for track in (*closed, *open_tracks):
        power = np.array([_power(spectra[w], round(k)) for w, k in track])
        if len(track) >= SEVERAL and (not falling or FALLS**2 * power[0] > power[-1]):
            tracks.append(_Track(np.array([k for _, k in track]) * line, power))
    return tracks


def _followed(spectra: np.ndarray, strongest: float) -> np.ndarray:
    """Lines (m,) of the strongest motion in each window, followed from where it is loudest to both sides."""
    lobe = int(_LOBE)

    def loudest(row: np.ndarray, about: float) -> int:
        low, high = max(lobe, int(about / _GLIDES)), int(np.ceil(about * _GLIDES)) + 1
        return low + int(np.argmax(row[low : max(high, low + 1)]))

    begin = int(np.argmax([row[loudest(row, strongest)] for row in spectra]))
    lines = np.zeros(len(spectra), int)
    lines[begin] = loudest(spectra[begin], strongest)
    for k in range(begin + 1, len(spectra)):
        lines[k] = loudest(spectra[k], lines[k - 1])
    for k in range(begin - 1, -1, -1):
        lines[k] = loudest(spectra[k], lines[k + 1])
    return lines


def _peaks(row: np.ndarray, least: float) -> list[int]:
    """Lines (k,) that stand out of the noise, of what is loudest of its neighbourhood, and of what folds back.

    Harmonics beyond half the sampling rate fold back anywhere, but are no twice as large as those just below it.
    """
    from scipy.ndimage import maximum_filter1d

    top = row[int(2 * BELOW_NYQUIST * row.size) :]
    high = max(least, float(np.max(row)) * _LEAK, 2.0**2 * float(np.max(top)) if np.max(top) > least else 0.0)
    crest = row == maximum_filter1d(row, 2 * int(_LOBE) + 1)
    crest[: 2 * int(_LOBE)] = False  # an offset and a drift
    crest[int(2 * BELOW_NYQUIST * row.size) :] = False
    return [int(k) for k in np.flatnonzero(crest & (row > high))]


def _level(row: np.ndarray, k: int) -> float:
    """Mean power of the noise about a line, whatever its colour: of such powers the median is log 2 of the mean."""
    return float(np.median(row[max(0, k - _ABOUT) : k + _ABOUT + 1])) / float(np.log(2.0))


def _moves(exact: np.ndarray) -> np.ndarray:
    """By how many lines (m,) the strongest one moves within each window."""
    return _STEP * np.abs(np.gradient(exact)) if exact.size > 1 else np.zeros(exact.size)


def _is_harmonic(row: np.ndarray, k: int, strongest: float, moved: float) -> bool:
    """Whether a line is a multiple of the strongest one, itself among them, or cannot be distinguished from one.

    No harmonic is as large as its fundamental: even those of an impact are no larger, whose force is a pulse. And a
    series of harmonics falls: one twice as large as all those before it is none.
    """
    order = max(1, round(k / strongest))
    if order > 1 and row[k] > row[round(strongest)]:
        return False
    if order > SEVERAL:
        before = [float(np.max(row[round(n * strongest) - 1 : round(n * strongest) + 2])) for n in range(2, order)]
        if row[k] > 2.0**2 * max(before):
            return False
    return abs(k - order * strongest) <= _LOBE + order * (moved + _BETWEEN)


def _between_lines(row: np.ndarray, k: int) -> float:
    """Where a peak lies between the lines, by a parabola through logarithms."""
    if not 0 < k < row.size - 1 or row[k] <= max(row[k - 1], row[k + 1]):
        return float(k)
    a, b, c = np.log(row[k - 1 : k + 2] + 1e-300)
    return k + float(a - c) / float(2 * (a - 2 * b + c))


def _power(row: np.ndarray, k: int) -> float:
    return float(np.sum(row[max(0, k - int(_LOBE)) : k + int(_LOBE) + 1]))


def _merged(tracks: Sequence[_Track]) -> list[tuple[float, float, float]]:
    """Frequency where it is loudest, lowest and highest, Hz, of tracks that overlap, in order of frequency."""
    spans: list[tuple[float, float, float, float]] = []
    for track in sorted(tracks, key=lambda t: float(np.min(t.frequency))):
        low, high = float(np.min(track.frequency)), float(np.max(track.frequency))
        loud = int(np.argmax(track.power))
        this = (float(track.frequency[loud]), low, high, float(track.power[loud]))
        if spans and low <= spans[-1][2] * SAME_MODE:
            last = spans[-1]
            best = max(last, this, key=lambda s: s[3])
            spans[-1] = (best[0], last[1], max(last[2], high), best[3])
        else:
            spans.append(this)
    kept: list[tuple[float, float, float, float]] = []
    for span in sorted(spans, key=lambda s: -s[3]):
        if not any(_is_combination(span[0], first[0], second[0]) for first in kept for second in kept):
            kept.append(span)
    return sorted(span[:3] for span in kept)


def _is_combination(frequency: float, first: float, second: float) -> bool:
    """Whether a frequency is a sum or a difference of multiples of two others."""
    orders = range(ORDERS + 1)
    made = [abs(n * first + sign * m * second) for n in orders for m in orders for sign in (1, -1) if n + m > 1]
    return any(abs(frequency - f) < _AGREES * frequency for f in made)


def _shares(
    spans: Sequence[tuple[float, float, float]],
    stretches: Sequence[tuple[np.ndarray, float, float]],
    strongest: float,
) -> list[Mode]:
    """Modes with their shares of the power above the noise, but for those that a fit of the strongest would not notice.

    The power is that between the geometric means of neighbouring frequencies.
    """
    edges = [0.0, *(float(np.sqrt(a[2] * b[1])) for a, b in pairwise(spans)), np.inf]
    powers, noise = np.zeros(len(spans)), 0.0
    for x, fs, level in stretches:
        spectrum = np.abs(np.fft.rfft(x - np.mean(x))) ** 2 / x.size * 2.0 / fs
        frequency = np.fft.rfftfreq(x.size, 1.0 / fs)
        for i in range(len(spans)):
            inside = (frequency > edges[i]) & (frequency <= edges[i + 1])
            powers[i] += max(float(np.sum(spectrum[inside] - level**2 * 2.0 / fs)), 0.0)
        noise += level**2 * x.size / fs
    first = min(range(len(spans)), key=lambda i: abs(np.log(spans[i][0] / strongest)), default=None)
    kept = [i for i in range(len(spans)) if powers[i] > (ABOVE_NOISE**2 - 1) * noise or i == first]
    total = float(np.sum(powers[kept])) or 1.0
    return [Mode(*spans[i], share=float(powers[i]) / total, strongest=i == first) for i in kept]

"""The pieces of a recording: where each begins and ends, what is known of it, and which are the rig's own motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .cells import FEWEST, LOOKS_BACK, OF_FREE, Cells
from .damped_windows import Windows, fit_windows

#: A decay ends where its envelope has come down to this many times that of the noise.
_ABOVE_NOISE = 2.0
#: Places at which an edge is sought: with many more one would be beyond chance by chance.
_PLACES = 48
#: This part of a cycle, or of a piece, beside an edge is nobody's.
_SPARE = 8
#: Of one damped mode less than this is left of the motion; of several, or where it glides within two cycles, more.
_ONE_MODE = 0.03
#: A fall is known from a third of itself on. The frequency of one rig glides by less than this (natural logarithm).
_SURE, _ONE_RIG = 3.0, 0.3

FREE, HELD, MOVED = "free", "held", "moved"


@dataclass(frozen=True)
class Piece:
    """Samples start to stop of a recording in one kind of motion.

    Attributes:
        start, stop: as Python slices them.
        kind: free, held or moved.
        omega, omega_std: of a free piece, rad/s.
        rate, rate_std: of its fall, 1/s.
        amplitude: largest, unit of the recording.
        audible: sample at which it has come down to its noise, ``stop`` where it has not.
        glide: from its lowest to its highest frequency, of two cycles each (natural logarithm).
        left: what a damped sine leaves beyond the noise of two cycles, as a part of their motion.
    """

    start: int
    stop: int
    kind: str
    omega: float = 0.0
    omega_std: float = np.inf
    rate: float = 0.0
    rate_std: float = np.inf
    amplitude: float = 0.0
    audible: int = 0
    glide: float = 0.0
    left: float = 0.0


def pieces_between(cells: Cells, share: float, runs: list[tuple[int, int, str]], n: int, fs: float) -> list[Piece]:
    """The runs with edges in samples, each free one as far as its model goes on."""
    pieces: list[Piece] = []
    taken = np.zeros(cells.means.size, bool)
    order = sorted(range(len(runs)), key=lambda i: (runs[i][2] != FREE, runs[i][0] - runs[i][1]))
    for index in order:  # the longest first: what is short beside it may be its own edge
        first, end, kind = runs[index]
        a, b = first * cells.cell, end * cells.cell
        if kind == FREE:
            a = _edge(cells, first, end)
            b = cells.count * cells.cell - _edge(cells.turned, cells.count - end, cells.count - first)
        b = cells.means.size if b == cells.count * cells.cell else b
        open_ = np.flatnonzero(~taken[a:b])
        if not open_.size:
            continue
        a, b = a + int(open_[0]), a + int(open_[-1]) + 1
        taken[a:b] = True
        begin, stop = a * cells.block, n if b >= cells.means.size else b * cells.block
        if kind == FREE:  # what a hand does at first hides in the noise
            spare = min(round(cells.period), b - a) // _SPARE
            a, b = a + spare * (a > 0), b - spare * (b < cells.means.size)
            begin, stop = a * cells.block, n if b >= cells.means.size else b * cells.block
        if kind == FREE and b - a >= FEWEST:
            pieces.append(_free_piece(cells, share, first, end, begin, stop, fs))
        elif kind != FREE:
            pieces.append(Piece(begin, stop, kind))
    return sorted(pieces, key=lambda piece: piece.start)


def scale_of(cells: Cells, share: float, fit: Windows, which: int) -> float:
    """Standard deviation of a block mean about a model."""
    size = float(fit.amplitude(0.0)[which])
    return float(np.sqrt(cells.noise**2 + 0.5 * (share * size) ** 2))


def _edge(cells: Cells, first: int, end: int) -> int:
    """First block mean from which on a free run is free: there a window leaves no more than one further inside does."""
    n = cells.means.size
    length = int(min(max(round(cells.period), 2 * FEWEST), (end - first) * cells.cell))
    inside = (end - first) * cells.cell - length
    begin, stop = (
        max(0, (first - cells.a_cycle) * cells.cell),
        min(n - length, first * cells.cell + min(2 * cells.cell, inside)),
    )
    places = np.arange(begin, stop + 1, max(1, (stop - begin) // _PLACES))
    if places.size < 2:
        return first * cells.cell
    windows = cells.means[places[:, None] + np.arange(length)]
    fit = fit_windows(windows, 2 * np.pi / cells.period, slope=False)
    left = np.sqrt(fit.rss / max(1, length - OF_FREE))
    usual = max(cells.noise, float(np.median(left[-max(1, left.size // 3) :])))
    bad = np.flatnonzero(left > usual * _chance(max(1, length - OF_FREE)))
    start = int(bad[-1]) + 1 if bad.size else 0
    return int(places[min(start, places.size - 1)]) + (start > 0)


def variances_of(information: np.ndarray) -> np.ndarray:
    """(p,) variances for a noise of one; infinite where nothing is known."""
    scale = np.sqrt(np.diag(information))
    if not np.all(scale > 0):
        return np.full(scale.size, np.inf)
    return np.diag(np.linalg.pinv(information / np.outer(scale, scale))) / scale**2


def _whole(cells: Cells, start: int, stop: int, omega: float) -> tuple[float, float]:
    """Rate of fall of one damped sine over a whole piece, and its standard error with what it leaves, per block mean.

    What it leaves where the motion glides is as slow as the motion, so that a cycle of it counts once.
    """
    n = stop - start
    thin = max(1, n // 4000)
    samples = cells.means[start : start + n // thin * thin].reshape(-1, thin).mean(axis=1)
    if samples.size < 2 * FEWEST or omega * thin > 1.5:
        return 0.0, np.inf
    fit = fit_windows(samples[None, :], omega * thin, slope=True)
    left = float(fit.rss[0]) / max(1, samples.size - 6)
    white = cells.noise**2 / thin
    inflated = white + max(0.0, left - white) * max(1.0, 2 * np.pi / (omega * thin))
    variance = float(variances_of(fit.information[0])[1])
    unit = float(fit.omega[0]) / thin
    return float(fit.zeta[0]) * unit, float(np.sqrt(inflated * variance)) * unit


def _chance(freedom: int) -> float:
    """What the rms of so many degrees of freedom of noise exceeds once in 10,000 (Wilson and Hilferty 1931)."""
    part = 2.0 / (9.0 * freedom)
    return float((1.0 - part + 3.72 * np.sqrt(part)) ** 1.5)


def _free_piece(cells: Cells, share: float, first: int, end: int, start: int, stop: int, fs: float) -> Piece:
    """What is known of a free piece: of each of its windows, and of the fall from one to the next."""
    length = min(LOOKS_BACK * cells.a_cycle, end - first)
    fit = cells.free[length - 1]
    places = np.arange(first, end - length + 1, length)
    unit = fs / cells.block
    usual = np.sqrt(fit.rss[places] / (length * cells.cell))
    scales = np.maximum([scale_of(cells, share, fit, int(p)) for p in places], usual)
    spread = np.array([variances_of(fit.information[p])[:2] for p in places])
    omega_std = scales * np.sqrt(spread[:, 0]) * fit.omega[places]
    rates, rate_std = (fit.zeta * fit.omega)[places], scales * np.sqrt(spread[:, 1]) * fit.omega[places]
    sizes = fit.amplitude(0.0)[places]
    weights = 1 / omega_std**2
    omega = float(np.sum(weights * fit.omega[places]) / np.sum(weights))
    known = [(float(np.sum(rates / rate_std**2) / np.sum(rate_std**-2)), float(np.sum(rate_std**-2) ** -0.5))]
    known.append(_whole(cells, start // cells.block, -(-stop // cells.block), omega))
    rate, error = min(known, key=lambda one: one[1])
    samples = length * cells.cell
    left = np.sqrt(
        np.maximum(fit.rss[places] / samples - cells.noise**2, 0)
        / np.maximum(cells.rss_held[length - 1][places] / samples, cells.noise**2)
    )
    loud = fit.amplitude(samples)[places] > 3 * cells.noise
    audible = _audible(cells, fit, places, samples, stop)
    return Piece(
        start,
        stop,
        FREE,
        omega * unit,
        float(np.sum(weights) ** -0.5) * unit,
        rate * unit,
        error * unit,
        float(np.max(sizes)),
        audible,
        float(np.ptp(np.log(fit.omega[places[loud]]))) if np.any(loud) else 0.0,
        float(np.median(left[loud])) if np.any(loud) else 0.0,
    )


def _audible(cells: Cells, fit: Windows, places: np.ndarray, length: int, stop: int) -> int:
    """Sample at which the windows' motion has come down to twice the envelope of the noise, at most ``stop``."""
    floor = _ABOVE_NOISE * np.sqrt(2.0) * cells.noise * np.sqrt(cells.block)
    for place in places:
        size, rate = float(fit.amplitude(0.0)[place]), float(fit.zeta[place] * fit.omega[place])
        after = np.log(max(size / floor, 1.0)) / rate if rate > 0 else np.inf
        if after < length:
            return min(stop, int((place * cells.cell + after) * cells.block))
    return stop


def _at_one_frequency(piece: Piece, main: Piece) -> bool:
    """Whether a piece swings as another does, within its error and what the other's frequency glides by."""
    error = np.hypot(piece.omega_std / piece.omega, main.omega_std / main.omega)
    apart = abs(float(np.log(piece.omega / main.omega)))
    return apart < min(_ONE_RIG, _SURE * error + max(main.glide, piece.glide))


def free_pieces(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """Those free pieces of one rig whose frequency and fall are known: each by itself, or by what the others add.

    The frequency at which most cycles are free is the rig's; what moves at another was moved. A piece that tells less
    of the fall than the fall itself adds nothing.
    """
    free = [
        p for p in pieces if p.kind == FREE and np.isfinite(p.rate_std) and p.left <= _ONE_MODE and p.glide < _ONE_RIG
    ]
    best: tuple[float, tuple[Piece, ...]] = (0.0, ())
    for main in free:
        same = [p for p in free if _at_one_frequency(p, main)]
        weights = np.array([p.rate_std for p in same]) ** -2.0
        rate = float(np.sum(weights * [p.rate for p in same]) / np.sum(weights))
        if rate < _SURE * np.sum(weights) ** -0.5:
            continue
        alone = any(p.rate_std < rate / _SURE for p in same)
        told = [
            p
            for p in same
            if rate / 3 < p.rate + _SURE * p.rate_std
            and p.rate - _SURE * p.rate_std < 3 * rate
            and p.rate_std < rate * (1.0 if alone else np.sqrt(len(same)))
        ]
        cycles = sum((p.stop - p.start) * p.omega for p in told)
        if cycles > best[0]:
            best = (cycles, tuple(told))
    return best[1]

"""The free pieces of a recording that one rig of Eq. 17 explains down to the noise.

Windows of all lengths that a damped sine explains best are fitted with Eq. 17 (``rig_fit``). The likeliest against a
hand's smooth ways are grown (``rig_growth``), and other pieces are asked of the same rig. Nothing is asked of the
number of cycles or of the shape of an envelope: the fit decides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...recording.recording import QUANTITIES
from ..signals.odds import BY_CHANCE, DECISIVE, SIGNIFICANT
from ..signals.registry import budget, numerics
from .hand import OF_MOVED, to_place
from .limits import KNOWN, SHARES
from .rig_fit import (
    LEAST_NOISE,
    LEAST_SAMPLES,
    NAMES,
    Piece,
    Record,
    Rig,
    audible,
    fit_piece,
    holds,
    is_white,
    measured,
    odds_of,
)
from .rig_growth import grown

_POINTS = budget(96, "samples", why="of a window")
_SHORTER = budget(1.4, "times", why="each length over the next")
_WINDOWS = budget(12, "windows", why="of each length, those that a damped sine explains best")
_ASKED = budget(64, "windows", why="of each length, that are asked of a known rig")
_APART = budget(1 / 8, "of a window", why="from one to the next")
_TRIED = budget(3, "windows", why="that are grown, the likeliest first")
_MOST = budget(2**13, "samples", why="of a recording that pieces are grown in")
_ASKING = budget((4.0, 2.0, 1.0, 0.5), "cycles", why="of windows that are asked of a known rig")
_CYCLES = numerics(tuple(0.5 * 1.15**k for k in range(18)), "cycles a window", why="that a sine of it may have")
_RATIOS = numerics((0.01, 0.15, 0.5), "damping ratios", why="between which a fit finds its way")
_FASTEST = numerics(1.6, "rad a sample", why="four samples a cycle")
_COARSE = numerics(0.15, "of its power", why="what a sine may leave of a window from which a fit finds its way")
_MOST_DAMPED = numerics(0.9, "damping ratio", why="of a sine at which a search begins")
_MOVED = numerics(1e-6, "of a unit", why="of a difference quotient")


@dataclass(frozen=True, eq=False)
class RigPieces:
    """The free pieces of a recording and their rig.

    Attributes:
        pieces: (start, stop) in samples.
        values: the parameters of Eq. 17 in SI.
        omega, rate: frequency, rad/s, and rate of fall, 1/s, at half the largest amplitude.
        evidence: logarithm of the odds that the pieces are free and not a hand's ways.
        share: of the motion that it was allowed to leave beside the noise.
    """

    pieces: tuple[tuple[int, int], ...]
    values: dict[str, float]
    omega: float
    rate: float
    evidence: float
    share: float

    @property
    def is_bent(self) -> bool:
        """Whether a member of Eq. 17 is there that makes the rig another than a linear one."""
        return any(self.values[name] != 0.0 for name in ("cubic", "preload", "dry"))


@np.errstate(over="ignore", invalid="ignore")  # a trial that grows beyond bounds is none
def rig_pieces(x: np.ndarray, fs: float, noise: float, period: float, quantity: str) -> RigPieces | None:
    """The free pieces of a response that one rig of Eq. 17 explains; None where there are none.

    Args:
        x: (n,) response, in SI.
        fs: samples a second.
        noise: standard deviation of its white noise.
        period: samples a cycle that it has at least.
        quantity: what it shows of the motion.
    """
    unit = float(np.ptp(x)) / 2
    found: list[_Found] = []
    for share in SHARES:
        for seed, record in _seeds(x, noise, quantity, max(LEAST_SAMPLES, round(_ASKING[-1] * period)), share):
            if not any(one.has(record, seed) for one in found):
                one = _all_pieces(record, seed, share, x)
                if one.evidence > DECISIVE and all(map(is_white, one.pieces)):
                    found.append(one)
        if found:
            return _in_si(max(found, key=lambda one: one.evidence), x.size, fs, unit, share)
    return None


@dataclass(frozen=True, eq=False)
class _Found:
    """Pieces of a record in order of their finding, and the evidence for them."""

    record: Record
    pieces: list[Piece]
    evidence: float

    def has(self, record: Record, piece: Piece) -> bool:
        """Whether a piece of another record lies in one of these."""
        own, other = self.record.thin, record.thin
        return any(p.a * own <= piece.a * other and p.b * own >= piece.b * other for p in self.pieces)


def _seeds(x: np.ndarray, noise: float, quantity: str, shortest: int, share: float) -> list[tuple[Piece, Record]]:
    """Windows that Eq. 17 explains and that are not decisively a hand's, the likeliest first, with their records."""
    seeds: list[tuple[float, Piece, Record]] = []
    length = x.size
    while length >= shortest:
        thinned = _recorded(x, noise, max(1, length // _POINTS), quantity)
        size = length // thinned.thin
        for a, start, record in _starts(thinned, size):
            piece = fit_piece(record, a, a + size, start, share)
            if piece is not None and holds(piece) and (odds := odds_of(record, piece)) > -DECISIVE:
                seeds.append((odds, piece, record))
        length = int(length / _SHORTER)
    seeds.sort(key=lambda seed: -seed[0])
    return [(piece, record) for _, piece, record in seeds[:_TRIED]]


def _in_si(found: _Found, n: int, fs: float, unit: float, share: float) -> RigPieces | None:
    """Pieces by the sample of the recording, as far as they are heard; None where little is known of their rig."""
    record, order = found.record, QUANTITIES.index(found.record.quantity)
    rig = _plain(found.pieces[-1].rig)  # which knows what all before it have told
    size = _size(record, found.pieces)
    if not _known(rig, size):
        return None
    edges = []
    for p in found.pieces:
        shown = record.x[p.a : p.b]
        response = shown - record.made(p.values, p.b - p.a, shown)[0] - p.values[7]
        heard = p.a + audible(response, record.noise)
        stop = n if heard >= record.x.size else (heard - 1) * record.thin + 1
        edges += [(p.a * record.thin, stop)] if heard > p.a else []
    pace = record.pace / record.thin * fs
    length = unit / pace**order
    units = np.array([pace, pace**2 / length**2, pace**2 * length, pace, pace**2 * length])
    values = dict(zip(NAMES, (rig.values * units).tolist(), strict=True))
    omega, fall = (part * pace for part in _amid(rig.values, size))
    return RigPieces(tuple(sorted(edges)), values, omega, fall / 2, found.evidence, share)


def _size(record: Record, pieces: Sequence[Piece]) -> float:
    """Largest displacement of pieces, in units of the record, as a linear rig would have it."""
    largest = max(float(np.max(np.abs(record.x[p.a : p.b] - p.values[7]))) for p in pieces)
    return largest / float(pieces[-1].values[0]) ** QUANTITIES.index(record.quantity)


def _amid(values: np.ndarray, size: float) -> tuple[float, float]:
    """Frequency and damping, as multiples of the pace, at half an amplitude, by describing functions."""
    half = size / 2
    spring = values[0] ** 2 + 0.75 * values[1] * half**2 + 4 * values[2] / (np.pi * half)
    omega = float(np.sqrt(abs(spring)))
    return omega, float(values[3] + 4 * values[4] / (np.pi * half * omega))


def _plain(rig: Rig) -> Rig:
    """The rig, or the linear one where the members of Eq. 17 that make it another are none by chance."""
    from scipy.special import chdtri

    lines, others = [0, 3], [1, 2, 4]
    within = np.linalg.pinv(rig.covariance[np.ix_(others, others)], hermitian=True)
    off = rig.values[others]
    if off @ within @ off > float(chdtri(len(others), BY_CHANCE)):
        return rig
    gain = rig.covariance[np.ix_(lines, others)] @ within
    values, covariance = np.zeros(5), np.zeros((5, 5))
    values[lines] = rig.values[lines] - gain @ off
    less = gain @ rig.covariance[np.ix_(others, lines)]
    covariance[np.ix_(lines, lines)] = rig.covariance[np.ix_(lines, lines)] - less
    return Rig(values, covariance)


def _known(rig: Rig, size: float) -> bool:
    """Whether frequency and damping amid the amplitudes are known to a third."""
    middle = np.array(_amid(rig.values, size))
    moves = _MOVED * np.eye(5)
    slopes = np.array([(np.array(_amid(rig.values + move, size)) - middle) / _MOVED for move in moves])
    spread = np.sqrt(np.diag(slopes.T @ rig.covariance @ slopes))
    return bool(np.all(spread < KNOWN * middle) and middle[0] > 0)


def _all_pieces(record: Record, seed: Piece, share: float, x: np.ndarray) -> _Found:
    """The seed grown, and what else its rig explains."""
    record, share = measured(record, seed, share)
    piece = grown(record, seed, share, (0, record.x.size))
    record, share = measured(record, piece, share)
    record, piece = _finer(record, piece, x, share)
    n = record.x.size
    piece = grown(record, piece, share, (0, n))
    pieces, evidence = [piece], odds_of(record, piece) - to_place(n)
    for cycles in _ASKING:
        rig = pieces[-1].rig
        omega, fall = _amid(rig.values, _size(record, pieces))
        ratio = min(max(fall / 2 / omega, 0.0), _MOST_DAMPED)
        length = max(LEAST_SAMPLES, round(cycles * 2 * np.pi / record.pace))
        for a in _like(record, length, omega, ratio):
            b = a + length
            if any(p.a < b and p.b > a for p in pieces):
                continue
            start = np.concatenate([rig.values, _sine(record, a, b, omega, ratio)[5:]])
            found = fit_piece(record, a, b, start, share, pieces[-1].rig)
            if found is None or not holds(found) or odds_of(record, found) - to_place(n) < DECISIVE:
                continue
            limits = (
                max((p.b for p in pieces if p.b <= a), default=0),
                min((p.a for p in pieces if p.a >= b), default=n),
            )
            found = grown(record, found, share, limits, pieces[-1].rig)
            evidence += odds_of(record, found) - to_place(n)
            pieces.append(found)
    return _Found(record, pieces, evidence)


def _finer(record: Record, piece: Piece, x: np.ndarray, share: float) -> tuple[Record, Piece]:
    """Record and piece in as many samples as there are, or as the budget allows."""
    thin = min(max(1, x.size // _MOST), record.thin)
    if thin == record.thin:
        return record, piece
    fine = _recorded(x, 0.0, thin, record.quantity)
    fine = replace(fine, pace=record.pace * thin / record.thin, noise=record.noise)
    a, b = -(-piece.a * record.thin // thin), (piece.b - 1) * record.thin // thin + 1
    again = fit_piece(fine, a, b, piece.values, share)
    return (fine, again) if again is not None and holds(again) else (record, piece)


def _windows(record: Record, length: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First samples (m,) of windows in which something moves, samples (m, length) about their means, and powers."""
    n = record.x.size
    count = 1 + -(-(n - length) // max(round(_APART * length), 1))
    firsts = np.unique(np.linspace(0, n - length, count).astype(int))
    windows = record.x[firsts[:, None] + np.arange(length)]
    windows = windows - np.mean(windows, axis=1, keepdims=True)
    power = np.sum(windows**2, axis=1)
    moves = power > SIGNIFICANT**2 * length * record.noise**2
    return firsts[moves], windows[moves], power[moves]


def _like(record: Record, length: int, omega: float, ratio: float) -> list[int]:
    """First samples of windows that a damped sine of a known rig explains, the best first."""
    if length > record.x.size:
        return []
    firsts, windows, power = _windows(record, length)
    basis = np.linalg.qr(_columns(length, omega * record.pace, ratio, record.quantity))[0]
    left = 1 - np.sum((windows @ basis) ** 2, axis=1) / power
    return [int(firsts[k]) for k in np.argsort(left) if left[k] < _COARSE][:_ASKED]


def _starts(record: Record, length: int) -> list[tuple[int, np.ndarray, Record]]:
    """Windows that a damped sine explains best beside a smooth way: first sample, values, the record at its pace."""
    firsts, windows, power = _windows(record, length)
    way = np.linalg.qr(np.vander(np.linspace(-1, 1, length), OF_MOVED))[0]
    quiet = length * record.noise**2
    smooth = np.maximum(power - np.sum((windows @ way) ** 2, axis=1), 0.0) + quiet
    best, which = np.full(firsts.size, np.inf), np.zeros((firsts.size, 2))
    for omega in 2 * np.pi * np.array(_CYCLES) / length:
        for ratio in _RATIOS if omega < _FASTEST else ():
            basis = np.linalg.qr(_columns(length, omega, ratio, record.quantity))[0]
            left = power - np.sum((windows @ basis) ** 2, axis=1)
            better = left < best
            best[better], which[better] = left[better], (omega, ratio)
    found = []
    for k in [k for k in np.argsort((best + quiet) / smooth) if best[k] < _COARSE * power[k]][:_WINDOWS]:
        first, own = int(firsts[k]), replace(record, pace=float(which[k, 0]))
        found.append((first, _sine(own, first, first + length, 1.0, float(which[k, 1])), own))
    return found


def _columns(n: int, omega: float, ratio: float, quantity: str) -> np.ndarray:
    """(n, 3) what a sensor shows of a damped sine, omega in rad a sample: its two phases and a constant."""
    pole = omega * (-ratio + 1j * np.sqrt(1 - ratio**2))
    shape = np.exp(pole * np.arange(n)) * (pole / omega) ** QUANTITIES.index(quantity)
    return np.column_stack([shape.real, -shape.imag, np.ones(n)])


def _sine(record: Record, a: int, b: int, omega: float, ratio: float) -> np.ndarray:
    """(9,) values of a piece that is a damped sine, omega in units of the pace."""
    weights = np.linalg.lstsq(_columns(b - a, omega * record.pace, ratio, record.quantity), record.x[a:b])[0]
    pole = omega * (-ratio + 1j * np.sqrt(1 - ratio**2))
    state = complex(weights[0], weights[1]) * np.array([1.0, pole]) / omega ** QUANTITIES.index(record.quantity)
    return np.array([omega, 0.0, 0.0, 2 * ratio * omega, 0.0, *state.real, weights[2], 0.0])


def _recorded(x: np.ndarray, noise: float, thin: int, quantity: str) -> Record:
    """Every so many samples of a response, in units of half its range."""
    unit = float(np.ptp(x)) / 2
    return Record((x[::thin] - np.median(x)) / unit, 1.0, max(noise / unit, LEAST_NOISE), thin, quantity)

"""Which part of the recordings all the rest contradicts: without it one model tells everything else to its noise.

A lie of a measuring chain begins and ends somewhere, or is in one recording. So every stretch of every recording is
left out in turn, from the normal equations alone (one step of the search without it; Cook 1977), and of those without
which no more than noise is left anywhere the shortest is confirmed by a search. By how much the parameters move then is
what that part may have done to them. What the family lacks leaves more than noise in the rest as well, unless nothing
else goes as far or is driven as hard: that is told apart where recordings overlap, and said where they do not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..recording.recording import Recording
from .data import expected_noise
from .delivered import Fit
from .excitation import band_of
from .fitted_problem import fitted_problem
from .normal_equations import pseudo_inverse
from .odds import DECISIVE
from .output_error import OutputError, State
from .segments import Segment
from .signals import noise_levels
from .weighed import ABOVE_NOISE

#: Pieces that each recording is left out in; none shorter than a cycle, which has no amplitude to contradict anything.
_PIECES = 24
#: A part is tried where one step without it leaves this part of what is more than noise; each step then halves it.
_PROMISING = 0.1
#: Steps of the search without a part, at most and at least: a large lie is no small step, and what leaves no more
#: than noise may yet be some errors from where that is least.
_STEPS, _FEWEST_STEPS = 8, 2
#: Of parts that a search does not confirm the next one tried is longer by this factor.
_LONGER = 1.25
#: Physical limit: a law of the third power that acts at some amplitude, force or frequency is still there at one a
#: tenth lower, by three quarters.
_ALIKE = 1.1


@dataclass(frozen=True)
class Part:
    """A part of a recording: from when to when, s, and which of its pieces, as a Python slice of ``of`` of them."""

    recording: int
    begin: float
    end: float
    first: int
    last: int
    of: int

    @property
    def whole(self) -> bool:
        """Whether it is all of it."""
        return self.last - self.first == self.of

    def holds(self, segment: Segment) -> np.ndarray:
        """(n,) which samples of a segment are in it."""
        if segment.recording != self.recording:
            return np.zeros(segment.n, bool)
        piece = _piece(segment, self.begin_of_all, self.end_of_all, self.of)
        return (piece >= self.first) & (piece < self.last)

    @property
    def begin_of_all(self) -> float:
        """When the fitted part of the recording begins, s."""
        return self.begin - self.first * self._length

    @property
    def end_of_all(self) -> float:
        """When it ends, s."""
        return self.begin_of_all + self.of * self._length

    @property
    def _length(self) -> float:
        return (self.end - self.begin) / (self.last - self.first)

    def apart_from(self, other: Part) -> bool:
        """Whether two parts have nothing in common."""
        return self.recording != other.recording or self.last <= other.first or other.last <= self.first


@dataclass(frozen=True, eq=False)
class Contradiction:
    """A part of a recording that the rest contradicts, or that and another of which either may be right.

    Attributes:
        part: the shortest without which no more than noise is left.
        other: one apart from it that might as well be left out; None where there is none.
        shifts: (free,) each, by how much the parameters move without it, and without the other where there is one.
        reached: whether the rest moves as far, and is driven as hard at the same frequencies, so that it would show
            physics that the family lacks as well.
        state: of the fitted problem (``fitted_problem``) without the part.
        left: what is left of each segment (n,) there, in the part too.
    """

    part: Part
    other: Part | None
    shifts: tuple[np.ndarray, ...]
    reached: bool
    state: State
    left: tuple[np.ndarray, ...]


def contradiction(fit: Fit, recordings: Sequence[Recording]) -> Contradiction | None:
    """The part that the rest contradicts; None where no more than noise is left, or no part is to blame alone.

    Args:
        fit: of these recordings.
        recordings: as they were fitted.
    """
    problem, state = fitted_problem(fit, recordings)
    residuals = problem.residuals(state)
    if not problem.free or not all(bool(np.all(np.isfinite(r))) for r in residuals):
        return None
    values = dict(zip(fit.oscillator.parameters(), map(float, state.values), strict=True))
    levels = [expected_noise(s, values, *noise_levels(recordings[s.recording])) for s in problem.segments]
    if _is_noise(np.array([np.sum((r / v) ** 2) for r, v in zip(residuals, levels, strict=True)]), _sizes(problem)):
        return None
    candidates = _without_noise(problem, state, residuals, levels, _PROMISING)
    first = _confirmed(problem, state, levels, candidates)
    if first is None:
        return None
    # seen from there, where nothing is far off any more, the part has its true length
    nearer = _without_noise(problem, first[1], problem.residuals(first[1]), levels, 0.0)
    within = [part for part in nearer if not part.apart_from(first[0])]
    first = _confirmed(problem, first[1], levels, within) or first
    part, without = first
    second = _confirmed(problem, state, levels, [other for other in candidates if other.apart_from(part)])
    places = list(problem.free)
    found = [first] if second is None else [first, second]
    shifts = tuple(point.values[places] - state.values[places] for _, point in found)
    other = None if second is None else second[0]
    left = problem.residuals(without)
    return Contradiction(part, other, shifts, _reached(problem, left, part, recordings), without, left)


def covering(fit: Fit, found: Contradiction) -> Fit:
    """The fit with standard errors that cover what either part may have done to its values."""
    covariance = fit.covariance + sum(np.outer(shift, shift) for shift in found.shifts)
    known = fit.oscillator.parameters()
    wider = {
        name: replace(known[name], std=math.sqrt(variance))
        for name, variance in zip(fit.names, np.diag(covariance), strict=True)
        if known[name].std is not None
    }
    return replace(fit, covariance=covariance, oscillator=fit.oscillator.with_parameters(wider))


def _sizes(problem: OutputError) -> np.ndarray:
    return np.array([segment.n for segment in problem.segments])


def _is_noise(squares: np.ndarray, samples: np.ndarray) -> bool:
    """Whether sums of squares over the noise's are those of noise, whose level is an estimate itself."""
    return bool(np.all(squares <= ABOVE_NOISE**2 * samples + 2.0 * DECISIVE))


def _excess(squares: np.ndarray, samples: np.ndarray) -> float:
    """What is more than noise, in its squares a sample, where that is most."""
    return float(np.max(squares / samples)) - 1.0


def _piece(segment: Segment, begin: float, end: float, count: int) -> np.ndarray:
    """(n,) in which piece of its recording each sample is."""
    times = segment.time + np.arange(segment.n) * segment.dt
    return np.clip(((times - begin) / (end - begin) * count + 1e-9).astype(int), 0, count - 1)


def _spans(problem: OutputError) -> dict[int, tuple[float, float, int]]:
    """From when to when each recording was fitted, and how many pieces that makes."""
    spans = {}
    for recording in sorted({segment.recording for segment in problem.segments}):
        own = [segment for segment in problem.segments if segment.recording == recording]
        begin, end = min(s.time for s in own), max(s.time + s.n * s.dt for s in own)
        cycles = int((end - begin) * own[0].pace / (2 * np.pi))
        spans[recording] = (begin, end, max(1, min(_PIECES, cycles)))
    return spans


@dataclass(frozen=True, eq=False)
class _Reduced:
    """Normal equations of s segments, initial states eliminated: (s, k, k), (s, k); sums of squares, samples (s,)."""

    matrix: np.ndarray
    right: np.ndarray
    squares: np.ndarray
    samples: np.ndarray

    def step(self) -> np.ndarray:
        """(k,) of the shared unknowns."""
        return pseudo_inverse(self.matrix.sum(axis=0)) @ self.right.sum(axis=0)

    def left(self, step: np.ndarray) -> np.ndarray:
        """(s,) sums of squares after a step."""
        return self.squares - 2.0 * self.right @ step + np.einsum("i,sij,j->s", step, self.matrix, step)


def _reduced(grams: Sequence[np.ndarray], samples: Sequence[int] | np.ndarray, k: int) -> _Reduced:
    """Of inner products (k + states + 1, ...) of derivatives and residual of each segment."""
    rows = []
    for gram in grams:
        own = slice(k, -1)
        inverse = pseudo_inverse(gram[own, own])
        keep = np.r_[0:k, -1]
        rows.append(gram[np.ix_(keep, keep)] - gram[keep, own] @ inverse @ gram[own, keep])
    made = np.array(rows)
    return _Reduced(made[:, :k, :k], made[:, :k, k], made[:, k, k], np.array(samples))


def _rows(
    problem: OutputError, state: State, residuals: Sequence[np.ndarray], levels: Sequence[float]
) -> list[np.ndarray]:
    """Of each segment derivatives and residual in units of its noise."""
    derivatives = problem.derivatives(state, residuals)
    return [np.vstack([d, r]) / v for d, r, v in zip(derivatives, residuals, levels, strict=True)]


def _without_noise(
    problem: OutputError, state: State, residuals: Sequence[np.ndarray], levels: Sequence[float], promising: float
) -> list[Part]:
    """Parts without which the linearised model leaves noise, or that share of what is more, the shortest first."""
    k, spans = problem.shared, _spans(problem)
    rows = _rows(problem, state, residuals, levels)
    before = _excess(np.array([np.sum(row[-1] ** 2) for row in rows]), _sizes(problem))
    pieces = []
    for segment, row in zip(problem.segments, rows, strict=True):
        begin, end, count = spans[segment.recording]
        piece = _piece(segment, begin, end, count)
        cuts = np.searchsorted(piece, np.arange(1, count))
        pieces.append([(part @ part.T, part.shape[1]) for part in np.split(row, cuts, axis=1)])
    whole = _reduced([row @ row.T for row in rows], [row.shape[1] for row in rows], k)
    found = []
    for recording, (begin, end, count) in spans.items():
        own = np.array([segment.recording == recording for segment in problem.segments])
        rest = _Reduced(whole.matrix[~own], whole.right[~own], whole.squares[~own], whole.samples[~own])
        length = (end - begin) / count
        for first in range(count):
            for last in range(first + 1, count + 1):
                kept = []
                for i in np.flatnonzero(own):
                    parts = [part for at, part in enumerate(pieces[i]) if not first <= at < last and part[1]]
                    if parts:
                        kept.append((sum(gram for gram, _ in parts), sum(n for _, n in parts)))
                if not kept and np.all(own):
                    continue
                several = _reduced([gram for gram, _ in kept], [n for _, n in kept], k) if kept else None
                both = rest if several is None else _joined(rest, several)
                squares = both.left(both.step())
                if _is_noise(squares, both.samples) or _excess(squares, both.samples) < promising * before:
                    lost = int(whole.samples.sum() - both.samples.sum())
                    part = Part(recording, begin + first * length, begin + last * length, first, last, count)
                    found.append((lost, part))
    found.sort(key=lambda pair: pair[0])
    return [part for _, part in found]


def _confirmed(
    problem: OutputError, state: State, levels: Sequence[float], candidates: Sequence[Part]
) -> tuple[Part, State] | None:
    """The first of some parts that a search confirms, and where it comes to without it."""
    longest = 0.0
    for part in candidates:
        length = sum(np.count_nonzero(part.holds(segment)) for segment in problem.segments)
        if length >= _LONGER * longest or part.whole:
            if (without := _searched(problem, state, levels, part)) is not None:
                return part, without
            longest = float(length)
    return None


def _joined(one: _Reduced, other: _Reduced) -> _Reduced:
    return _Reduced(
        np.concatenate([one.matrix, other.matrix]),
        np.concatenate([one.right, other.right]),
        np.concatenate([one.squares, other.squares]),
        np.concatenate([one.samples, other.samples]),
    )


def _searched(problem: OutputError, state: State, levels: Sequence[float], part: Part) -> State | None:
    """Where a search without that part comes to, if it leaves no more than noise in the rest; else None."""
    k, free = problem.shared, list(problem.free)
    kept = [~part.holds(segment) for segment in problem.segments]
    used = [i for i, mask in enumerate(kept) if np.any(mask)]
    samples = np.array([np.count_nonzero(kept[i]) for i in used])
    before = math.inf
    for taken in range(_STEPS):
        residuals = problem.residuals(state)
        if not all(bool(np.all(np.isfinite(residuals[i]))) for i in used):
            return None
        squares = np.array([np.sum((residuals[i][kept[i]] / levels[i]) ** 2) for i in used])
        if taken >= _FEWEST_STEPS and _is_noise(squares, samples):
            return state
        now = _excess(squares, samples)
        if taken > 1 and now > 0.5 * before and not _is_noise(squares, samples):
            return None
        before = now
        rows = _rows(problem, state, residuals, levels)
        grams = [rows[i][:, kept[i]] @ rows[i][:, kept[i]].T for i in used]
        step = _reduced(grams, samples, k).step()
        values, initial = state.values.copy(), state.initial.copy()
        values[free] += step[: len(free)]
        if problem.bounds is not None:
            values = np.clip(values, *problem.bounds)
        for i, gram in zip(used, grams, strict=True):
            own = slice(k, -1)
            initial[i] += pseudo_inverse(gram[own, own]) @ (gram[own, -1] - gram[own, :k] @ step)
        state = State(values, initial, state.offsets + step[len(free) :])
    return None


def _reached(
    problem: OutputError, residuals: Sequence[np.ndarray], part: Part, recordings: Sequence[Recording]
) -> bool:
    """Whether the rest moves as far as a part does, and where that is driven, as hard at the same frequencies.

    A drive that saturates shows at resonance alone, so that its own recording is no witness for it.
    """
    farthest = [0.0, 0.0]
    for segment, residual in zip(problem.segments, residuals, strict=True):
        inside = part.holds(segment)
        moved = np.abs(segment.response - residual - np.mean(segment.response - residual))
        for place, mask in enumerate((~inside, inside)):
            if np.any(mask):
                farthest[place] = max(farthest[place], float(np.max(moved[mask])) / segment.pace**segment.order)
    if farthest[1] > _ALIKE * farthest[0]:
        return False
    if not any(s.force is not None and np.any(part.holds(s)) for s in problem.segments):
        return True
    own = recordings[part.recording]
    asked = own.slice(*(round((time - own.start) * own.fs) for time in (part.begin, part.end)))
    driven = {s.recording for s in problem.segments if s.force is not None and s.recording != part.recording}
    return any(_drives_as(recordings[other], asked) for other in driven)


def _drives_as(other: Recording, asked: Recording) -> bool:
    """Whether a recording is driven as hard as another, at all of its frequencies."""
    bands = band_of(other), band_of(asked)
    if other.force is None or asked.force is None or bands[0] is None or bands[1] is None:
        return False
    (low, high), (lowest, highest) = bands
    wide = low <= _ALIKE * lowest and highest <= _ALIKE * high
    return wide and float(np.max(np.abs(asked.force))) <= _ALIKE * float(np.max(np.abs(other.force)))

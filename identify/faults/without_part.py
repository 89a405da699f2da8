"""What is left of recordings without a part of one: by one step of the search for every part, by a search for some."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..problem.normal_equations import pseudo_inverse
from ..problem.output_error import OutputError, State
from ..signals.odds import is_noise
from ..signals.registry import budget
from .limits import HALVED
from .part import Part, parts_of, spans_of

_STEPS = budget(8, "steps", why="of the search without a part: a large fault is no small step")
_FEWEST_STEPS = budget(
    2, "steps", why="at least: what leaves no more than noise may yet be some errors from where that is least"
)
_LONGER = budget(1.25, "times as long", why="of parts that a search does not confirm the next one tried")


@dataclass(frozen=True)
class Level:
    """What noise leaves of a segment: its rms, and how many independent values each sample is worth.

    Noise of the force rings in the resonance: in a record of some hundred cycles it takes a few values only.
    """

    size: float
    worth: float


def parts_to_blame(problem: OutputError, state: State, levels: Sequence[Level], promising: float = 0.0) -> list[Part]:
    """Parts without which the linearised model leaves no more than noise, the shortest first.

    Args:
        problem: the model over the segments.
        state: from which one step is taken without each part.
        levels: of each segment's noise, as its response shows it.
        promising: also those that leave no more than this part of what is more than noise now.
    """
    rows = _rows(problem, state, levels)
    whole = _reduced([row @ row.T for row in rows], [row.shape[1] for row in rows], problem.shared)
    enough = promising * _excess(whole.squares_of(rows), whole.samples)
    worth = np.array([level.worth for level in levels])
    found = []
    for span in spans_of(problem.segments):
        own = np.array([segment.recording == span.recording for segment in problem.segments])
        rest, cut = whole.only(~own), []
        for i in np.flatnonzero(own):
            edges = np.searchsorted(span.piece_of(problem.segments[i]), np.arange(1, span.pieces))
            cut.append([(piece @ piece.T, piece.shape[1]) for piece in np.split(rows[i], edges, axis=1)])
        for part in parts_of(span):
            kept = [[piece for at, piece in enumerate(pieces) if not part.first <= at < part.last] for pieces in cut]
            full = np.array([any(n for _, n in pieces) for pieces in kept])
            kept = [pieces for pieces in kept if any(n for _, n in pieces)]
            grams = [np.sum([gram for gram, _ in pieces], axis=0) for pieces in kept]
            samples = [sum(n for _, n in pieces) for pieces in kept]
            if not samples and not rest.samples.size:
                continue
            both = rest.joined(_reduced(grams, samples, problem.shared)) if samples else rest
            left = both.left(both.step())
            used = np.concatenate([worth[~own], worth[own][full]]) * both.samples
            if is_noise(left / both.samples, used) or _excess(left, both.samples) < enough:
                found.append((int(whole.samples.sum() - both.samples.sum()), part))
    found.sort(key=lambda pair: pair[0])
    return [part for _, part in found]


def first_confirmed(
    problem: OutputError, state: State, levels: Sequence[Level], parts: Sequence[Part]
) -> tuple[Part, State] | None:
    """The first of some parts without which a search leaves no more than noise, and where that comes to.

    Args:
        problem, state, levels: as in ``parts_to_blame``.
        parts: the shortest first; of those that fail, the next one tried is longer by some.
    """
    longest = 0.0
    for part in parts:
        length = sum(np.count_nonzero(part.holds(segment)) for segment in problem.segments)
        if length >= _LONGER * longest or part.whole:
            if (without := _searched(problem, state, levels, part)) is not None:
                return part, without
            longest = float(length)
    return None


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

    def only(self, places: np.ndarray) -> _Reduced:
        """Of some segments."""
        return _Reduced(self.matrix[places], self.right[places], self.squares[places], self.samples[places])

    def joined(self, other: _Reduced) -> _Reduced:
        """Of the segments of both."""
        return _Reduced(
            np.concatenate([self.matrix, other.matrix]),
            np.concatenate([self.right, other.right]),
            np.concatenate([self.squares, other.squares]),
            np.concatenate([self.samples, other.samples]),
        )

    @staticmethod
    def squares_of(rows: Sequence[np.ndarray]) -> np.ndarray:
        """(s,) sums of squares of what is left before any step."""
        return np.array([np.sum(row[-1] ** 2) for row in rows])


def _reduced(grams: Sequence[np.ndarray], samples: Sequence[int] | np.ndarray, k: int) -> _Reduced:
    """Of inner products (k + states + 1, ...) of derivatives and residual of each segment."""
    own, keep = slice(k, -1), np.r_[0:k, -1]
    made = np.array(
        [
            gram[np.ix_(keep, keep)] - gram[keep, own] @ pseudo_inverse(gram[own, own]) @ gram[own][:, keep]
            for gram in grams
        ]
    )
    return _Reduced(made[:, :k, :k], made[:, :k, k], made[:, k, k], np.array(samples))


def _rows(problem: OutputError, state: State, levels: Sequence[Level]) -> list[np.ndarray]:
    """Of each segment derivatives and residual in units of its noise: (shared + states + 1, n)."""
    residuals = problem.residuals(state)
    derivatives = problem.derivatives(state, residuals)
    return [np.vstack([d, r]) / v.size for d, r, v in zip(derivatives, residuals, levels, strict=True)]


def _shows_more(rows: Sequence[np.ndarray], levels: Sequence[Level], kept: Sequence[np.ndarray]) -> bool:
    """Whether more than noise is left in the samples that are not kept."""
    return any(
        not is_noise(np.mean(row[-1][~mask] ** 2, keepdims=True), np.array([level.worth * np.count_nonzero(~mask)]))
        for row, level, mask in zip(rows, levels, kept, strict=True)
        if not np.all(mask)
    )


def _excess(squares: np.ndarray, samples: np.ndarray) -> float:
    """What is more than noise, in its squares a sample, where that is most."""
    return float(np.max(squares / samples)) - 1.0


def _searched(problem: OutputError, state: State, levels: Sequence[Level], part: Part) -> State | None:
    """Where a search without that part comes to, if it leaves no more than noise in the rest; else None."""
    k, free = problem.shared, list(problem.free)
    kept = [~part.holds(segment) for segment in problem.segments]
    used = [i for i, mask in enumerate(kept) if np.any(mask)]
    samples = np.array([np.count_nonzero(kept[i]) for i in used])
    worth = np.array([levels[i].worth for i in used]) * samples
    before = math.inf
    for taken in range(_STEPS):
        rows = _rows(problem, state, levels)
        if not all(bool(np.all(np.isfinite(rows[i]))) for i in used):
            return None
        rest = [rows[i][:, kept[i]] for i in used]
        squares = _Reduced.squares_of(rest)
        noise, now = is_noise(squares / samples, worth), _excess(squares, samples)
        if taken >= _FEWEST_STEPS and (noise or now > HALVED * before):
            return state if noise and _shows_more(rows, levels, kept) else None
        before = now
        grams = [row @ row.T for row in rest]
        step = _reduced(grams, samples, k).step()
        values, initial, own = state.values.copy(), state.initial.copy(), slice(k, -1)
        values[free] += step[: len(free)]
        if problem.bounds is not None:
            values = np.clip(values, *problem.bounds)
        for i, gram in zip(used, grams, strict=True):
            initial[i] += pseudo_inverse(gram[own, own]) @ (gram[own, -1] - gram[own, :k] @ step)
        state = State(values, initial, state.offsets + step[len(free) :])
    return None

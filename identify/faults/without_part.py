"""What is left of recordings without a part of one: by one step of the search for every part, by a search for some."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add

import numpy as np

from ..problem.linearised import Linearised
from ..problem.output_error import OutputError, State
from ..signals.noise_spectrum import NoiseSpectrum
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


@dataclass(frozen=True, eq=False)
class Point:
    """Where a search is, and the problem linearised there, sample by sample, in units of each segment's noise."""

    state: State
    linearised: Linearised

    @staticmethod
    def at(problem: OutputError, state: State, levels: Sequence[Level]) -> Point:
        """Of a problem, from one run of each segment."""
        noise = [
            NoiseSpectrum(np.full(s.n // 2 + 1, v.size**2), s.n) for s, v in zip(problem.segments, levels, strict=True)
        ]
        residuals, rows = problem.residuals_with_derivatives(state)
        return Point(state, Linearised.in_time(problem, state, residuals, noise, rows))


def suspect_parts(problem: OutputError, point: Point, levels: Sequence[Level], promising: float = 0.0) -> list[Part]:
    """Parts without which the linearised model leaves no more than noise, the shortest first.

    Args:
        problem: the model over the segments.
        point: from which one step is taken without each part.
        levels: of each segment's noise, as its response shows it.
        promising: also those that leave no more than this part of what is more than noise now.
    """
    linearised = point.linearised
    initial, squares = linearised.initial_rows, np.array([sums.power for sums in linearised.sums])
    count = np.array([sums.samples for sums in linearised.sums])
    enough = promising * _excess(squares, count)
    whole = [sums.without(initial) for sums in linearised.sums]
    worth = np.array([level.worth for level in levels])
    found = []
    for span in spans_of(problem.segments):
        own = np.array([segment.recording == span.recording for segment in problem.segments])
        rest = [whole[i] for i in np.flatnonzero(~own)]
        edges = [
            [0, *np.searchsorted(span.piece_of(segment), np.arange(1, span.pieces)), segment.n] if mine else []
            for segment, mine in zip(problem.segments, own, strict=True)
        ]
        cut = [pieces for pieces in linearised.block(edges) if pieces]
        for part in parts_of(span):
            kept = [[p for at, p in enumerate(pieces) if not part.first <= at < part.last] for pieces in cut]
            full = np.array([any(piece.samples for piece in pieces) for pieces in kept])
            both = [*rest, *(reduce(add, kept[i]).without(initial) for i in np.flatnonzero(full))]
            if not both:
                continue
            step, samples = reduce(add, both).step(), np.array([sums.samples for sums in both])
            left = np.array([sums.left(step) for sums in both])
            used = np.concatenate([worth[~own], worth[own][full]]) * samples
            if is_noise(left / samples, used) or _excess(left, samples) < enough:
                found.append((int(count.sum() - samples.sum()), part))
    found.sort(key=lambda pair: pair[0])
    return [part for _, part in found]


def first_confirmed(
    problem: OutputError, point: Point, levels: Sequence[Level], parts: Sequence[Part]
) -> tuple[Part, State] | None:
    """The first of some parts without which a search leaves no more than noise, and where that comes to.

    Args:
        problem, point, levels: as in ``suspect_parts``.
        parts: the shortest first; of those that fail, the next one tried is longer by some.
    """
    longest = 0.0
    for part in parts:
        length = sum(np.count_nonzero(part.holds(segment)) for segment in problem.segments)
        if length >= _LONGER * longest or part.whole:
            if (without := _searched(problem, point, levels, part)) is not None:
                return part, without
            longest = float(length)
    return None


def _shows_more(whole: Linearised, levels: Sequence[Level], kept: Sequence[np.ndarray]) -> bool:
    """Whether more than noise is left in the samples that are not kept."""
    return any(
        not is_noise(np.mean(left[~mask] ** 2, keepdims=True), np.array([level.worth * np.count_nonzero(~mask)]))
        for left, level, mask in zip(whole.residuals, levels, kept, strict=True)
        if not np.all(mask)
    )


def _excess(squares: np.ndarray, samples: np.ndarray) -> float:
    """What is more than noise, in its squares a sample, where that is most."""
    return float(np.max(squares / samples)) - 1.0


def _searched(problem: OutputError, point: Point, levels: Sequence[Level], part: Part) -> State | None:
    """Where a search without that part comes to, if it leaves no more than noise in the rest; else None."""
    kept = [~part.holds(segment) for segment in problem.segments]
    used = [i for i, mask in enumerate(kept) if np.any(mask)]
    samples = np.array([np.count_nonzero(kept[i]) for i in used])
    worth = np.array([levels[i].worth for i in used]) * samples
    before, state = math.inf, point.state
    for taken in range(_STEPS):
        if taken:
            point = Point.at(problem, state, levels)
        whole = point.linearised
        if not all(bool(np.all(np.isfinite(rows[i]))) for rows in (whole.columns, whole.residuals) for i in used):
            return None
        rest = whole.keeping(kept)
        squares = np.array([rest.sums[i].power for i in used])
        noise, now = is_noise(squares / samples, worth), _excess(squares, samples)
        if taken >= _FEWEST_STEPS and (noise or now > HALVED * before):
            return state if noise and _shows_more(whole, levels, kept) else None
        before = now
        state = state.stepped(problem.free, *rest.step())
        if problem.bounds is not None:
            state = replace(state, values=np.clip(state.values, *problem.bounds))
    return None

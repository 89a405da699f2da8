"""Stretches in which the response jumps with the smallest change of a parameter.

Where friction or a preload holds the mass against a force of about their size, small changes decide whether it breaks
away in this cycle or the next. There the simulated response has no derivative: a difference quotient is a jump over a
small step, and least squares would take it for an immense amount of information. Such stretches are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from .output_error import OutputError, State
from .segments import Segment

#: Writes the difference quotient of a segment's response by a parameter: see ``OutputError.quotients``.
Quotient = Callable[[int, int, np.ndarray], None]
#: Forward and backward differences that disagree by more than this part of their size are no derivative.
_DISAGREE = 0.3
#: ... but not where they are this small a part of the parameter's largest effect in the segment.
_SMALL = 1e-3
#: ... nor where doubling the parameter would move the response by less than this part of it.
_VISIBLE = 1e-6
_SHORTEST_CYCLES = 10.0
#: What is too short to be cut is kept whole where what jumps holds less than this part of the information on each
#: parameter: no standard error is then off by more than half of it.
_FALSE_INFORMATION = 0.01
#: A recording without noise is exact to this part of it.
_ROUNDING = 1e-12
#: Samples that are looked at together.
_AT_ONCE = 2**16


def smooth_stretches(problem: OutputError, state: State) -> tuple[tuple[Segment, ...], State]:
    """The segments without the stretches that jump, and a state to go on from.

    Of each segment the longest smooth stretch of at least ten cycles is kept; where that is not all of it, its initial
    state is taken from the simulation. A segment of fewer cycles, as of a hammer's blow, which alone tells the mass, is
    kept whole where its jumps say next to nothing. Where nothing smooth is left at all, everything stays as it was.
    """
    if not problem.free:
        return problem.segments, state
    sizes = np.maximum(np.abs(state.values[list(problem.free)]), problem.scale[list(problem.free)])
    residuals = problem.residuals(state)
    ways = problem.quotients(state, residuals), problem.quotients(state, residuals, backward=True)
    jumps, false, told = zip(*(_of_segment(problem, i, ways, sizes) for i in range(len(problem.segments))), strict=True)
    say_little = np.all(np.array(false) <= _FALSE_INFORMATION * np.sum(told, axis=0), axis=1)
    kept: list[Segment] = []
    initial: list[np.ndarray] = []
    for i, segment in enumerate(problem.segments):
        cycle = _cycle_of(segment)
        begin, end = _longest(~jumps[i])
        if (begin == 0 and end == segment.n) or (say_little[i] and segment.n < _SHORTEST_CYCLES * cycle):
            kept.append(segment)
            initial.append(state.initial[i])
        elif end - begin >= _SHORTEST_CYCLES * cycle:
            kept.append(segment.part(begin, end))
            along = problem.states(i, state) if begin else None
            initial.append(state.initial[i] if along is None else problem.core.initial(along[begin]))
    if not kept:
        return problem.segments, state
    return tuple(kept), replace(state, initial=np.array(initial))


def _cycle_of(segment: Segment) -> int:
    return max(3, round(2 * np.pi / segment.pace / segment.dt))


def _of_segment(
    problem: OutputError, i: int, ways: tuple[Quotient, Quotient], sizes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(n,) where any parameter's derivative jumps, and (k,) each one's information there and elsewhere."""
    segment = problem.segments[i]
    largest = float(np.max(np.abs(segment.response)))
    visible, noise = _VISIBLE * largest / sizes, max(segment.noise, _ROUNDING * largest)

    def of_parameter(k: int) -> tuple[np.ndarray, float, float]:
        both = np.empty((2, segment.n))
        for way, quotient in zip(ways, both, strict=True):
            way(i, k, quotient)
        found = _jumps(both[0], both[1], _cycle_of(segment), float(visible[k]))
        informs = np.max(np.abs(both), axis=0) / noise
        return found, float(np.sum(informs[found] ** 2)), float(np.sum(informs[~found] ** 2))

    jumps, false, told = zip(*problem.map(of_parameter, range(len(sizes))), strict=True)
    return np.any(jumps, axis=0), np.array(false), np.array(told)


def _jumps(forward: np.ndarray, backward: np.ndarray, cycle: int, visible: float) -> np.ndarray:
    """(n,) whether a parameter's derivative (n,) is none there, to within half a cycle.

    Below ``visible`` a difference is rounding.
    """
    from scipy.ndimage import maximum_filter1d

    def size(of: slice) -> tuple[np.ndarray, np.ndarray]:
        return np.abs(forward[of]), np.abs(backward[of])

    jumps = np.empty(forward.size, bool)
    parts = [slice(begin, begin + _AT_ONCE) for begin in range(0, forward.size, _AT_ONCE)]
    floor = _SMALL * max(float(np.max(np.minimum(*size(part)))) for part in parts) + visible
    for part in parts:
        first = max(0, part.start - cycle)
        wide = slice(first, part.stop + cycle)
        apart = maximum_filter1d(np.abs(forward[wide] - backward[wide]), cycle)
        largest = maximum_filter1d(np.maximum(*size(wide)), cycle)
        largest *= _DISAGREE
        largest += floor
        own = slice(part.start - first, part.stop - first)
        jumps[part] = apart[own] > largest[own]
    return jumps


def _longest(good: np.ndarray) -> tuple[int, int]:
    """Start and end of the longest run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]])))
    if edges.size == 0:
        return 0, 0
    starts, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - starts))
    return int(starts[longest]), int(ends[longest])


def left_out(before: Sequence[Segment], after: Sequence[Segment], names: Sequence[str]) -> list[str]:
    """One sentence for each recording of which a stretch was left out."""
    sentences = []
    for index, name in enumerate(names):
        had = sum(s.n * s.dt for s in before if s.recording == index)
        has = sum(s.n * s.dt for s in after if s.recording == index)
        if has < had:
            sentences.append(
                f"{name}: {had - has:.3g} of {had:.3g} s were left out, because there small changes decide whether "
                "friction or preload hold the mass; a larger force would make them useful"
            )
    return sentences

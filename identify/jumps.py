"""Stretches in which the response jumps with the smallest change of a parameter.

Where friction or a preload holds the mass against a force of about their size, a hair decides whether it breaks away in
this cycle or the next. There the simulated response has no derivative: a difference quotient is a jump over a small
step, and least squares would take it for an immense amount of information. Such stretches are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .output_error import OutputError, State
from .segments import Segment

#: Forward and backward differences that disagree by more than this part of their size are no derivative.
_DISAGREE = 0.3
#: ... but not where they are this small a part of the parameter's largest effect in the segment.
_SMALL = 1e-3
#: ... nor where doubling the parameter would move the response by less than this part of it.
_VISIBLE = 1e-6
_SHORTEST_CYCLES = 10.0
#: Samples that are looked at together.
_AT_ONCE = 2**16


def smooth_stretches(problem: OutputError, state: State) -> tuple[tuple[Segment, ...], State]:
    """The segments without the stretches that jump, and a state to go on from.

    Of each segment the longest smooth stretch of at least ten cycles is kept; where that is not all of it, its initial
    state is taken from the simulation. Where nothing smooth is left at all, everything stays as it was.
    """
    residuals = problem.residuals(state)
    ways = problem.quotients(state, residuals), problem.quotients(state, residuals, backward=True)
    kept: list[Segment] = []
    initial: list[np.ndarray] = []
    for i, segment in enumerate(problem.segments):
        cycle = max(3, round(2 * np.pi / segment.pace / segment.dt))
        sizes = np.maximum(np.abs(state.values[list(problem.free)]), problem.scale[list(problem.free)])
        visible = _VISIBLE * float(np.max(np.abs(segment.response))) / sizes

        def jumping(k: int, i: int = i, cycle: int = cycle, visible: np.ndarray = visible) -> np.ndarray:
            both = np.empty((2, problem.segments[i].n))
            for way, quotient in zip(ways, both, strict=True):
                way(i, k, quotient)
            return _jumps(both[0], both[1], cycle, float(visible[k]))

        jumps = np.zeros(segment.n, bool)
        for found in problem.map(jumping, range(len(problem.free))):
            jumps |= found
        begin, end = _longest(~jumps)
        if begin == 0 and end == segment.n:
            kept.append(segment)
            initial.append(state.initial[i])
        elif end - begin >= _SHORTEST_CYCLES * cycle:
            kept.append(segment.part(begin, end))
            along = problem.states(i, state) if begin else None
            initial.append(state.initial[i] if along is None else problem.core.initial(along[begin]))
    if not kept:
        return problem.segments, state
    return tuple(kept), replace(state, initial=np.array(initial))


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
                f"{name}: {had - has:.3g} of {had:.3g} s were left out, because there a hair decides whether "
                "friction or preload hold the mass; a larger force would make them useful"
            )
    return sentences

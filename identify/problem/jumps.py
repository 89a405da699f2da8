"""Stretches in which the response jumps with the smallest change of a parameter.

Where friction or a preload holds the mass against a force of about their size, small changes decide whether it breaks
away in this cycle or the next. There the derivative of the response says nothing of the step that a fit would take, and
least squares would go where it does not lead. Such stretches are left out: those in which two runs with all parameters
moved a little, forward and backward, tell of other derivatives than each other or than the tangent: where a mass lets
go or not by less than that little, the tangent is that of a jump, and its information is none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ..signals.registry import numerics
from .jump_sides import put_on_same_sides
from .limits import DISAGREE, FALSE_INFORMATION, FEWEST_SWINGS
from .output_error import OutputError, State
from .segments import Segment

_STEP = numerics(1e-5, "of a value or its size", why="by which parameters are moved: the core is smooth to 1e-12")
_SMALL = numerics(1e-3, "part of the largest effect in the segment", why="a difference below it is none")
_VISIBLE = numerics(1e-6, "part of the response", why="less by twice the parameters is rounding")
_ROUNDING = numerics(1e-12, "part of a recording", why="one without noise is exact to it")


def smooth_stretches(
    problem: OutputError, state: State, *, tangent_alone: bool = False
) -> tuple[tuple[Segment, ...], State]:
    """The segments without the stretches that jump, and a state to go on from.

    ``tangent_alone``: whether only those count in which the tangent is that of a jump, and no run near it tells of it.

    Of each segment that smooth stretch of at least ``FEWEST_SWINGS`` cycles is kept which tells most of the parameters
    (a rest, however long, tells nothing); where that is not all of it, its initial state is taken from the simulation.
    A segment of fewer cycles, as of a hammer's blow, which alone says the mass, is kept whole where its jumps say next
    to nothing. Where nothing smooth is left at all, everything stays as it was.
    """
    if not problem.free:
        return problem.segments, state
    free = list(problem.free)
    sizes = np.maximum(np.abs(state.values[free]), problem.scale[free])
    rows = problem.residuals_with_derivatives(state, single=True)[1]
    found = problem.map(
        lambda i: _of_segment(problem, i, state, rows[i], sizes, tangent_alone), range(len(problem.segments))
    )
    stretches, false, information = zip(*found, strict=True)
    say_little = np.all(np.array(false) <= FALSE_INFORMATION * np.sum(information, axis=0), axis=1)
    kept: list[Segment] = []
    initial: list[np.ndarray] = []
    for i, segment in enumerate(problem.segments):
        cycle = segment.cycle
        begin, end = stretches[i]
        if (begin == 0 and end == segment.n) or (say_little[i] and segment.n < FEWEST_SWINGS * cycle):
            kept.append(segment)
            initial.append(state.initial[i])
        elif end - begin >= FEWEST_SWINGS * cycle:
            kept.append(segment.part(begin, end))
            along = problem.states(i, state) if begin else None
            initial.append(state.initial[i] if along is None else problem.core.initial(along[begin]))
    if not kept:
        return problem.segments, state
    return tuple(kept), replace(state, initial=np.array(initial))


def _of_segment(
    problem: OutputError, i: int, state: State, rows: np.ndarray, sizes: np.ndarray, tangent_alone: bool
) -> tuple[tuple[int, int], np.ndarray, np.ndarray]:
    """The stretch to keep of a segment, and (k,) each parameter's information where the response's derivative along all
    of them jumps, and elsewhere."""
    segment = problem.segments[i]
    own = problem.sides(i)
    base = problem.simulate(i, state, sides=own)

    def quotient(step: float) -> np.ndarray:
        values = state.values.copy()
        values[list(problem.free)] += step * sizes
        sides = problem.sides(i)
        moved = problem.simulate(i, replace(state, values=values), sides=sides)
        if own is not None and sides is not None:  # a jump that passes a sample is no derivative
            put_on_same_sides(base, own, moved, sides)
        moved -= base
        moved /= step
        return np.nan_to_num(moved, copy=False, posinf=0.0, neginf=0.0)

    with np.errstate(invalid="ignore"):  # where it does not simulate to its end
        ahead, back = quotient(_STEP), quotient(-_STEP)
    largest = float(np.max(np.abs(segment.response)))
    tangent = sizes @ rows[: len(sizes)]
    apart = np.minimum(np.abs(tangent - ahead), np.abs(tangent - back))
    if not tangent_alone:
        np.maximum(apart, np.abs(ahead - back), out=apart)
    del tangent
    effect = np.maximum(np.abs(ahead, out=ahead), np.abs(back, out=back), out=ahead)
    del back
    for row, size in zip(rows, sizes, strict=False):  # behind them those of offsets and initial states
        np.maximum(effect, np.abs(row) * row.dtype.type(size), out=effect)
    found = _jumps(apart, effect, segment.cycle, _VISIBLE * largest)
    power = max(segment.noise, _ROUNDING * largest) ** 2
    there, whole = (
        np.array([np.sum(np.square(row[where], dtype=float)) for row in rows[: len(sizes)]]) / power
        for where in (found, slice(None))
    )
    return _most_telling(~found, rows[: len(sizes)], FEWEST_SWINGS * segment.cycle), there, whole - there


def _jumps(apart: np.ndarray, effect: np.ndarray, cycle: int, visible: float) -> np.ndarray:
    """(n,) whether derivatives forward and backward are so far apart, (n,), beside what the parameters do there, (n,),
    that they are none, to within half a cycle; in the memory of both.

    Below ``visible`` a difference is rounding.
    """
    from scipy.ndimage import maximum_filter1d

    floor = _SMALL * float(np.max(effect)) + visible
    maximum_filter1d(apart, cycle, output=apart)
    maximum_filter1d(effect, cycle, output=effect)
    effect *= DISAGREE
    effect += floor
    return apart > effect


def _most_telling(good: np.ndarray, rows: Iterable[np.ndarray], fewest: float) -> tuple[int, int]:
    """Start and end of that run of True, among those of so many samples, that has most of what each row (n,) tells.

    Of rows that tell nothing, and where all runs are shorter, it is the longest.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]])))
    if edges.size == 0:
        return 0, 0
    starts, ends = edges[::2], edges[1::2]
    lengths = ends - starts
    told = np.zeros(starts.size)
    for row in rows:
        telling = np.concatenate([[0.0], np.cumsum(np.square(row, dtype=float))])
        told += (telling[ends] - telling[starts]) / max(float(telling[-1]), np.finfo(float).tiny)
    best = int(np.lexsort((lengths, told, lengths >= fewest))[-1])
    return int(starts[best]), int(ends[best])


def left_out(before: Sequence[Segment], after: Sequence[Segment], names: Sequence[str]) -> list[str]:
    """One sentence for each recording of which a stretch was left out."""
    sentences = []
    for index, name in enumerate(names):
        had = sum(s.n * s.dt for s in before if s.recording == index)
        has = sum(s.n * s.dt for s in after if s.recording == index)
        if has < had:
            driven = any(s.force is not None for s in before if s.recording == index)
            larger = "; a larger force would make them useful" if driven else ""
            sentences.append(
                f"{name}: {had - has:.3g} of {had:.3g} s were left out, because there small changes decide whether "
                f"friction or preload hold the mass{larger}"
            )
    return sentences

"""Which part of the recordings all the rest contradicts: without it one model tells everything else to its noise.

A lie of a measuring chain begins and ends somewhere, or is in one recording. So every stretch of every recording is
left out in turn, from the normal equations alone (one step of the search without it; Cook 1977), and of those without
which no more than noise is left anywhere the shortest is confirmed by a search. By how much the parameters move then is
what that part may have done to them. What the family lacks leaves more than noise in the rest as well, unless nothing
else goes as far or is driven as hard: that is distinguished where recordings overlap, and said where they do not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...recording.recording import Recording
from ..fit.reported_result import Fit
from ..motion.excitation import band_of
from ..problem.data import equivalent_resonance, expected_noise
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..signals.odds import is_noise
from ..signals.signals import noise_levels
from .fitted_problem import fitted_problem
from .limits import ALIKE, PROMISING
from .part import Part, spans_of
from .without_part import Level, Point, first_confirmed, suspect_parts


@dataclass(frozen=True, eq=False)
class Contradiction:
    """A part of a recording that the rest contradicts, or that and another of which either may be right.

    Attributes:
        part: the shortest without which no more than noise is left.
        other: one apart from it that might as well be left out; None where there is none.
        shifts: (free,) each, by how much the parameters move without it, and without the other where there is one.
        reached: whether the rest moves as far and as little, and is driven as hard at the same frequencies, so that it
            would show physics that the family lacks as well.
        state: of the fitted problem (``fitted_problem``) without the part.
        left: what is left of each segment (n,) there, in the part too.
        levels: of the noise of each segment, as its response shows it.
    """

    part: Part
    other: Part | None
    shifts: tuple[np.ndarray, ...]
    reached: bool
    state: State
    left: tuple[np.ndarray, ...]
    levels: tuple[float, ...]


def contradiction(fit: Fit, recordings: Sequence[Recording]) -> Contradiction | None:
    """The part that the rest contradicts; None where no more than noise is left, or no single part is the cause.

    Args:
        fit: of these recordings.
        recordings: as they were fitted.
    """
    problem, state = fitted_problem(fit, recordings)
    residuals = problem.residuals(state)
    if not problem.free or not all(bool(np.all(np.isfinite(r))) for r in residuals):
        return None
    values = dict(zip(fit.oscillator.parameters(), map(float, state.values), strict=True))
    levels = [_level(segment, values, recordings) for segment in problem.segments]
    squares = np.array([np.mean((r / level.size) ** 2) for r, level in zip(residuals, levels, strict=True)])
    worth = np.array([level.worth * segment.n for segment, level in zip(problem.segments, levels, strict=True)])
    if is_noise(squares, worth):
        return None
    point = Point.at(problem, state, levels)
    parts = suspect_parts(problem, point, levels, PROMISING)
    first = first_confirmed(problem, point, levels, parts)
    if first is None:
        return None
    # seen from there, where nothing is far off any more, the part has its true length
    there = Point.at(problem, first[1], levels)
    nearer = [part for part in suspect_parts(problem, there, levels) if not part.apart_from(first[0])]
    part, without = first_confirmed(problem, there, levels, nearer) or first
    apart = [other for other in parts if other.apart_from(part)]
    # another gain of the whole is no small step either, and two that disagree do not say which of them is right
    apart += [whole for span in spans_of(problem.segments) if (whole := Part(span, 0, span.pieces)).apart_from(part)]
    left = problem.residuals(without)
    if not _stands_out(problem.segments, left, part, levels):
        return None
    second = first_confirmed(problem, point, levels, part.other_side) or first_confirmed(problem, point, levels, apart)
    indices = list(problem.free)
    points = [without] if second is None else [without, second[1]]
    return Contradiction(
        part,
        None if second is None else second[0],
        tuple(point.values[indices] - state.values[indices] for point in points),
        _reached(problem, left, part, recordings),
        without,
        left,
        tuple(level.size for level in levels),
    )


def _stands_out(
    segments: Sequence[Segment], residuals: Sequence[np.ndarray], part: Part, levels: Sequence[Level]
) -> bool:
    """Whether more is left in a part than in any other segment: noise of a colour is more than its highest frequencies
    tell, and is so in other segments as well.
    """
    inside, rest = [], [1.0]
    for segment, residual, level in zip(segments, residuals, levels, strict=True):
        squares, held = (residual / level.size) ** 2, part.holds(segment)
        if np.any(held):
            inside.append((float(np.mean(squares[held])), level.worth * int(np.sum(held))))
        else:
            rest.append(float(np.mean(squares)))
    squares, worth = np.array(inside).T
    return not is_noise(squares / max(rest), worth)


def _level(segment: Segment, values: Mapping[str, float], recordings: Sequence[Recording]) -> Level:
    """What noise leaves of a segment; its lines are independent, each as large as the spectrum says."""
    sensor, force = noise_levels(recordings[segment.recording])
    size = expected_noise(segment, values, sensor, force)
    if segment.force is None or not force > 0:
        return Level(size, 1.0)
    density = sensor**2 + (force / values["mass"]) ** 2 * equivalent_resonance(segment, values)
    return Level(size, float(np.mean(density) ** 2 / np.mean(density**2)))


def covering(fit: Fit, shifts: Sequence[np.ndarray]) -> Fit:
    """The fit with standard errors that cover shifts (free,) of its values: what a part may have done to them."""
    covariance = fit.covariance + sum(np.outer(shift, shift) for shift in shifts)
    known = fit.oscillator.parameters()
    wider = {
        name: replace(known[name], std=math.sqrt(variance))
        for name, variance in zip(fit.names, np.diag(covariance), strict=True)
        if known[name].std is not None
    }
    return replace(fit, covariance=covariance, oscillator=fit.oscillator.with_parameters(wider))


def _reached(
    problem: OutputError, residuals: Sequence[np.ndarray], part: Part, recordings: Sequence[Recording]
) -> bool:
    """Whether the rest moves as far and as little as a part does, and where that is driven, as hard at the same
    frequencies.

    What friction or a clearance does shows where the motion is small: the rest goes down to its usual size. A drive
    that saturates shows at resonance alone, so that its own recording is no witness for it.
    """
    sizes: tuple[list[float], list[float]] = ([], [])  # of each cycle of the rest and of the part
    for segment, residual in zip(problem.segments, residuals, strict=True):
        inside = part.holds(segment)
        moved = np.abs(segment.response - residual - np.mean(segment.response - residual))
        cycle = max(1, round(2 * np.pi / (segment.pace * segment.dt)))
        for first in range(0, segment.n, cycle):
            size = float(np.max(moved[first : first + cycle])) / segment.pace**segment.order
            sizes[bool(np.any(inside[first : first + cycle]))].append(size)
    rest, own = sizes
    if not rest or max(own) > ALIKE * max(rest) or min(rest) > ALIKE * np.median(own):
        return False
    if not any(s.force is not None and np.any(part.holds(s)) for s in problem.segments):
        return True
    own = recordings[part.recording]
    asked = own.slice(*(round((time - own.start) * own.fs) for time in (part.begin, part.end)))
    driven = {s.recording for s in problem.segments if s.force is not None and s.recording != part.recording}
    return any(_drives_as(recordings[other], asked) for other in driven)


def _drives_as(other: Recording, asked: Recording) -> bool:
    """Whether a recording is driven as hard as another, at all of its frequencies."""
    has, needs = band_of(other), band_of(asked)
    if other.force is None or asked.force is None or has is None or needs is None:
        return False
    wide = has[0] <= ALIKE * needs[0] and needs[1] <= ALIKE * has[1]
    return wide and float(np.max(np.abs(asked.force))) <= ALIKE * float(np.max(np.abs(other.force)))

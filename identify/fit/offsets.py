"""What a sensor shows at zero: a nuisance of each recording, fitted with the parameters where the motion asks for it.

The zero of a record is a setting of an amplifier and no physics. It stands beside the model, in ``Fit.offsets``, and
costs the parameters what it must.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...model import Oscillator
from ...recording.recording import Recording
from ..motion.blows import ContactForce
from ..problem.data import Data, noise_at
from ..problem.linearised import Linearised
from ..problem.offset import FEELER, FoundOffset, Offset, centre, drift_of, zero_of_load_cell
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.odds import BEYOND_ERRORS

#: Laws that move the zero themselves: beside them an offset would be the same thing twice.
_SAME_THING = ("sensor-offset", "constant-force")


def zeros_of(data: Data, recordings: Sequence[Recording], model: Oscillator) -> tuple[Offset, ...]:
    """What the sensors of each recording may show at zero: the response's, and the force's where its signal says so."""
    return (*response_offsets(data, recordings, model), *force_offsets(data, recordings, model))


def response_offsets(data: Data, recordings: Sequence[Recording], model: Oscillator) -> tuple[Offset, ...]:
    """The offset of each recording that is fitted, where the model has no law that stands for it.

    A slide has none: without a spring no place is the middle, and an offset times a spring that is hardly there would
    be a load.
    """
    if any(term.law.effect in _SAME_THING for term in model.terms):
        return ()
    used = sorted({segment.recording for segment in data.segments if not segment.slide})
    offsets = []
    for index in used:
        recording = recordings[index]
        guess = centre(np.asarray(recording.response, float), recording.fs, data.scales.omega)
        offsets.append(Offset.of(recordings, index, "response", guess=guess))
    return tuple(offsets)


def force_offsets(data: Data, recordings: Sequence[Recording], model: Oscillator) -> tuple[Offset, ...]:
    """The offset of each load cell whose signal is not centred about zero; a load on the mass looks the same.

    A hammer's force is taken about its zero already. Where a law stands for a load there is none.
    """
    if any(term.law.effect in _SAME_THING for term in model.terms):
        return ()
    driven = sorted(
        {s.recording for s in data.segments if s.force is not None and not isinstance(s.force, ContactForce)}
    )
    offsets = []
    for index in driven:
        force = np.asarray(recordings[index].force, float)
        zero = zero_of_load_cell(force, recordings[index].fs, data.scales.omega)
        if zero:
            offsets.append(Offset.of(recordings, index, "force", guess=zero))
    return tuple(offsets)


def kept_offsets(problem: OutputError, state: State, start: Oscillator) -> tuple[OutputError, State]:
    """The problem with the offsets that stand out of their errors alone, the others zero from here on; and drifts.

    Drifts come first, for beside one that is left in the residual nothing stands out. The force's are judged next:
    what a load cell shows at zero moves the mass of a linear rig just as far as its own sensor's offset seems to, and
    of two that cannot be distinguished the response's stays.
    """
    problem, state = _with_drifts(problem, state, start)
    problem, state = _without_those_of_chance(problem, state, start, "force")
    return _without_those_of_chance(problem, state, start, "response")


def _without_those_of_chance(
    problem: OutputError, state: State, start: Oscillator, channel: str
) -> tuple[OutputError, State]:
    if not any(offset.channel == channel for offset in problem.offsets):
        return problem, state
    judged, residuals = _simulating(problem, state)
    free = len(problem.free)
    sums = Linearised.of(judged, state, residuals, noise_at(judged, residuals, state, start)).shared
    errors = sums.errors()[free:]
    asked = np.array([offset.channel == channel for offset in problem.offsets])
    drifting = {offset.recording for offset in problem.offsets if offset.channel == "drift"}
    beside = np.array([offset.recording in drifting and offset.channel == "response" for offset in problem.offsets])
    stays = ~asked | beside | (np.abs(state.offsets) > BEYOND_ERRORS * errors)
    if np.all(stays):
        return problem, state
    # the others take over what those that go have shown: the maximum of the likelihood under that they are zero
    kept, gone = np.flatnonzero(stays), np.flatnonzero(~stays)
    within = np.concatenate([np.arange(free), free + kept]).astype(int)
    follows = -sums.reduction(within)[:, within]
    shift = (state.offsets[gone] @ follows)[free:] if channel == "force" else np.zeros(kept.size)
    offsets = state.offsets[kept] + shift
    return problem.with_offsets([problem.offsets[i] for i in kept]), replace(state, offsets=offsets)


def _with_drifts(problem: OutputError, state: State, start: Oscillator) -> tuple[OutputError, State]:
    """The problem with a drift of each recording whose residual asks for one, by the score at none (Rao 1948).

    It moves the zero where that is free: where a law stands for the zero there is no drift either. A drift needs the
    offset beside it, so the offsets of its recording come with it. A spring that is stiffer on one side moves the
    middle of the motion too, but with its size: a drift goes on beside that.
    """
    if any(term.law.effect in _SAME_THING for term in start.terms):
        return problem, state
    judged, residuals = _simulating(problem, state)
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return problem, state
    added: list[Offset] = []
    known = {offset.recording for offset in problem.offsets if offset.channel == "drift"}
    for index in sorted({segment.recording for segment in problem.segments} - known):
        parts = [(s, r) for s, r in zip(problem.segments, residuals, strict=True) if s.recording == index]
        begin, end = parts[0][0].time, parts[-1][0].time + parts[-1][0].n * parts[-1][0].dt
        size = FEELER * float(np.std(np.concatenate([s.response for s, _ in parts])))
        if not any((o.recording, o.channel) == (index, "response") for o in problem.offsets):
            added.append(Offset(index, "response", size))
        added.append(Offset(index, "drift", size / (end - begin), middle=0.5 * (begin + end)))
    if not added:
        return problem, state
    tried = judged.with_offsets([*problem.offsets, *added])
    point = replace(state, offsets=np.concatenate([state.offsets, np.zeros(len(added))]))
    straight = [r - _line(r) for r in residuals]
    noise = noise_at(judged, straight, state, start)
    linearised = Linearised.of(tried, point, residuals, noise)
    step, errors = linearised.step()[0], linearised.shared.errors()
    first = len(problem.free)
    stands = {
        tried.offsets[i].recording
        for i in range(len(tried.offsets))
        if tried.offsets[i].channel == "drift"
        and tried.offsets[i].recording not in known
        and abs(step[first + i]) > BEYOND_ERRORS * errors[first + i]
    }
    pace = start.omega0.value
    stands = {index for index in stands if _goes_on(index, problem.segments, residuals, pace)}
    chosen = [i for i, o in enumerate(tried.offsets) if i < len(problem.offsets) or o.recording in stands]
    if not stands:
        return problem, state
    moved = [float(point.offsets[i] + step[first + i]) for i in chosen]
    return problem.with_offsets([tried.offsets[i] for i in chosen]), replace(state, offsets=np.array(moved))


def _goes_on(index: int, segments: Sequence[Segment], residuals: Sequence[np.ndarray], omega: float) -> bool:
    """Whether the middle of what a recording leaves moves with time, and not just with the size of the motion."""
    own = [(s, r) for s, r in zip(segments, residuals, strict=True) if s.recording == index]
    drift = drift_of([(s.time, s.dt, s.response, r) for s, r in own], omega)
    return drift is None or drift != 0.0


def _line(residual: np.ndarray) -> np.ndarray:
    """The straight line through (n,) samples, which a drift is not to be weighted by."""
    place = np.linspace(-1.0, 1.0, residual.size)
    return np.mean(residual) + place * (place @ residual) / (place @ place)


def _simulating(problem: OutputError, state: State) -> tuple[OutputError, tuple[np.ndarray, ...]]:
    """The problem, or where no simulation runs to its end its prediction over a cycle, and the residuals."""
    residuals = problem.residuals(state)
    if all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return problem, residuals
    judged = problem.predicting(1.0)
    return judged, judged.residuals(state)


def found_offsets(
    problem: OutputError, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]
) -> tuple[FoundOffset, ...]:
    """The problem's offsets with their standard errors, at the maximum of the likelihood."""
    if not problem.offsets:
        return ()
    errors = Linearised.of(problem, state, residuals, noise).shared.errors()[len(problem.free) :]
    return tuple(
        FoundOffset(offset.recording, offset.channel, float(value), float(error), offset.middle)
        for offset, value, error in zip(problem.offsets, state.offsets, errors, strict=True)
    )

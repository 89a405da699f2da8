"""Which faults what is left over asks for: the score of each (Rao 1948), beside what the model could do about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..problem.chain import Fault, sizes_of
from ..problem.linearised import Linearised, Sums
from ..problem.output_error import OutputError, State
from ..problem.prediction import FREE
from ..problem.segments import Segment
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.registry import budget, numerics
from .fault import Clock, ForceGain, ForceHum, Hum, Late, ResponseGain, ZeroStep
from .wavering import Wavering, waves_of_time

_WIDTH = numerics(16, "bins", why="what a line of hum has under its window")

#: What leaves a recording that agrees with a rig: with more or less mass, friction or stiffness than the others'.
OF_A_WHOLE: tuple[type[Fault], ...] = (ResponseGain, ForceGain, Late, Clock)
#: All kinds.
KINDS: tuple[type[Fault], ...] = (*OF_A_WHOLE, Hum, ForceHum, ZeroStep, Wavering)

TIMES = numerics(
    24,
    "times in a recording",
    why="at which a fault that begins somewhere is looked for; from the best one the search goes on",
)
_LINES = budget(3, "lines in a recording", why="the loudest of what is left; hum has one, and its harmonics some more")
_WAVES = numerics(
    (1, 2, 3, 4, 5, 6), "cycles in a record", why="the slowest waves of a clock; faster ones are lines, as hum is"
)
OWN = numerics(
    1e-8, "part of the power of a fault", why="rounding: less than this cannot be told from what the parameters do"
)


def possible(
    segments: Sequence[Segment], residuals: Sequence[np.ndarray], kinds: Sequence[type[Fault]] = KINDS
) -> list[Fault]:
    """Every fault that is looked for: of each recording every kind, everywhere.

    Args:
        segments: of the recordings.
        residuals: what a model leaves of each (n,).
        kinds: that are looked for.
    """
    faults: list[Fault] = []
    recordings = sorted({segment.recording for segment in segments})
    for recording in recordings:
        own = [(s, r) for s, r in zip(segments, residuals, strict=True) if s.recording == recording]
        first, last = own[0][0], own[-1][0]
        # also from the beginning on: the whole recording may have another gain than the others
        span = last.time + last.n * last.dt - first.time
        times = first.time + np.linspace(0.0, span, TIMES, endpoint=False)
        driven = any(segment.force is not None for segment, _ in own)
        longest = max(own, key=lambda pair: pair[0].n)
        for kind in kinds:
            if kind.forced and not driven:
                continue
            if kind.timed:
                faults += [kind(recording, float(time)) for time in times]
            elif kind.slow:
                faults += [kind(recording, waves / span) for waves in _WAVES]
                faults += [kind(recording, hertz) for hertz in waves_of_time(longest[1], longest[0])]
            elif kind.tonal:
                faults += [kind(recording, hertz) for hertz in lines(longest[1], longest[0].dt)]
            elif len(recordings) > 1 or kind.forced:  # the clock of a single recording is the only one
                faults.append(kind(recording))
    return faults


def lines(residual: np.ndarray, dt: float) -> list[float]:
    """Frequencies, Hz, of the largest lines of what is left (n,), each to a part of its width."""
    window = np.hanning(residual.size)
    padded = 4 * residual.size
    spectrum = np.abs(np.fft.rfft((residual - np.mean(residual)) * window, padded))
    spectrum[: 4 * 3] = 0.0  # three cycles in the record are a drift rather than a line
    found = []
    for _ in range(_LINES):
        top = int(np.argmax(spectrum[1:-1])) + 1
        left, middle, right = np.log(np.maximum(spectrum[top - 1 : top + 2], np.finfo(float).tiny))
        curved = left - 2.0 * middle + right
        found.append(float((top + (0.5 * (left - right) / curved if curved < 0 else 0.0)) / (padded * dt)))
        spectrum[max(top - _WIDTH, 0) : top + _WIDTH] = 0.0
    return found


def expected_gains(
    problem: OutputError,
    state: State,
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum],
    faults: Sequence[Fault],
) -> np.ndarray:
    """(faults,) gain of log-likelihood that the linearised response expects of each fault alone.

    Parameters, offsets and initial states may take over what they can.

    Args:
        problem: the model over the segments.
        state: its best point.
        residuals: there.
        noise: by which they are weighted.
        faults: that are asked for.
    """
    linearised = Linearised.of(problem, state, residuals, noise, single=False)
    k, gains = problem.shared, []
    for fault in faults:
        beside = beside_fault(linearised, problem, state, residuals, noise, fault)
        asked = beside.without(slice(k))
        # what the parameters can do themselves is no fault's
        before = np.maximum(np.diag(beside.normal)[k:], np.finfo(float).tiny)
        gains.append(asked.gain() if np.all(np.diag(asked.normal) > OWN * before) else 0.0)
    return np.array(gains)


def beside_fault(
    linearised: Linearised,
    problem: OutputError,
    state: State,
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum],
    fault: Fault,
) -> Sums:
    """The sums over all segments with the sizes of one fault as further columns, behind what segments share."""
    faulty = problem.with_faults([fault])
    point = with_sizes(faulty, state)
    columns = {
        i: noise[i].lines(_columns(faulty, point, i, segment.response - residuals[i]))
        for i, segment in enumerate(problem.segments)
        if segment.recording == fault.recording
    }
    return linearised.beside(columns)


def _columns(faulty: OutputError, point: State, index: int, base: np.ndarray) -> np.ndarray:
    """(sizes, n) derivatives of what is shown along one segment with respect to the sizes of the last fault."""
    columns = []
    for place in range(len(faulty.offsets) - faulty.faults[-1].count, len(faulty.offsets)):
        by = 1e-2 * faulty.offsets[place].scale
        offsets = point.offsets.copy()
        offsets[place] += by
        columns.append((shown_beside(faulty, index, State(point.values, point.initial, offsets), base) - base) / by)
    made = np.array(columns)
    return made if np.all(np.isfinite(made)) else np.zeros_like(made)


def with_sizes(faulty: OutputError, state: State) -> State:
    """A point of the search without its last faults, with all their sizes zero."""
    return replace(state, offsets=np.pad(state.offsets, (0, len(faulty.offsets) - len(state.offsets))))


def shown_beside(faulty: OutputError, index: int, state: State, made: np.ndarray) -> np.ndarray:
    """As ``OutputError.simulate``, where ``made`` (n,) is that with all sizes of the last fault zero.

    A fault that moves no mass needs no simulation, unless something is predicted.
    """
    fault, sizes, segment = faulty.faults[-1], sizes_of(faulty.faults, state.offsets)[-1], faulty.segments[index]
    if faulty.memory != FREE or (fault.moves and fault.meant(segment, sizes) is not segment):
        return faulty.simulate(index, state)
    return fault.shown(made, segment, sizes)

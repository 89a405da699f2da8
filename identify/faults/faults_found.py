"""Which faults of recordings explain what a model leaves, decisively and to the noise: by kind and place.

What a wrong model leaves looks like many things. So a fault is named only where no more than noise is left with it in
every recording, and the recordings are beyond doubt more likely with it, its search over kinds and places paid for:
where physics is missing, no fault of one size does that.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from contextlib import suppress
from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...recording.as_recorded import of_force, of_response
from ...recording.recording import Recording
from ..fit.from_prediction import from_prediction, keeps_step, simulates
from ..fit.reported_result import Fit
from ..fit.reweighted_fit import concentrated, over_noise
from ..motion.force_off import runs
from ..problem.chain import Fault, sizes_of
from ..problem.data import noise_at
from ..problem.descent import search
from ..problem.linearised import Linearised
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..signals.limits import SEVERAL
from ..signals.odds import ABOVE_NOISE, BEYOND_ERRORS, DECISIVE, ONE_ERROR, SIGNIFICANT
from ..signals.registry import budget, numerics
from .contradiction import Contradiction
from .fault import GAINS, THROUGHOUT, ForceHum, Hum, Late, times_of, tone
from .fault_score import KINDS, expected_gains, possible, shown_beside, with_sizes
from .fitted_problem import fitted_problem

_ROUNDS = budget(
    6, "rounds", why="of a search for sizes and place in turn; it ends where a round gains less than one standard error"
)
_NEARLY = numerics(0.6, "times the smallest step", why="a halving search ends beside it")
_STEPS = budget(6, "steps in a round", why="quadratic convergence")

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class FoundFault:
    """A fault of a recording.

    Attributes:
        fault: kind, recording and place.
        sizes, errors: of it, with their standard errors.
        gain: of log-likelihood.
        name: of the recording.
        words: kind, place and size, for a user.
    """

    fault: Fault
    sizes: tuple[float, ...]
    errors: tuple[float, ...]
    gain: float
    name: str
    words: str

    @property
    def sentence(self) -> str:
        """Recording, kind, place and size."""
        return f"{self.name}: {self.words}"

    @property
    def stands(self) -> bool:
        """Whether any of its sizes is beyond its error."""
        return any(abs(s) > BEYOND_ERRORS * e for s, e in zip(self.sizes, self.errors, strict=True))


def faults_found(
    fit: Fit,
    recordings: Sequence[Recording],
    known: Contradiction | None = None,
    kinds: Sequence[type[Fault]] = KINDS,
) -> tuple[FoundFault, ...]:
    """The faults of recordings that explain what a fit leaves; none where they do not explain it to the noise.

    Args:
        fit: of these recordings.
        recordings: as they were fitted.
        known: the part of them that the rest contradicts, where there is one: the search begins at what the rest says,
            and looks for one fault of that part's recording that begins or ends with it.
        kinds: that are asked for.
    """
    problem, state = fitted_problem(fit, recordings)
    start = fit.oscillator
    found: list[Fault] = []
    best, point, gains = problem, state, []
    likelihood = concentrated(problem, state, start)
    if known is not None:
        point = known.state
    # one recording has one fault (``_is_one_cause``)
    while len(found) < (1 if known is not None else max(2, len(recordings))):
        asked, count = _asked(best, point, fit, known, kinds)
        if not asked:
            break
        price = DECISIVE + math.log(count)
        tried = [_fitted(_begun(problem, point, [*found, fault]), start) for fault in asked if not fault.slow]
        waves = [fault for fault in asked if fault.slow]
        if waves and not any(_noise_alone(other, where, fit, recordings) for other, where in tried):
            tried.append(_fitted(_likeliest(problem, point, found, waves, start), start))
        odds = [concentrated(other, where, start) for other, where in tried]
        top = int(np.argmax(odds))
        for (other, _), one in zip(tried, odds, strict=True):
            fault = other.faults[-1]
            name = recordings[fault.recording].name
            _log.info("%s, %s: gains %.4g, its price is %.4g", name, type(fault).__name__, one - likelihood, price)
        if not odds[top] > likelihood + price:
            break
        gains.append(odds[top] - likelihood)
        (best, point), likelihood = tried[top], odds[top]
        found = list(best.faults)
        finest = best.coarsely(False)
        where = search(finest, point, tolerance=0.1, most=_STEPS, informed=False).state
        if _noise_alone(finest, where, fit, recordings):
            sized = _with_sizes(finest, where, gains, fit, recordings)
            stand = all(f.stands and _lasts(f, recordings, finest.segments) for f in sized)
            return sized if stand and _is_one_cause(sized) else ()
    return ()


def _is_one_cause(found: Sequence[FoundFault]) -> bool:
    """Whether faults are one thing that a chain does: several in several records may come of lines or of delays alone.

    Gains and steps of many records, each of its own size, soak up what a family lacks as well.
    """
    kinds = {type(found.fault) for found in found}
    return len(found) == 1 or kinds == {Late} or kinds == {Hum} or kinds == {ForceHum}


def _lasts(found: FoundFault, recordings: Sequence[Recording], segments: Sequence[Segment]) -> bool:
    """Whether a line on a response is there too in the longest part of its recording that was not fitted.

    Hum goes on while a rig rests or is held; a line of the motion does not. Where much else moves nothing is told.
    """
    fault = found.fault
    if not isinstance(fault, Hum):
        return True
    recording = recordings[fault.recording]
    outside = np.ones(recording.n, bool)
    for segment in segments:
        if segment.recording == fault.recording:
            outside[segment.start : segment.stop] = False
    first, last = max(runs(outside), key=lambda run: run[1] - run[0], default=(0, 0))
    times = np.arange(first, last) / recording.fs
    if (last - first) < SEVERAL * recording.fs / fault.place:
        return True
    waves = [tone(times, fault.place, np.array(size)) for size in ((1.0, 0.0), (0.0, 1.0))]
    columns = np.stack([*waves, np.ones(times.size), times], axis=1)
    weights = np.linalg.lstsq(columns, recording.response[first:last])[0]
    left = float(np.std(recording.response[first:last] - columns @ weights))
    error = left * np.sqrt(2.0 / times.size)
    return bool(np.hypot(*weights[:2]) > math.hypot(*found.sizes) - SIGNIFICANT * math.hypot(error, *found.errors))


def with_fault(
    problem: OutputError, state: State, fault: Fault, fit: Fit, recordings: Sequence[Recording]
) -> tuple[float, np.ndarray, np.ndarray] | None:
    """Log-likelihood with one fault, its sizes and the parameters (free,) there; None where more than noise is left."""
    faulty, point = _fitted(_begun(problem, state, [fault]), fit.oscillator)
    if not _noise_alone(faulty, point, fit, recordings):
        return None
    likelihood = concentrated(faulty, point, fit.oscillator)
    return likelihood, sizes_of(faulty.faults, point.offsets)[-1], point.values[list(problem.free)]


def _asked(
    problem: OutputError, state: State, fit: Fit, contradicted: Contradiction | None, kinds: Sequence[type[Fault]]
) -> tuple[list[Fault], int]:
    """Of each kind the fault whose score promises most, where that is decisive; how many there were to choose from.

    The score says where; how much a kind gains only its own fit says, for a large fault is no small step. Of a wave
    it says neither: of waves of several lengths it takes the longest for the likeliest.
    """
    residuals = problem.residuals(state)
    if not keeps_step(problem.segments, residuals):
        problem = problem.predicting(1.0)
        residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        return [], 0
    faults = possible(problem.segments, residuals, kinds)
    if contradicted is not None:
        part = contradicted.part
        edges = [edge for edge in (part.span.begin, part.begin, part.end) if edge < part.span.end]
        faults = [f for f in faults if f.recording == part.recording and not f.timed]
        faults += [kind(part.recording, edge) for kind in kinds if kind.timed for edge in edges]
    known = problem.faults
    faults = [f for f in faults if not any(type(f) is type(k) and f.recording == k.recording for k in known)]
    noise = noise_at(problem, residuals, state, fit.oscillator)
    if contradicted is not None:  # what is left in that part is no noise
        noise = [
            replace(spectrum, density=np.full(spectrum.density.size, level**2))
            for spectrum, level in zip(noise, contradicted.levels, strict=True)
        ]
    gains = expected_gains(problem, state, residuals, noise, faults)
    best: dict[object, tuple[float, Fault]] = {}
    for gain, fault in zip(gains, faults, strict=True):
        kind = (type(fault), fault.place) if fault.slow else type(fault)
        if gain > best.get(kind, (0.0,))[0]:
            best[kind] = (float(gain), fault)
    price = DECISIVE + math.log(max(len(faults), 1))
    asked = sorted(((g, f) for g, f in best.values() if g > price), key=lambda pair: -pair[0])
    return [fault for _, fault in asked], len(faults)


def _begun(problem: OutputError, state: State, faults: Sequence[Fault]) -> tuple[OutputError, State]:
    """The fit with faults, and a point from which a simulation keeps step with the motion, as far as there is one."""
    faulty = problem.with_faults(faults)
    point = with_sizes(faulty, state)
    if not keeps_step(faulty.segments, faulty.residuals(point)):
        with suppress(BadInput):
            return faulty, from_prediction(faulty, point)[0]
    return faulty, point


def _likeliest(
    problem: OutputError, state: State, found: Sequence[Fault], waves: Sequence[Fault], start: Oscillator
) -> tuple[OutputError, State]:
    """Of waves that may lead to the same one that which one round makes the likeliest: where it began says little."""
    begun = [_round(*_begun(problem, state, [*found, wave])) for wave in waves]
    return max(begun, key=lambda pair: concentrated(*pair, start))


def _round(faulty: OutputError, point: State) -> tuple[OutputError, State]:
    """Sizes of the faults where they are, with the parameters, then the last one's place; nothing where none runs."""
    if not simulates(faulty, point):
        return faulty, point
    return _placed(faulty, search(faulty, point, tolerance=0.5, most=_STEPS, informed=False).state)


def _fitted(begun: tuple[OutputError, State], start: Oscillator) -> tuple[OutputError, State]:
    """Sizes and places of the faults with the parameters, each in turn, until that says no more: the likeliest."""
    faulty, point = begun
    known = -math.inf
    for _ in range(_ROUNDS):
        before = faulty.faults
        faulty, point = _round(faulty, point)
        likelihood = concentrated(faulty, point, start)
        if faulty.faults == before or likelihood < known + ONE_ERROR:
            break
        known = likelihood
    return faulty, search(faulty, point, tolerance=0.1, most=_STEPS, informed=False).state


def _placed(faulty: OutputError, state: State) -> tuple[OutputError, State]:
    """The last fault where what is left is least, all else as it is: by halving, to a sample.

    A wave of another frequency stays as it is where the motion is largest: from the beginning of the record it would
    be out of step there.
    """
    fault = faulty.faults[-1]
    own = [i for i, segment in enumerate(faulty.segments) if segment.recording == fault.recording]
    segments = [faulty.segments[i] for i in own]
    span = segments[-1].time + segments[-1].n * segments[-1].dt - segments[0].time
    if not (fault.timed or fault.tonal):
        return faulty, state
    weights = [s.response - np.mean(s.response) for s in segments]
    middle = float(
        np.average(np.concatenate([times_of(s) for s in segments]), weights=np.concatenate(weights) ** 2)
        if fault.tonal
        else 0.0
    )

    def at(place: float) -> State:
        if not fault.tonal:
            return state
        sizes = state.offsets.copy()
        wave = (sizes[-1] - 1j * sizes[-2]) * np.exp(2j * np.pi * (fault.place - place) * middle)
        sizes[-2:] = -wave.imag, wave.real
        return replace(state, offsets=sizes)

    sound = replace(state, offsets=np.append(state.offsets[: -fault.count], np.zeros(fault.count)))
    made = [faulty.simulate(i, sound) for i in own]

    def left(place: float) -> float:
        moved, state = _at_place(faulty, place), at(place)
        with np.errstate(over="ignore"):  # a motion that runs away
            total = sum(
                float(np.sum((segment.response - shown_beside(moved, i, state, base)) ** 2))
                for i, segment, base in zip(own, segments, made, strict=True)
            )
        return total if math.isfinite(total) else math.inf

    place, least = fault.place, left(fault.place)
    by = span / 24 if fault.timed else 0.25 / span
    smallest = segments[0].dt if fault.timed else 1e-3 / span
    while by > _NEARLY * smallest:
        trials = [(left(place + way * by), place + way * by) for way in (-1.0, 1.0)]
        value, there = min(trials)
        if value < least:
            place, least = there, value
        else:
            by /= 2.0
    return _at_place(faulty, place), at(place)


def _at_place(faulty: OutputError, place: float) -> OutputError:
    """The same with the last fault at another place."""
    other = copy(faulty)
    other.faults = (*faulty.faults[:-1], replace(faulty.faults[-1], place=float(place)))
    return other


def _noise_alone(faulty: OutputError, state: State, fit: Fit, recordings: Sequence[Recording]) -> bool:
    """Whether no more than noise is left anywhere."""
    residuals = faulty.residuals(state)
    return max(over_noise(faulty, residuals, state, fit.oscillator, recordings)) <= ABOVE_NOISE


def _with_sizes(
    faulty: OutputError, state: State, gains: Sequence[float], fit: Fit, recordings: Sequence[Recording]
) -> tuple[FoundFault, ...]:
    residuals = faulty.residuals(state)
    noise = noise_at(faulty, residuals, state, fit.oscillator)
    errors = Linearised.of(faulty, state, residuals, noise).shared.errors()[len(faulty.free) :]
    found = []
    drive = _lag_of_the_drive(faulty, state, errors)
    for fault, sizes, error, gain in zip(
        faulty.faults, sizes_of(faulty.faults, state.offsets), sizes_of(faulty.faults, errors), gains, strict=True
    ):
        recording = recordings[fault.recording]
        own = [segment for segment in faulty.segments if segment.recording == fault.recording]
        cycle = own[0].time + 2 * math.pi / own[0].pace  # which has no size of its own
        if isinstance(fault, GAINS) and fault.place < cycle:
            fault = replace(fault, place=THROUGHOUT)
        words = drive or fault.in_words(sizes, error, of_response(recording), of_force(recording))
        found.append(
            FoundFault(fault, tuple(map(float, sizes)), tuple(map(float, error)), float(gain), recording.name, words)
        )
    return tuple(found)


def _lag_of_the_drive(faulty: OutputError, state: State, errors: np.ndarray) -> str | None:
    """Other words where all driven recordings are late, and by the same: what drives or shows the rig may do that."""
    driven = {segment.recording for segment in faulty.segments if segment.force is not None}
    if {fault.recording for fault in faulty.faults} != driven or not all(isinstance(f, Late) for f in faulty.faults):
        return None
    sizes = np.concatenate(sizes_of(faulty.faults, state.offsets))
    weights = np.concatenate(sizes_of(faulty.faults, errors)) ** -2.0
    mean = float(np.average(sizes, weights=weights))
    if np.any(np.abs(sizes - mean) > BEYOND_ERRORS * weights**-0.5) or not mean > 0:
        return None
    return (
        f"in every driven recording the response comes about {1e3 * mean:.3g} ms late for its force, so either the "
        "channels are not in step or the drive or the sensor lags; dashpot diagnose weighs a lag (--with time-delay "
        "fits it), and channels are put in step in the file"
    )

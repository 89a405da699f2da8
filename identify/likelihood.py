"""Maximum likelihood on the simulated response, over all recordings jointly.

Output error with the noise's own spectrum (Whittle 1953): Hilbert estimates are the start, this is the answer. It
reaches the Cramér-Rao bound where regressions on differentiated data are biased by any noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..model import Oscillator
from ..model.oscillator import QUANTITIES
from ..recording.recording import Recording
from ..simulate.core import core_of, internal_step
from .hilbert import noise_level
from .jumps import left_out, smooth_stretches
from .noise_spectrum import NoiseSpectrum, estimate, resonance_of
from .output_error import Outcome, OutputError, State, pseudo_inverse
from .segments import Segment, cut, first_motion

#: A long record is first fitted over this many cycles, then over ever longer stretches: a phase error of more than
#: half a cycle at its end would lead into a false minimum.
_FIRST_CYCLES = 24.0
_GROWTH = 4.0
#: Draws of force noise for the covariance: its standard errors are then good to 9 %.
_DRAWS = 60
#: A spring that turns the phase by less than this (rad) in the longest recording is as good as none.
SLACK = 0.1
#: The mass may come to this many times its start, or to as small a part of it.
_MASS_SPAN = 1e3


@dataclass(frozen=True, eq=False)
class SegmentFit:
    """How one segment came out.

    Attributes:
        segment: what was fitted.
        initial: (2,) displacement and velocity at its first sample.
        simulated: (n,) response.
        nrmse: rms(simulated - measured) / std(measured).
    """

    segment: Segment
    initial: np.ndarray
    simulated: np.ndarray
    nrmse: float


@dataclass(frozen=True, eq=False)
class Fit:
    """The maximum of the likelihood.

    Attributes:
        oscillator: the model with identified values and standard errors.
        names: free parameters in the covariance's order.
        covariance: (k, k).
        log_likelihood: at the maximum, with the noise spectra found.
        segments: one per segment.
        noise: noise spectrum of each segment.
        iterations: steps of the search, all rounds together.
        converged: whether the last round came to rest.
        notes: what a user should know.
    """

    oscillator: Oscillator
    names: tuple[str, ...]
    covariance: np.ndarray
    log_likelihood: float
    segments: tuple[SegmentFit, ...]
    noise: tuple[NoiseSpectrum, ...]
    iterations: int
    converged: bool
    notes: tuple[str, ...]


def maximum_likelihood(start: Oscillator, recordings: Sequence[Recording]) -> Fit:
    """Find the parameters of ``start``'s family that make the recordings most likely.

    Args:
        start: structure and start values; ``mass`` None where no recording has a force.
        recordings: of one rig, all of the same quantity.

    Raises:
        BadInput: where nothing in the recordings can be simulated, or the simulation fails at the start values.
    """
    segments = cut(recordings, start.omega0.value)
    if start.mass is None:  # nothing says how far a newton goes: the driven stretches cannot be simulated
        segments = tuple(segment for segment in segments if segment.force is None)
    if not segments:
        raise BadInput(
            "the recordings hold neither a free decay nor a stretch driven by a force that is long enough to fit; "
            "record a decay of at least ten cycles or a sweep through the resonance"
        )
    names = tuple(start.parameters())
    values = np.array(list(start.values().values()))
    amplitude = displacement_amplitude(segments, start)
    pace = segments[0].pace
    scale = typical_sizes(names, values, amplitude, pace)
    step = internal_step(start, start.values(), amplitude)
    core = core_of(start)
    state_scale = np.full(core.states, amplitude * 1e-2)
    state_scale[1] *= pace
    free = tuple(range(len(names)))

    begin = np.zeros((len(segments), core.states))
    begin[:, :2] = initial_states(segments, start)
    state = State(values, begin)
    iterations = 0
    bounds = _bounds(names, values, max(recording.n * recording.dt for recording in recordings))
    problem = OutputError(core, segments, free, scale, state_scale, step, bounds)
    state = problem.settle(state)
    if not all(np.all(np.isfinite(residual)) for residual in problem.residuals(state)):
        raise BadInput("the model does not simulate with its start values; check signs and units of force and response")
    for stage in _growing(segments):
        early = OutputError(core, stage, free, scale, state_scale, step, bounds).search(state, tolerance=1.0)
        state, iterations = early.state, iterations + early.iterations
    outcome = problem.search(state, tolerance=1.0)
    iterations += outcome.iterations
    smooth, state = smooth_stretches(problem, outcome.state)
    notes = left_out(segments, smooth, [recording.name for recording in recordings])
    if notes:
        segments = smooth
        problem = OutputError(core, segments, free, scale, state_scale, step, bounds)
        outcome = problem.search(state, tolerance=1.0)
        iterations += outcome.iterations
    force_noise = [0.0 if r.force is None else noise_level(np.asarray(r.force, float), r.fs) for r in recordings]
    noise: list[NoiseSpectrum] = []
    for tolerance in (0.1, 1e-3):
        noise = [
            _noise(segment, residual, names, outcome.state.values, start.response.quantity)
            for segment, residual in zip(segments, outcome.residuals, strict=True)
        ]
        outcome = problem.search(outcome.state, noise, tolerance=tolerance)
        iterations += outcome.iterations
    scatter = problem.scatter(outcome.state, noise, [force_noise[segment.recording] for segment in segments], _DRAWS)
    used = {segment.recording for segment in segments}
    notes += [
        f"{recording.name}: nothing in it that could be fitted; it was left out"
        for i, recording in enumerate(recordings)
        if i not in used and not any(note.startswith(f"{recording.name}: ") for note in notes)
    ]
    return _result(start, names, segments, problem, outcome, noise, scatter, iterations, notes)


def _bounds(names: Sequence[str], values: np.ndarray, longest: float) -> np.ndarray:
    """(2, parameters) Mass and spring stay what they are: beyond a thousand times its start no force moves a mass."""
    bounds = np.full((2, len(names)), np.inf)
    bounds[0] = -np.inf
    if "mass" in names:
        i = names.index("mass")
        bounds[:, i] = values[i] / _MASS_SPAN, values[i] * _MASS_SPAN
    bounds[0, names.index("omega0")] = SLACK / longest
    return bounds


def _noise(
    segment: Segment, residual: np.ndarray, names: Sequence[str], values: np.ndarray, quantity: str
) -> NoiseSpectrum:
    """Noise of one segment: a forced one passes the noise of its force on through the resonance."""
    if segment.force is None:
        return estimate(residual)
    return estimate(residual, equivalent_resonance(segment, dict(zip(names, values, strict=True)), quantity))


def equivalent_resonance(segment: Segment, value: Mapping[str, float], quantity: str) -> np.ndarray:
    """(n // 2 + 1,) squared response to a force per unit mass of the equivalent linear rig at the segment's amplitude.

    Describing functions of Eqs. 6 and 7.
    """
    omega = 2 * np.pi * np.fft.rfftfreq(segment.n, segment.dt)
    order = QUANTITIES.index(quantity)
    tiny = np.finfo(float).tiny ** 0.25  # a search may have run to where nothing moves
    pace = segment.pace
    peak = max(np.sqrt(2) * float(np.std(segment.response)) / pace**order, tiny)
    stiffness = value["omega0"] ** 2 + 0.75 * value["cubic"] * peak**2 + 4 * value["preload"] / (np.pi * peak)
    damping = value["viscous"] + 4 * value["dry"] / (np.pi * pace * peak)
    return resonance_of(omega, stiffness, abs(damping)) * omega ** (2 * order)


def _result(
    start: Oscillator,
    names: tuple[str, ...],
    segments: Sequence[Segment],
    problem: OutputError,
    outcome: Outcome,
    noise: Sequence[NoiseSpectrum],
    scatter: np.ndarray,
    iterations: int,
    remarks: Sequence[str],
) -> Fit:
    from dataclasses import replace

    values = outcome.state.values
    inverse, lost = _invert(outcome.information, problem.scale)
    covariance = inverse @ scatter @ inverse  # Huber (1967): right where the weights are not
    errors = np.sqrt(np.diag(covariance))
    old = start.parameters()
    identified = start.with_parameters(
        {
            name: replace(old[name], value=float(values[i]), std=None if i in lost else float(errors[i]))
            for i, name in enumerate(names)
        }
    )
    fits = []
    for i, segment in enumerate(segments):
        residual = outcome.residuals[i]
        spread = float(np.std(segment.response))
        fits.append(
            SegmentFit(
                segment,
                outcome.state.initial[i],
                segment.response - residual,
                float(np.sqrt(np.mean(residual**2))) / spread if spread > 0 else np.inf,
            )
        )
    points = sum(segment.n for segment in segments)
    log_likelihood = -outcome.cost - 0.5 * sum(s.log_determinant() for s in noise) - 0.5 * points * np.log(2 * np.pi)
    notes = [*remarks, *(f"{names[i]} is not identifiable from these recordings" for i in lost)]
    if not outcome.converged:
        notes.append("the search for the maximum of the likelihood stopped at its limit of steps")
    return Fit(
        identified,
        names,
        covariance,
        float(log_likelihood),
        tuple(fits),
        tuple(noise),
        iterations,
        outcome.converged,
        tuple(notes),
    )


def _invert(information: np.ndarray, scale: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Covariance, and which parameters the information does not reach."""
    size = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    lost = tuple(int(i) for i in np.flatnonzero(size * scale < 1e-6))
    return pseudo_inverse(information), lost


def _growing(segments: Sequence[Segment]) -> list[tuple[Segment, ...]]:
    """Ever longer beginnings of the free segments, short of the whole; forced ones are whole, their memory is short."""
    from dataclasses import replace

    stages = []
    cycles = _FIRST_CYCLES
    longest = max((s.n * s.dt * s.pace / (2 * np.pi) for s in segments if s.force is None), default=0.0)
    while cycles < longest:
        stage = []
        for segment in segments:
            n = int(cycles * 2 * np.pi / segment.pace / segment.dt)
            if segment.force is None and n < segment.n:
                stage.append(replace(segment, stop=segment.start + n, response=segment.response[:n]))
            else:
                stage.append(segment)
        stages.append(tuple(stage))
        cycles *= _GROWTH
    return stages


def displacement_amplitude(segments: Sequence[Segment], oscillator: Oscillator) -> float:
    """Largest displacement in the segments, as far as the recorded quantity tells."""
    power = QUANTITIES.index(oscillator.response.quantity)
    peak = max(float(np.max(np.abs(segment.response - np.median(segment.response)))) for segment in segments)
    return peak / segments[0].pace ** power


def typical_sizes(names: Sequence[str], values: np.ndarray, amplitude: float, pace: float) -> np.ndarray:
    """Sizes at which a parameter matters: one hundredth of the force of inertia at full amplitude."""
    length, rate = amplitude, amplitude * pace
    acceleration = 0.01 * pace**2 * amplitude
    sizes = {"mass": abs(values[0]), "omega0": 0.01 * pace, "cubic": acceleration / length**3}
    sizes |= {"preload": acceleration, "dry": acceleration, "viscous": acceleration / rate}
    found = []
    for i, name in enumerate(names):
        found.append(sizes.get(name, max(abs(values[i]), 1e-12)))
    return np.array(found)


def initial_states(segments: Sequence[Segment], start: Oscillator) -> np.ndarray:
    """Displacement and velocity at each segment's first sample; zero where only a simulation can tell them."""
    found = np.zeros((len(segments), 2))
    if start.response.quantity != "displacement":
        return found
    for i, segment in enumerate(segments):
        if not segment.rests:
            found[i] = first_motion(segment.response, segment.dt, segment.pace)[0]
    return found

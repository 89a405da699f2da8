"""Recordings of one rig as every model is fitted to them: segments, their noise, the sizes of the motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...model.law import Scales
from ...model.oscillator import QUANTITIES
from ...recording.recording import Recording
from ..motion.decays import find_free_motion
from ..signals.noise_spectrum import NoiseSpectrum, concentrated_likelihood, estimate, resonance_of
from ..signals.signals import noise_levels, response_of
from .equivalent import equivalent
from .limits import ROUNDED
from .offset import Offset
from .output_error import OutputError, State
from .prediction import FREE
from .segments import COARSE_FORCE_BAND, FORCE_BAND, Segment, cut, pace_of


@dataclass(frozen=True, eq=False)
class Data:
    """Recordings of one rig, cut into the segments that every model is fitted to.

    Attributes:
        recordings: as read.
        segments: free decays and driven stretches.
        sensor: (segments,) standard deviation of the response's noise, from its highest frequencies.
        force: (segments,) the same of the force.
        scales: sizes of the motion.
        coarse: whether models are only compared on them: simulated with longer steps than what is delivered, with an
            error far below any noise.
        memory: how far models predict, in cycles; see ``prediction``.
        offsets: what sensors show at zero, free in every fit.
    """

    recordings: tuple[Recording, ...]
    segments: tuple[Segment, ...]
    sensor: tuple[float, ...]
    force: tuple[float, ...]
    scales: Scales
    coarse: bool = True
    memory: float = FREE
    offsets: tuple[Offset, ...] = ()

    @property
    def points(self) -> int:
        """Number of samples in all segments."""
        return sum(segment.n for segment in self.segments)


def data_of(
    recordings: Sequence[Recording],
    model: Oscillator,
    lines: Sequence[float] = (),
    *,
    coarse: bool = True,
) -> Data:
    """Cut recordings and measure their noise and the sizes of the motion.

    Raises:
        BadInput: where nothing in them can be fitted.
    """
    segments = cut(recordings, natural_frequency(recordings, model), COARSE_FORCE_BAND if coarse else FORCE_BAND)
    if model.mass is None:
        segments = tuple(segment for segment in segments if segment.force is None)
    if not segments:
        raise BadInput(_nothing_to_fit(recordings))
    return measured(segments, recordings, model, lines, coarse=coarse)


def _nothing_to_fit(recordings: Sequence[Recording]) -> str:
    """Why there is nothing to fit in recordings, and what to record instead."""
    motions = [find_free_motion(recording) for recording in recordings]
    if all(motion.swell for motion in motions):
        return "\n".join(note for motion in motions for note in motion.notes)
    names = ", ".join(recording.name for recording in recordings)
    several = "where several modes ring, --mode with the frequency of one in Hz takes that one alone"
    if all(recording.force is None or not np.ptp(recording.force) for recording in recordings):
        return (
            f"{names}: no free decay that is long and loud enough to fit; a release needs more cycles, a larger swing "
            f"or less noise, and what a force drives needs that force in a column; {several}"
        )
    return (
        f"{names}: neither a free decay nor a stretch driven by a force that is long and loud enough to fit; "
        f"record a release and the ringing after it, or a sweep through the resonance; {several}"
    )


def natural_frequency(recordings: Sequence[Recording], model: Oscillator) -> float:
    """Natural frequency, rad/s, where a further law may be the spring (gravity on a pendulum)."""
    omega0 = model.omega0.value
    if not model.terms:
        return omega0
    pace = max([pace_of(recordings, omega0), *(2 * np.pi * _swinging(recording) for recording in recordings)])
    if not pace > omega0:
        return omega0
    peak = np.sqrt(2) * max(float(np.std(r.response)) / pace ** QUANTITIES.index(r.quantity) for r in recordings)
    stiffness, _ = equivalent(model.values(), max(peak, np.finfo(float).tiny ** 0.25), pace)
    return max(omega0, float(np.sqrt(max(stiffness, 0.0))))


def _swinging(recording: Recording) -> float:
    """Frequency in Hz at which a recording swings freely; 0 where a force drives it, at a frequency of its own."""
    if recording.force is not None and np.any(recording.force):
        return 0.0
    return response_of(recording).frequency


def measured(
    segments: Sequence[Segment],
    recordings: Sequence[Recording],
    model: Oscillator,
    lines: Sequence[float] = (),
    *,
    coarse: bool = True,
) -> Data:
    """Segments of recordings with their noise and the sizes of the motion."""
    noise = [noise_levels(recording) for recording in recordings]
    length, pace = displacement_amplitude(segments), segments[0].pace
    shown = [s for s in segments if s.order and s.quantity == model.response.quantity]
    scales = Scales(
        length=length,
        omega=pace,
        force=max((float(np.max(np.abs(r.force))) for r in recordings if r.force is not None), default=0.0),
        response=max(
            (float(np.max(np.abs(segment.response))) for segment in shown),
            default=length * pace ** QUANTITIES.index(model.response.quantity),
        ),
        duration=max(r.n * r.dt for r in recordings),
        mass=None if model.mass is None else model.mass.value,
        lines=tuple(lines),
    )
    return Data(
        tuple(recordings),
        tuple(segments),
        tuple(noise[segment.recording][0] for segment in segments),
        tuple(noise[segment.recording][1] for segment in segments),
        scales,
        coarse,
    )


def displacement_amplitude(segments: Sequence[Segment]) -> float:
    """Largest displacement in the segments, as far as the recorded quantities tell.

    An acceleration's peak is that of a blow or of a contact, not of the motion: its largest root mean square over a
    period tells how far the mass swings.
    """
    return max(_swing(segment) / segment.pace**segment.order for segment in segments)


def _swing(segment: Segment) -> float:
    """Amplitude of what a segment shows, about its median."""
    response = segment.response - np.median(segment.response)
    peak = float(np.max(np.abs(response)))
    if segment.quantity != "acceleration":
        return peak
    period = int(np.clip(2 * np.pi / segment.pace / segment.dt, 1, segment.n))
    squares = np.concatenate([[0.0], np.cumsum(response**2)])
    return min(peak, float(np.sqrt(2 * np.max(squares[period:] - squares[:-period]) / period)))


def equivalent_resonance(segment: Segment, value: Mapping[str, float]) -> np.ndarray:
    """(n // 2 + 1,) squared response to a force per unit mass of the equivalent linear rig at the segment's amplitude.

    With the laws among the values, by name: see ``equivalent``.
    """
    omega = 2 * np.pi * np.fft.rfftfreq(segment.n, segment.dt)
    stiffness, damping = equivalent_of(segment, value)
    return resonance_of(omega, stiffness, abs(damping)) * omega ** (2 * segment.order)


def equivalent_of(segment: Segment, value: Mapping[str, float]) -> tuple[float, float]:
    """Stiffness and damping of the equivalent linear rig at a segment's amplitude: see ``equivalent``."""
    tiny = np.finfo(float).tiny ** 0.25  # a search may have run to where nothing moves
    pace = segment.pace
    peak = max(np.sqrt(2) * float(np.std(segment.response)) / pace**segment.order, tiny)
    return equivalent(value, peak, pace, segment.time + 0.5 * segment.n * segment.dt)


def noise_of(
    segments: Sequence[Segment],
    residuals: Sequence[np.ndarray],
    values: Mapping[str, float],
    memory: float = FREE,
) -> list[NoiseSpectrum]:
    """Spectrum of what is left over in each segment.

    In a simulation the noise of the force is among it, as the rig passes it on through its resonance; a prediction has
    forgotten it.
    """
    spectra = []
    for segment, residual in zip(segments, residuals, strict=True):
        passed = segment.force is not None and memory == FREE
        shape = equivalent_resonance(segment, values) if passed else None
        spectra.append(estimate(residual, shape, measured_share(segment)))
    return spectra


def measured_share(segment: Segment) -> float:
    """The share of a segment's samples that were measured."""
    return 1.0 if segment.blank is None else 1.0 - float(np.mean(segment.blank))


def noise_at(
    problem: OutputError, residuals: Sequence[np.ndarray], state: State, model: Oscillator
) -> list[NoiseSpectrum]:
    """The same at a point of a search; ``model`` names the parameters that the point has."""
    values = dict(zip(model.parameters(), map(float, state.values), strict=True))
    return noise_of(problem.segments, residuals, values, problem.memory)


def noise_spectra(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> list[NoiseSpectrum]:
    """Spectrum of what a model leaves over in each segment of some data."""
    return noise_of(data.segments, residuals, model.values(), data.memory)


def expected_noise(segment: Segment, values: Mapping[str, float], sensor: float, force: float) -> float:
    """Rms that sensor noise, and force noise as the rig passes it on, leave in one segment.

    Args:
        segment: of a recording.
        values: the model's parameters.
        sensor, force: standard deviations of the noise of response and force.
    """
    variance = sensor**2
    if segment.force is not None and force > 0:
        resonance = equivalent_resonance(segment, values)
        variance += (force / values["mass"]) ** 2 * float(np.mean(resonance))
    return max(float(np.sqrt(variance)), ROUNDED * float(np.std(segment.response)), np.finfo(float).tiny)


def likelihood(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> float:
    """Log-likelihood concentrated over the noise spectra (Whittle 1953); -inf where the model does not simulate."""
    if not all(np.all(np.isfinite(residual)) for residual in residuals):
        return -np.inf
    return concentrated_likelihood(noise_spectra(residuals, model, data))

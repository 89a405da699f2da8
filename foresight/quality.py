"""What can be said of a recording before any model: noise, resolution, sampling, what is used of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..identify.motion.decays import find_free_motion
from ..identify.motion.excitation import kind_of
from ..identify.problem.segments import Segment
from ..identify.signals.signals import noise_levels
from ..model.display import scale_of
from ..model.fit_state import times_words
from ..recording.recording import Recording
from ..recording.resolution import converter_step


@dataclass(frozen=True)
class Quality:
    """Of one recording; what is measured of the response is in its unit.

    Attributes:
        name: of the recording.
        kind: of the excitation: decay, bursts, sine, sweep or broadband.
        quantity, unit: of the response.
        fs: samples a second, Hz.
        seconds: length.
        cycles: how often it swings in what is used of it.
        samples_a_cycle: of that motion.
        peak: largest distance from the middle.
        noise: standard deviation of the response's noise.
        step: of the converter; 0 where none is seen.
        force_peak, force_noise: the same of the force, in ``force_unit``; None without one.
        force_unit: of the force.
        pieces: kind, first and last second of each stretch that is used, from the first sample.
        notes: what reading it had to say.
    """

    name: str
    kind: str
    quantity: str
    unit: str
    fs: float
    seconds: float
    cycles: float
    samples_a_cycle: float
    peak: float
    noise: float
    step: float
    force_peak: float | None
    force_noise: float | None
    force_unit: str
    pieces: tuple[tuple[str, float, float], ...]
    notes: tuple[str, ...]

    @property
    def used(self) -> float:
        """Share of the recording that is used."""
        return sum(stop - start for _, start, stop in self.pieces) / self.seconds

    def words(self) -> list[str]:
        """What a person should know of it, in two lines."""
        peak, noise = scale_of(self.unit, self.peak), scale_of(self.unit, self.noise)
        kinds = ", ".join(
            f"{count} {kind}"
            for kind in ("free", "struck", "driven")
            if (count := [p[0] for p in self.pieces].count(kind))
        )
        taken = f"{100 * self.used:.0f} % of it is used ({kinds})" if self.pieces else "nothing in it can be used"
        first = (
            f"{self.name}: {self.kind}, {self.seconds:.4g} s at {self.fs:.4g} Hz, "
            f"{self.samples_a_cycle:.3g} samples a cycle; {taken}"
        )
        second = (
            f"{self.quantity} up to {peak.factor * self.peak:.3g} {peak.unit}, noise "
            f"{noise.factor * self.noise:.2g} {noise.unit} ({_times(self.peak, self.noise)})"
        )
        if self.step > self.noise:
            step = scale_of(self.unit, self.step)
            second += f", steps of {step.factor * self.step:.2g} {step.unit}: coarser than its noise"
        if self.force_peak is not None and self.force_noise is not None:
            peak, noise = scale_of(self.force_unit, self.force_peak), scale_of(self.force_unit, self.force_noise)
            second += (
                f"; force up to {peak.factor * self.force_peak:.3g} {peak.unit}, noise "
                f"{noise.factor * self.force_noise:.2g} {noise.unit} ({_times(self.force_peak, self.force_noise)})"
            )
        return [first, f"  {second}", *(f"  note: {note}" for note in self.notes)]


def _times(peak: float, noise: float) -> str:
    return "none is seen" if not noise > 0 else f"one in {times_words(peak / noise)}"


def qualities(recordings: Sequence[Recording], segments: Sequence[Segment]) -> tuple[Quality, ...]:
    """Of each recording, with the segments that a fit takes of all of them."""
    return tuple(
        _quality(recording, [s for s in segments if s.recording == place]) for place, recording in enumerate(recordings)
    )


def _quality(recording: Recording, taken: Sequence[Segment]) -> Quality:
    free = find_free_motion(recording)
    sensor, force_noise = noise_levels(recording)
    response = np.asarray(recording.response, float)
    force = recording.force if recording.force is not None and np.any(recording.force) else None
    pace = taken[0].pace / (2 * np.pi) if taken else np.nan
    return Quality(
        name=recording.name,
        kind=kind_of(recording, free.decays),
        quantity=recording.quantity,
        unit=recording.unit,
        fs=recording.fs,
        seconds=recording.duration,
        cycles=float(sum(s.n for s in taken) / recording.fs * pace) if taken else 0.0,
        samples_a_cycle=float(recording.fs / pace),
        peak=float(np.max(np.abs(response - np.median(response)))),
        noise=sensor,
        step=converter_step(response),
        force_peak=None if force is None else float(np.max(np.abs(force))),
        force_noise=None if force is None else force_noise,
        force_unit=recording.force_unit,
        pieces=tuple((s.kind, s.start / recording.fs, s.stop / recording.fs) for s in taken),
        notes=tuple(dict.fromkeys(recording.notes)),
    )

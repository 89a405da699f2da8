"""The kinds of faults of a measuring chain: each in a few sizes, each size zero where there is none."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace

import numpy as np

from ...recording.as_recorded import InUnit
from ...simulate.force import SAMPLES_A_CYCLE, Force, smooth_force
from ..problem.chain import Fault
from ..problem.segments import Segment
from ..signals.registry import numerics

_LEAST = numerics(1e-3, "of itself", why="a gain or a clock stays above zero while its size is searched")

#: The place of a gain that the whole of a recording has.
THROUGHOUT = -np.inf


class ResponseGain(Fault):
    """From some time on the response counts 1 + size times."""

    timed = True

    def _factor(self, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        return np.where(times_of(segment) < self.place, 1.0, 1.0 + sizes[0])

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``."""
        return replace(segment, response=segment.response / self._factor(segment, sizes))

    def shown(self, made: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """See ``Fault``."""
        return made * self._factor(segment, sizes)[: made.size]

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        return _gain_in_words("response", self.place, sizes, errors)


class ForceGain(Fault):
    """From some time on the force counts 1 + size times."""

    timed = moves = forced = True

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``."""
        if segment.force is None:
            return segment
        factor = np.where(times_of(segment) < self.place, 1.0, 1.0 / max(1.0 + sizes[0], _LEAST))
        return replace(segment, force=times_over(segment.force, factor, segment.dt))

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        return _gain_in_words("force", self.place, sizes, errors)


#: The kinds that may hold throughout a recording, and then have no time.
GAINS = (ResponseGain, ForceGain)


class Late(Fault):
    """The response comes late by so many cycles of the rig; early where that is negative."""

    moves = forced = True

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``: the force of as much earlier has driven what the response shows."""
        if segment.force is None:
            return segment
        return replace(segment, force=moved_in_time(segment.force, float(sizes[0]), segment.dt))

    def scale(self, segment: Segment) -> float:
        """See ``Fault``; in seconds."""
        return 1e-2 / segment.pace

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        ms, error = 1e3 * sizes[0], 1e3 * errors[0]
        way = "late" if ms > 0 else "early"
        return (
            f"the response comes {with_error(abs(ms), error)} ms too {way} for its force: the two channels are not in "
            "step (or the drive lags); record them on one clock, or shift one in the file"
        )


class Clock(Fault):
    """The recorder's intervals are 1 + size times as long as the file says."""

    moves = True

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``."""
        longer = max(1.0 + float(sizes[0]), _LEAST)
        force = segment.force
        if force is not None:
            force = replace(force, pieces=force.pieces / longer ** np.arange(4))
        return replace(segment, dt=segment.dt * longer, force=force)

    def scale(self, segment: Segment) -> float:
        """See ``Fault``."""
        return 1e-3

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        way = "faster" if sizes[0] > 0 else "slower"
        share = with_error(100 * abs(sizes[0]), 100 * errors[0])
        return (
            f"everything in it goes {share} % {way} than in the other recordings: its clock or its sampling rate is "
            "wrong, or the rig was changed between (its spring by twice as much); state the rate with --fs, or leave "
            "it out"
        )


class Added(Fault):
    """Something that lies on the response and moves nothing."""

    @abstractmethod
    def added(self, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """(n,) what lies on it."""

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``."""
        return replace(segment, response=segment.response - self.added(segment, sizes))

    def shown(self, made: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """See ``Fault``."""
        return made + self.added(segment, sizes)[: made.size]

    def scale(self, segment: Segment) -> float:
        """See ``Fault``; in the unit of the response."""
        return 1e-2 * float(np.std(segment.response))


class Hum(Added):
    """A line on the response: sine and cosine of one frequency."""

    count = 2
    tonal = True

    def added(self, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """See ``Added``."""
        return tone(times_of(segment), self.place, sizes)

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        factor, unit = response
        return (
            f"a line of {self.place:.4g} Hz and {factor * float(np.hypot(*sizes)):.3g} {unit} lies on the response "
            "that neither its force nor the motion makes: hum, or a force of that frequency that was not recorded; "
            "remove its cause and record again"
        )


class ForceHum(Fault):
    """A line on the force's channel that does not drive the rig: sine and cosine of one frequency."""

    count = 2
    tonal = moves = forced = True

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``."""
        if segment.force is None:
            return segment
        pieces = segment.force.pieces.copy()
        turn = 2 * np.pi * self.place
        wave = (sizes[1] + 1j * sizes[0]) * np.exp(-1j * turn * _piece_times(segment, segment.force))
        for k, factor in enumerate((1.0, 1.0, 0.5, 1.0 / 6.0)):  # Taylor: pieces are short beside the line's cycle
            pieces[:, k] -= np.real(wave * (-1j * turn) ** k) * factor
        return replace(segment, force=replace(segment.force, pieces=pieces))

    def scale(self, segment: Segment) -> float:
        """See ``Fault``; in the unit of the force."""
        return 1.0 if segment.force is None else 1e-2 * float(np.std(segment.force.pieces[:, 0]))

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        factor, unit = force
        return (
            f"a line of {self.place:.4g} Hz and {factor * float(np.hypot(*sizes)):.3g} {unit} lies on the force's "
            "channel and does not move the rig: hum of its sensor; remove its cause and record again"
        )


class ZeroStep(Added):
    """From some time on the sensor shows so much more."""

    timed = True

    def added(self, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """See ``Added``."""
        return np.where(times_of(segment) < self.place, 0.0, sizes[0])

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        factor, unit = response
        step = f"{factor * sizes[0]:.3g} ± {factor * errors[0]:.2g} {unit}"
        return (
            f"at {self.place:.4g} s the sensor's zero steps by {step}: it slipped, or its amplifier was set; use the "
            "parts before and after as recordings of their own (--part FROM:TO)"
        )


def times_of(segment: Segment) -> np.ndarray:
    """(n,) s."""
    return segment.time + np.arange(segment.n) * segment.dt


def _piece_times(segment: Segment, force: Force) -> np.ndarray:
    """(pieces,) s at which each begins."""
    return segment.time + np.arange(len(force.pieces)) * segment.dt / force.fine


def tone(times: np.ndarray, hertz: float, sizes: np.ndarray) -> np.ndarray:
    """A line of some Hz at times: its sine and its cosine."""
    turn = 2 * np.pi * hertz * times
    return sizes[0] * np.sin(turn) + sizes[1] * np.cos(turn)


def moved_in_time(force: Force, by: float | np.ndarray, dt: float) -> Force:
    """The force that runs ``by`` s later, () or (pieces + 1,) at the ends of its pieces.

    Each piece has the values and slopes of the old at its ends (Hermite); beyond its ends it stays where it is.
    """
    short, count = dt / force.fine, len(force.pieces)
    at = np.arange(count + 1) - by / short
    rate = np.gradient(at)
    piece = np.clip(np.floor(at), 0, count - 1).astype(int)
    into = np.clip(at - piece, 0.0, 1.0) * short
    inside = (at >= 0) & (at <= count)
    c = force.pieces[piece]
    value = c[:, 0] + into * (c[:, 1] + into * (c[:, 2] + into * c[:, 3]))
    if force.hold == "zero":
        pieces = np.zeros_like(force.pieces)
        pieces[:, 0] = value[:-1]
        return replace(force, pieces=pieces)
    slope = np.where(inside, rate * (c[:, 1] + into * (2.0 * c[:, 2] + 3.0 * into * c[:, 3])), 0.0)
    rise, first, last = np.diff(value), slope[:-1], slope[1:]
    second = (3.0 * rise / short - 2.0 * first - last) / short
    third = (first + last - 2.0 * rise / short) / short**2
    return replace(force, pieces=np.ascontiguousarray(np.stack([value[:-1], first, second, third], axis=1)))


def times_over(force: Force, factor: np.ndarray, dt: float) -> Force:
    """The force through its samples, each multiplied by a factor (n,): a jump must not ring between them."""
    pieces = force.pieces
    if force.hold != "smooth":
        return replace(force, pieces=pieces * np.repeat(factor, force.fine)[: len(pieces), None])
    end = pieces[-1] @ (dt / force.fine) ** np.arange(4)
    samples = np.append(pieces[:: force.fine, 0], end)
    return smooth_force(samples * factor[: samples.size], dt, (force.fine - 0.5) / (SAMPLES_A_CYCLE * dt))


def _gain_in_words(channel: str, place: float, sizes: np.ndarray, errors: np.ndarray) -> str:
    counts = f"the {channel} counts {with_error(1.0 + sizes[0], errors[0])} times what"
    if place == THROUGHOUT:
        return (
            f"throughout, {counts} agrees with the others: its channel had another gain or range, or the rig another "
            "mass; correct it (--calibration), or leave the recording out"
        )
    return (
        f"from {place:.4g} s on {counts} it should: the gain or range of its channel was changed; use the parts before "
        "and after as recordings of their own (--part FROM:TO)"
    )


def with_error(value: float, error: float) -> str:
    """Both in words."""
    return f"{value:.4g} ± {error:.2g}"

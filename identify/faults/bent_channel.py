"""Whether a channel counts more or less with time, with size or by sign, where a model leaves no more than noise.

The halves of a recording may each agree with parameters of their own that differ by few of their errors, while what
lies on them moves those of the whole by many: of six differences asked for at once noise makes one as large. A gain
that walks, a channel that saturates and one that counts one sign more have one size each. So each is asked for by
itself (score test with one degree of freedom, Rao 1948), beside all that parameters, initial states and zeros can do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...recording.as_recorded import InUnit
from ..problem.chain import Fault
from ..problem.linearised import Linearised
from ..problem.normal_equations import pseudo_inverse
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..signals.noise_spectrum import NoiseSpectrum
from .fault import times_over, with_error
from .fault_score import OWN, beside_fault
from .part import Span, spans_of

#: What a channel counts more by where its size is one, in words, and what does that.
_IN_WORDS = {
    "walks": ("{size} % {more} at its end than at its beginning", "a gain that walks"),
    "saturates": ("{size} % {more} where it is largest", "a channel that saturates"),
    "signs": ("{size} % {more} where it is positive", "a bent sensor, or a gain of its own for each sign"),
}


@dataclass(frozen=True)
class Bent(Fault):
    """A channel counts more by a size that goes with time, with the square of itself or with its sign.

    Attributes:
        shape: "walks", "saturates" or "signs".
        force: whether it is the force's channel.
        span: of its recording.
    """

    shape: str = "walks"
    force: bool = False
    span: Span | None = None

    @property
    def moves(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """See ``Fault``."""
        return self.force

    def meant(self, segment: Segment, sizes: np.ndarray) -> Segment:
        """See ``Fault``."""
        if not self.force:
            return replace(segment, response=segment.response / self._factor(segment.response, segment, sizes))
        if segment.force is None:
            return segment
        samples = segment.force.pieces[:: segment.force.fine, 0]
        factor = np.ones(max(segment.n, samples.size))
        factor[: samples.size] = 1.0 / self._factor(samples, segment, sizes)
        return replace(segment, force=times_over(segment.force, factor, segment.dt))

    def shown(self, made: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """See ``Fault``."""
        return made if self.force else made * self._factor(made, segment, sizes)

    def in_words(self, sizes: np.ndarray, errors: np.ndarray, response: InUnit, force: InUnit) -> str:
        """See ``Fault``."""
        counted, cause = _IN_WORDS[self.shape]
        size, more = with_error(100 * abs(sizes[0]), 100 * errors[0]), "more" if sizes[0] > 0 else "less"
        channel = "force" if self.force else "response"
        return (
            f"its {channel} contradicts the one model of all recordings unless it counts "
            f"{counted.format(size=size, more=more)}, and noise is all else: {cause}, or physics that is missing, does "
            "that; the standard errors cover what it does to the parameters"
        )

    def _factor(self, signal: np.ndarray, segment: Segment, sizes: np.ndarray) -> np.ndarray:
        """(signal,) by which its samples count more."""
        if self.shape == "signs":
            return 1.0 + sizes[0] * (signal > 0)
        if self.shape == "saturates":
            largest = max(float(np.max(np.abs(signal))), np.finfo(float).tiny)
            return 1.0 + sizes[0] * (signal / largest) ** 2
        if self.span is None:
            return np.ones(signal.size)
        times = segment.time + np.arange(signal.size) * segment.dt
        return 1.0 + sizes[0] * (times - self.span.begin) / (self.span.end - self.span.begin)


@dataclass(frozen=True, eq=False)
class FoundBent:
    """What is asked of a channel, and what it tells.

    Attributes:
        fault: which channel, and how it would be bent.
        size, error: by how much, with residuals independent of each other.
        shifts: (free,) of the parameters without it.
        chance: how often noise alone makes one of all questions tell as much.
    """

    fault: Bent
    size: float
    error: float
    shifts: tuple[np.ndarray, ...]
    chance: float = 1.0

    @property
    def recording(self) -> int:
        """Whose channel it is."""
        return self.fault.recording

    def judged(self, spread: float, questions: int) -> FoundBent:
        """The same with its chance.

        Args:
            spread: variance of scores that independent residuals would leave at 1: noise of the force is not such.
            questions: among which it is the one that tells most.
        """
        error = math.sqrt(spread) * self.error
        return replace(self, error=error, chance=questions * math.erfc(abs(self.size) / (math.sqrt(2.0) * error)))

    @property
    def words(self) -> str:
        """What is said of its recording."""
        return self.fault.in_words(np.array([self.size]), np.array([self.error]), (1.0, ""), (1.0, ""))


def bent_channels(
    problem: OutputError,
    state: State,
    residuals: Sequence[np.ndarray],
    noise: Sequence[NoiseSpectrum],
    linearised: Linearised,
) -> list[FoundBent]:
    """Every channel and shape that can be distinguished from what the parameters do.

    Args:
        problem: the model over the segments.
        state: its best point.
        residuals: there.
        noise: by which they are weighted.
        linearised: the same, linearised there.
    """
    k, free = problem.shared, len(problem.free)
    found: list[FoundBent] = []
    driven = {segment.recording for segment in problem.segments if segment.force is not None}
    asked = [
        Bent(span.recording, shape=shape, force=force, span=span)
        for span in spans_of(problem.segments)
        for shape in _IN_WORDS
        for force in ((False, True) if span.recording in driven else (False,))
    ]
    for fault in asked:
        beside = beside_fault(linearised, problem, state, residuals, noise, fault)
        alone = beside.without(slice(k))
        information = float(alone.normal[0, 0])
        if information > OWN * float(beside.normal[k, k]):
            size = float(alone.gradient[0]) / information
            if size <= -1.0:  # no channel counts less than nothing: of a force of one sign noise alone has the other
                continue
            shift = -(pseudo_inverse(beside.normal[:k, :k]) @ beside.normal[:k, k])[:free] * size
            found.append(FoundBent(fault, size, information**-0.5, (shift,)))
    return found

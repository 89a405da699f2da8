"""What a sensor shows at zero: a nuisance of each recording, fitted with the parameters where the motion asks for it.

The zero of a record is a setting of an amplifier and no physics. It stands beside the model, in ``Fit.offsets``, and
costs the parameters what it must.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..model import Oscillator
from ..recording.recording import Recording
from .data import Data, noise_of
from .noise_spectrum import NoiseSpectrum
from .normal_equations import pseudo_inverse
from .offset import FoundOffset, Offset
from .output_error import OutputError, State

#: An offset stays where it is this many of its standard errors from zero: a thousand times as likely with it as
#: without (a gain of ln 1000 is half the square of 3.7), by chance once in five thousand recordings.
_STANDS_OUT = float(np.sqrt(2.0 * np.log(1000.0)))
#: Laws that move the zero themselves: beside them an offset would be the same thing twice.
_SAME_THING = ("sensor-offset", "constant-force")


def centre(response: np.ndarray, fs: float, omega: float) -> float:
    """Where a motion (n,) of angular frequency ``omega`` is centred: the median of the means over its cycles."""
    period = max(2, round(2 * np.pi / omega * fs))
    count = response.size // period
    if count < 1:
        return float(np.mean(response))
    return float(np.median(np.mean(response[: count * period].reshape(count, period), axis=1)))


def response_offsets(data: Data, recordings: Sequence[Recording], model: Oscillator) -> tuple[Offset, ...]:
    """The offset of each recording that is fitted, where the model has no law that stands for it."""
    if any(term.law.effect in _SAME_THING for term in model.terms):
        return ()
    used = sorted({segment.recording for segment in data.segments})
    found = []
    for index in used:
        recording = recordings[index]
        size = 1e-2 * float(np.std(recording.response))
        found.append(
            Offset(
                index, "response", size, centre(np.asarray(recording.response, float), recording.fs, data.scales.omega)
            )
        )
    return tuple(found)


def kept_offsets(problem: OutputError, state: State, start: Oscillator) -> tuple[OutputError, State]:
    """The problem with the offsets that stand out of their errors alone; the others are zero from here on."""
    if not problem.offsets:
        return problem, state
    judged = problem  # where no simulation runs to the end, a prediction over a cycle does
    residuals = problem.residuals(state)
    if not all(bool(np.all(np.isfinite(residual))) for residual in residuals):
        judged = problem.predicting(1.0)
        residuals = judged.residuals(state)
    values = dict(zip(start.parameters(), map(float, state.values), strict=True))
    noise = noise_of(problem.segments, residuals, values, start.response.quantity, judged.memory)
    covariance = pseudo_inverse(judged.shared_information(state, residuals, noise))
    errors = np.sqrt(np.maximum(np.diag(covariance)[len(problem.free) :], 0.0))
    stays = np.abs(state.offsets) > _STANDS_OUT * errors
    if np.all(stays):
        return problem, state
    kept = tuple(offset for offset, stay in zip(problem.offsets, stays, strict=True) if stay)
    return problem.with_offsets(kept), replace(state, offsets=state.offsets[stays])


def found_offsets(
    problem: OutputError, state: State, residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum]
) -> tuple[FoundOffset, ...]:
    """The problem's offsets with their standard errors, at the maximum of the likelihood."""
    if not problem.offsets:
        return ()
    covariance = pseudo_inverse(problem.shared_information(state, residuals, noise))
    errors = np.sqrt(np.maximum(np.diag(covariance)[len(problem.free) :], 0.0))
    return tuple(
        FoundOffset(offset.recording, offset.channel, float(value), float(error))
        for offset, value, error in zip(problem.offsets, state.offsets, errors, strict=True)
    )

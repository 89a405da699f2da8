"""Samples that a recording lacks, filled from their neighbours, each channel by its own signal.

What was not recorded says nothing: a fit takes no account of it. A filled channel is what spectra, envelopes and
analytic signals need, and a force, which drives the motion meanwhile. Two ways are tried. An autoregressive model of
the surroundings makes the missing samples those that leave the least prediction error (Janssen, Veldhuis and Vries
1986); its error follows from the same equations. A straight line between both sides suits a force that is held or
switched; its error is what such a line leaves between samples that are there. The one with the smaller error is taken.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .clipping import noise_of
from .resolution import converter_step

#: Samples of a recording, as slices in order of time.
Runs = tuple[tuple[int, int], ...]

#: Coefficients of the autoregressive model: two for each mode, and as many again for the noise (Kay 1988, ch. 13).
_ORDER = 24
#: Samples of a gap that the model is asked for at most; a longer gap is filled through means of neighbours.
_ASKED = 8
#: Samples on either side of a gap by which it is filled, in coefficients of the model.
_AROUND = 6
#: Gaps that are filled so at most; of more each is filled by a monotone cubic.
_MOST = 1000
#: Samples of the shortest signal that is filled.
_FEWEST = 16
#: Rounds of filling and fitting where no stretch is whole.
_ROUNDS = 4
#: Median of the sizes of Gaussian numbers of unit standard deviation.
_MEDIAN = 0.6745
#: Directions of a model below this part of the largest are rounding.
_SAME = 1e-10


@dataclass(frozen=True, eq=False)
class Whole:
    """Signals without gaps.

    Attributes:
        columns: (n, k) response, and the force where there is one.
        blank: samples of what is fitted that were filled, as slices.
        unknown: samples of the force that nothing tells well enough, as slices.
        notes: what was done.
    """

    columns: np.ndarray
    blank: Runs = ()
    unknown: Runs = ()
    notes: tuple[str, ...] = ()


def made_whole(
    where: str, columns: np.ndarray, fs: float, beyond: np.ndarray | None = None, *, imposed: bool = False
) -> Whole:
    """Signals (n, k), response before force, with what is not a number in them filled, and what is ``beyond``.

    What fills a gap of the force is off by an impulse at most. Where this, beside that of the force over half a cycle,
    is more than the noise beside the response, the motion after the gap is not known from the motion before it. Without
    a force it is not after more than a cycle, in which a hand may have done anything.

    Args:
        where: name of the recording.
        columns: the signals.
        fs: samples a second.
        beyond: (n,) samples at which the response does not show the motion; the caller says why.
        imposed: whether the force follows from the motion: then it is what is fitted, and drives nothing.
    """
    gone = np.isnan(columns)
    every = runs_of(np.any(gone, axis=1))
    if beyond is not None:
        gone[:, 0] |= beyond
    if not np.any(gone) or np.any(np.all(gone, axis=0)) or np.any(np.isinf(columns)) or len(columns) < _FEWEST:
        return Whole(columns)
    made, errors = columns.copy(), []
    for k in range(columns.shape[1]):
        made[:, k], error = filled(columns[:, k], gone[:, k])
        errors.append(error)
    blank, unknown = tuple(errors[0]), () if imposed else tuple(_unknown(made, errors))
    if imposed:
        blank = tuple(runs_of(np.any(gone, axis=1)))
    notes = [
        f"{where}: {sum(b - a for a, b in every)} sample(s) are missing, "
        f"{spans((a / fs, b / fs) for a, b in every)} from the start; filled from their neighbours, and not fitted"
    ][: len(every)]
    if unknown:
        notes.append(
            f"{where}: what drove it is not known {spans((a / fs, b / fs) for a, b in unknown)} from the start; the "
            "motion after that is taken by itself"
        )
    return Whole(made, blank, unknown, tuple(notes))


def _unknown(columns: np.ndarray, errors: list[dict[tuple[int, int], float]]) -> list[tuple[int, int]]:
    """Gaps after which the motion does not follow from that before; ``errors`` are of filling, by gap and column."""
    response = columns[:, 0]
    spread = float(np.std(response))
    if not spread > 0:
        return []
    power = np.abs(np.fft.rfft(response - np.mean(response))) ** 2
    cycle = response.size / (1 + int(np.argmax(power[1:])))  # of the largest line
    if len(errors) == 1 or not (strength := float(np.std(columns[:, 1]))) > 0:
        return [(a, b) for a, b in errors[0] if b - a > cycle]
    least = noise_of(response) / spread * strength * 0.5 * cycle
    return [(a, b) for (a, b), error in errors[1].items() if error * (b - a) > least]


def runs_of(mask: np.ndarray) -> list[tuple[int, int]]:
    """Runs of True in a mask (n,), as slices."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(mask).astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def cut_runs(runs: Iterable[tuple[int, int]], first: int, last: int) -> Runs:
    """Runs as far as they lie within the samples from first to last, counted from there."""
    return tuple((max(a - first, 0), min(b, last) - first) for a, b in runs if b > first and a < last)


def filled(signal: np.ndarray, missing: np.ndarray) -> tuple[np.ndarray, dict[tuple[int, int], float]]:
    """The signal (n,) with its missing samples filled, and of each gap, as a slice, the rms error of what fills it.

    Args:
        signal: what is missing may hold anything.
        missing: (n,) which samples are; not all.
    """
    from scipy.interpolate import PchipInterpolator

    there = np.flatnonzero(~missing)
    made = np.array(signal, float)
    if there.size > 1:
        lost = np.flatnonzero(missing)
        made[lost] = PchipInterpolator(there, made[there])(np.clip(lost, there[0], there[-1]))
    else:
        made[:] = made[there[0]]
    first = made.copy()
    errors: dict[tuple[int, int], float] = {}
    for count, (a, b) in enumerate(runs_of(missing)):
        values, errors[a, b] = _line(first, missing, a, b)
        if count < _MOST:
            model, error = _by_model(first, missing, a, b)
            if error < errors[a, b]:
                values, errors[a, b] = model, error
        made[a:b] = values
    if errors and (step := converter_step(signal[there])):  # as the converter would have shown it
        level = made[there[0]]
        made[missing] = level + step * np.round((made[missing] - level) / step)
    return made, errors


def _line(signal: np.ndarray, missing: np.ndarray, a: int, b: int) -> tuple[np.ndarray, float]:
    """A straight line over a gap, and its error: what such lines leave nearby, but no less than half of its rise."""
    n, length = signal.size, b - a
    if a == 0 or b == n:
        value = signal[b] if a == 0 else signal[a - 1]
        return np.full(length, value), float(np.std(signal[~missing]))
    reach = _AROUND * (_ORDER + length)
    begin, end = max(0, a - reach), min(n, b + reach)
    near, gone = signal[begin:end], missing[begin:end]
    half = (length + 1) // 2
    middle = near[half:-half] - 0.5 * (near[: -2 * half] + near[2 * half :])
    whole = ~(gone[half:-half] | gone[: -2 * half] | gone[2 * half :])
    usual = float(np.median(np.abs(middle[whole]))) / _MEDIAN if np.any(whole) else np.inf
    values = np.interp(np.arange(a, b), [a - 1, b], [signal[a - 1], signal[b]])
    return values, max(usual, 0.5 * abs(float(signal[b] - signal[a - 1])))


def _by_model(signal: np.ndarray, missing: np.ndarray, a: int, b: int) -> tuple[np.ndarray, float]:
    """What an autoregressive model of the surroundings makes of a gap, and its error; infinite where there are few."""
    stride = -(-(b - a) // _ASKED)
    around = _AROUND * _ORDER * stride
    begin, end = max(0, a - around), min(signal.size, b + around)
    begin += (a - begin) % stride  # so that a mean begins where the gap does
    count = (end - begin) // stride
    blocks = slice(begin, begin + count * stride)
    values = signal[blocks].reshape(count, stride).mean(axis=1)
    gone: np.ndarray = np.any(missing[blocks].reshape(count, stride), axis=1)
    own = slice((a - begin) // stride, -(-(b - begin) // stride))
    if np.count_nonzero(~gone) < 3 * _ORDER or own.stop > count:
        return signal[a:b], np.inf
    made, error = _least_error(values, gone)
    if stride == 1:
        return made[own], float(np.sqrt(np.mean(error[own] ** 2)))
    from scipy.interpolate import CubicSpline

    centres = begin + stride * (np.arange(count) + 0.5) - 0.5
    return CubicSpline(centres, made)(np.arange(a, b)), float(np.sqrt(np.mean(error[own] ** 2)))


def _least_error(values: np.ndarray, gone: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (n,) with those that are gone as a model predicts them best, and the standard errors (n,) of these."""
    made, n = values - np.mean(values[~gone]), values.size
    middle = np.mean(values[~gone])
    error = np.zeros(n)
    windows = np.lib.stride_tricks.sliding_window_view(np.arange(n), _ORDER + 1)
    whole = ~np.any(gone[windows], axis=1)
    rounds = 1 if np.count_nonzero(whole) >= 2 * _ORDER else _ROUNDS
    for _ in range(rounds):
        rows = made[windows[whole]] if rounds == 1 else made[windows]
        weights = np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=_SAME)[0]
        left = rows[:, -1] - rows[:, :-1] @ weights
        level = float(np.sqrt(np.sum(left**2) / max(1, left.size - _ORDER)))
        predicts = np.zeros((n - _ORDER, n))
        for k, weight in enumerate([*-weights, 1.0]):
            predicts[np.arange(n - _ORDER), np.arange(n - _ORDER) + k] = weight
        asked, known = predicts[:, gone], predicts[:, ~gone] @ made[~gone]
        inverse = np.linalg.pinv(asked.T @ asked)
        made[gone] = -inverse @ (asked.T @ known)
        error[gone] = level * np.sqrt(np.maximum(np.diag(inverse), 0.0))
    return made + middle, error


def spans(times: Iterable[tuple[float, float]], most: int = 5) -> str:
    """Spans of time in a sentence, in seconds: the first few, and how many more there are."""
    each = list(times)
    named = ", ".join(f"at {a:.4g}" if f"{a:.4g}" == f"{b:.4g}" else f"from {a:.4g} to {b:.4g}" for a, b in each[:most])
    return named + (f" s and {len(each) - most} more times" if len(each) > most else " s")

"""From time stamps to a uniform sampling rate: order, gaps, rounding and jitter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput

SAME_RATE = 1e-3  # relative: two statements of one rate; rates are often quoted to four digits
NEGLIGIBLE = 0.01  # intervals: time stamps this close to a uniform grid are that grid
TOLERABLE = 0.25  # intervals, rms of the steps: beyond it a spline between the samples is a guess ...
WITHIN_CYCLE = 0.01  # ... but not where it is a smaller part of the fastest channel's cycle
NEARLY_ALL = 0.99  # of a channel's power: what is faster is a tenth of its size at most, and noise
#: Cycles of the fastest channel: a cubic spline bridges that long a step to a thousandth of a sine, 5/384 (w h)^4 (Hall
#: and Meyer 1976).
BRIDGED = 1 / 12
LONE = 0.01  # of the steps: rarer odd ones are lost samples, not a rate that the rounding cannot show
GAP = 1.5  # medians: between one step and two
#: Hz, physical limit: nothing is sampled more slowly than once in a century, or faster than light swings.
RATES = (3e-10, 1e15)


@dataclass(frozen=True)
class Sampling:
    """Uniform sampling: `fs` in Hz, `start` in s, `columns` (n, k) on the uniform grid, and what was noticed."""

    fs: float
    start: float
    columns: np.ndarray
    notes: tuple[str, ...] = ()


def uniform_sampling(where: str, time: np.ndarray | None, fs: float | None, columns: np.ndarray) -> Sampling:
    """Return the columns on a uniform grid.

    `time` (n,) in s and `fs` in Hz: at least one is needed, and both must agree. Moderate jitter, and gaps that are
    short beside a cycle of the motion, are bridged with a cubic spline (a note says so). Raises BadInput when time does
    not increase, or its gaps or its jitter are larger.
    """
    if fs is not None and not (np.isfinite(fs) and fs > 0):
        raise BadInput(f"{where}: the sampling rate (--fs) is {fs:g} Hz; it must be a positive number")
    if len(columns) < 2:
        raise BadInput(f"{where} has {len(columns)} row(s) of numbers; a record needs at least 2")
    if time is None:
        if fs is None:
            raise BadInput(f"{where} has no time column; name it with --time, or give the sampling rate with --fs")
        return Sampling(_rate(where, fs, "--fs"), 0.0, columns)

    bad = np.flatnonzero(~np.isfinite(time))
    if len(bad):
        raise BadInput(
            f"{where}: the time column has {len(bad)} value(s) that are not a number, the first in row {bad[0] + 1} "
            "of the data; mend the time stamps, or leave the column out and give --fs"
        )
    if time[-1] <= time[0]:
        raise BadInput(f"{where}: time does not increase, it runs from {time[0]:g} s to {time[-1]:g} s; check --time")
    rate = (len(time) - 1) / (time[-1] - time[0])
    deviation = np.abs((time - time[0]) * rate - np.arange(len(time)))  # in intervals
    rounding = _rounding(time)
    notes: list[str] = []
    if deviation.max() > NEGLIGIBLE and not _only_rounded(time, rounding):
        _reject_disorder(where, time)
        size = _grid_size(time)
        if size > len(time) / BRIDGED:  # fewer than that a cycle are no motion, and the grid may not fit in memory
            _bridged(where, time, 0.0)
        grid = np.linspace(time[0], time[-1], size)
        cycle = _shortest_cycle(time, grid, columns)
        missing = _bridged(where, time, cycle)
        columns = _resampled(where, time, grid, columns, cycle, missing, notes)
        rate = (len(grid) - 1) / (time[-1] - time[0])
    else:
        rate = _plain_rate(rate, rounding / (time[-1] - time[0]))
        if deviation.max() > NEGLIGIBLE:
            notes.append(f"{where}: the time stamps are rounded to {rounding:.1g} s; taken as uniform at {rate:g} Hz")
    if fs is not None and abs(fs / rate - 1) > SAME_RATE:
        raise BadInput(
            f"{where}: --fs says {fs:g} Hz but the time column says {rate:.6g} Hz; leave --fs out, "
            "or check the unit of the time column"
        )
    return Sampling(_rate(where, rate, "the unit of the time column"), float(time[0]), columns, tuple(notes))


def _rate(where: str, rate: float, source: str) -> float:
    if not RATES[0] <= rate <= RATES[1]:
        raise BadInput(f"{where}: a sampling rate of {rate:.3g} Hz is none that a recorder has; check {source}")
    return rate


def _rounding(time: np.ndarray) -> float:
    """Return the decimal step that every time stamp is a multiple of, in s (0 if finer than 1e-9)."""
    for digits in range(10):
        if np.allclose(time, np.round(time, digits), rtol=0, atol=1e-3 * 10.0**-digits):
            return 10.0**-digits
    return 0.0


def _only_rounded(time: np.ndarray, rounding: float) -> bool:
    """Whether stamps of a uniform clock, rounded to `rounding` s, look so: 800 Hz in ms has the steps 1, 1, 1, 2.

    They stay within one rounding step of a straight line. So does a single lost sample, but that is a lone odd step.
    """
    index = np.arange(len(time))
    residual = time - np.polyval(np.polyfit(index, time, 1), index)
    step = np.diff(time)
    odd = np.count_nonzero(np.abs(step - np.median(step)) > 0.5 * rounding)
    return bool(np.ptp(residual) <= 1.05 * rounding and odd > LONE * len(step))


def _plain_rate(rate: float, uncertainty: float) -> float:
    """Return the shortest decimal within the relative `uncertainty` that rounded end stamps leave: 600, not 600.000005.

    Records of one set-up then share one rate.
    """
    for digits in range(7):
        plain = round(rate, digits)
        if abs(plain / rate - 1) <= uncertainty:
            return plain
    return float(rate)


def _reject_disorder(where: str, time: np.ndarray) -> None:
    step = np.diff(time)
    back = np.flatnonzero(step <= 0)
    if len(back):
        i = int(back[0])
        if np.all(time[back + 1] <= time[0] + np.median(step)):
            raise BadInput(
                f"{where}: time starts anew {len(back)} time(s), first in row {i + 2} of the data: the file holds "
                f"{len(back) + 1} runs; give each as a file of its own"
            )
        raise BadInput(
            f"{where}: time does not increase at {len(back)} place(s), first after {time[i]:g} s (row {i + 1} of the "
            f"data, the next stamp is {time[i + 1]:g} s); sort the rows or remove the repeated ones"
        )


def _grid_size(time: np.ndarray) -> int:
    """How many uniform times lead from the first stamp to the last, those at which a sample is missing among them."""
    step = np.diff(time)
    usual = float(np.mean(step[step <= GAP * np.median(step)])) if _gaps(step).size else float(np.mean(step))
    return max(2, round((time[-1] - time[0]) / usual) + 1)


def _gaps(step: np.ndarray) -> np.ndarray:
    """Which steps lack samples: lost ones only lengthen steps, where jitter shortens about as many."""
    median = float(np.median(step))
    gaps = np.flatnonzero(step > GAP * median)
    return gaps if gaps.size > 2 * np.count_nonzero(step < median / 2) else gaps[:0]


def _shortest_cycle(time: np.ndarray, grid: np.ndarray, columns: np.ndarray) -> float:
    """Of each channel the cycle below whose frequency nearly all its power is, in s: the shortest of them, or 0."""
    if not np.isfinite(columns).all():
        return 0.0
    lines = []
    for column in columns.T:
        even = np.interp(grid, time, column)
        power = np.cumsum(np.abs(np.fft.rfft((even - even.mean()) * np.hanning(even.size))) ** 2)
        lines.append(int(np.searchsorted(power, NEARLY_ALL * power[-1])))
    return float((grid[-1] - grid[0]) / max(lines)) if lines and max(lines) else 0.0


def _bridged(where: str, time: np.ndarray, cycle: float) -> str:
    """A clause on the samples that are missing, where there are any; refused where a gap is too long beside a cycle."""
    step = np.diff(time)
    gaps = _gaps(step)
    if not gaps.size:
        return ""
    missing = np.maximum(np.rint(step[gaps] / np.median(step)).astype(int) - 1, 1)
    longest = int(np.argmax(step[gaps]))
    if step[gaps[longest]] > BRIDGED * cycle:
        more = "" if len(gaps) == 1 else f", {missing.sum()} samples in {len(gaps)} gaps altogether"
        raise BadInput(
            f"{where}: gap in time after {time[gaps[longest]]:g} s, {missing[longest]} sample(s) are missing{more}; "
            "choose what lies on one side of it (--part FROM:TO), or give the parts as separate files"
        )
    return (
        f"{missing.sum()} sample(s) are missing in {len(gaps)} gap(s) of time, "
        f"{missing[longest]} of them after {time[gaps[longest]]:g} s, each short beside a cycle"
    )


def _resampled(
    where: str,
    time: np.ndarray,
    grid: np.ndarray,
    columns: np.ndarray,
    cycle: float,
    missing: str,
    notes: list[str],
) -> np.ndarray:
    step = np.diff(time)
    usual = step[step <= GAP * np.median(step)] if missing else step
    interval = (grid[-1] - grid[0]) / (len(grid) - 1)
    jitter = float(np.std(usual))
    if jitter > max(TOLERABLE * interval, WITHIN_CYCLE * cycle):
        raise BadInput(
            f"{where}: the time steps jitter by {100 * jitter / interval:.0f} % (rms) of {interval:.4g} s; "
            "record again with a hardware clock, or resample the file yourself"
        )
    if not np.isfinite(columns).all():
        return columns  # the check for numbers reports these; a spline would only spread them
    from scipy.interpolate import CubicSpline

    jittering = f"the time steps jitter by {100 * jitter / interval:.1f} % (rms)" if jitter else ""
    said = " and ".join(clause for clause in (missing, jittering) if clause)
    notes.append(f"{where}: {said}; resampled by cubic spline at {1 / interval:.6g} Hz")
    return CubicSpline(time, columns)(grid)

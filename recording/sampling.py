"""From time stamps to a uniform sampling rate: order, gaps, rounding and jitter."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

from ..errors import BadInput
from .continuity import edges_of, is_rough, is_switched
from .resolution import converter_step
from .time_stamps import EARLIEST, LATEST

SAME_RATE = 1e-3  # relative: two statements of one rate; rates are often quoted to four digits
NEGLIGIBLE = 0.01  # intervals: time stamps this close to a uniform grid are that grid
TOLERABLE = 0.25  # intervals, rms of the steps: beyond it a spline between the samples is a guess ...
WITHIN_CYCLE = 0.01  # ... but not where it is a smaller part of the fastest channel's cycle
NEARLY_ALL = 0.99  # of a channel's power: what is faster is a tenth of its size at most, and noise
LONE = 0.01  # of the steps: rarer odd ones are lost samples, not a rate that the rounding cannot show
HALF = 0.5  # of an interval, between one step and two; of all stamps; of what the steps of a converter err by
_STEADY = 4.0  # standard deviations of the steps: what jitter does in one of fifteen thousand
_HALVINGS = 30  # of an interval in which the rate lies: to a billionth of it
_MEDIAN = 0.6745  # of the sizes of Gaussian numbers of unit standard deviation
#: Samples that a cubic spline needs.
_OF_A_SPLINE = 4
#: Samples of a recording that may be missing for each that is there: where most are, it is several recordings.
_MOST_LOST = 11
#: Durations: four digits of a time that is larger leave more than a hundredth of the recording.
_A_CLOCK = 10.0
#: Hz, physical limit: nothing is sampled more slowly than once in a century, or faster than light swings.
RATES = (3e-10, 1e15)


@dataclass(frozen=True)
class Sampling:
    """Uniform sampling: `fs` in Hz, `start` in s, `columns` (n, k) on the uniform grid, and what was noticed.

    `start` is the first time stamp, or 0 where that is one of a clock that has run for long (an epoch, say).
    Columns are not a number where a sample is missing.
    """

    fs: float
    start: float
    columns: np.ndarray
    notes: tuple[str, ...] = ()


def uniform_sampling(where: str, time: np.ndarray | None, fs: float | None, columns: np.ndarray) -> Sampling:
    """Return the columns on a uniform grid.

    `time` (n,) in s and `fs` in Hz: at least one is needed, and both must agree. Moderate jitter is bridged with a
    cubic spline (a note says so); where stamps are missing, so are the samples. Of rows with one stamp the last is
    taken. Raises BadInput when time does not increase, or its jitter is larger.
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
    notes: list[str] = []
    rounding = _rounding(time)
    if _off_grid(time) > NEGLIGIBLE and not _only_rounded(time, rounding):
        time, columns = _once(where, time, columns, notes)
    rate, start = (len(time) - 1) / (time[-1] - time[0]), float(time[0])
    off = _off_grid(time)
    if off > NEGLIGIBLE and not _only_rounded(time, rounding):
        _reject_disorder(where, time)
        size = _grid_size(time)
        if size > (_MOST_LOST + 1) * len(time):  # and the grid may not fit in memory
            longest = int(np.argmax(np.diff(time)))
            raise BadInput(
                f"{where}: most of it is missing, {size - len(time)} of {size} samples, most after "
                f"{time[longest] - time[0]:g} s; choose what lies on one side of it (--part FROM:TO)"
            )
        grid = _grid(time, size)
        columns = _on_grid(where, time, grid, columns, notes)
        rate = (len(grid) - 1) / (grid[-1] - grid[0])
        start = float(grid[0])
    elif off > NEGLIGIBLE:
        rate, known = _rate_of_rounded(time, rounding)
        if fs is not None and abs(fs / rate - 1) <= known:
            rate, end = fs, ""
        else:
            end = f", which they tell to {100 * known:.2g} %, and frequencies no better; --fs states the rate"
        notes.append(f"{where}: the time stamps are rounded to {rounding:.1g} s; taken as uniform at {rate:g} Hz{end}")
    else:
        rate = _plain_rate(rate, rounding / (time[-1] - time[0]))
    if fs is not None and abs(fs / rate - 1) > SAME_RATE:
        raise BadInput(
            f"{where}: --fs says {fs:g} Hz but the time column says {rate:.6g} Hz; leave --fs out, "
            "or check the unit of the time column"
        )
    if abs(start) > _A_CLOCK * (time[-1] - time[0]):
        notes.append(f"{where}: the time stamps begin at {_as_read(start)}; counted from the first sample")
        start = 0.0
    return Sampling(_rate(where, rate, "the unit of the time column"), start, columns, tuple(notes))


def _as_read(start: float) -> str:
    """A time stamp, s, in words: as a date where it counts the seconds since 1970."""
    if not EARLIEST <= start <= LATEST:
        return f"{start:.10g} s"
    return f"{start:.10g} s since 1970 ({datetime.fromtimestamp(start, UTC):%Y-%m-%d %H:%M:%S} UTC)"


def _rate(where: str, rate: float, source: str) -> float:
    if not RATES[0] <= rate <= RATES[1]:
        raise BadInput(f"{where}: a sampling rate of {rate:.3g} Hz is none that a recorder has; check {source}")
    return rate


def _off_grid(time: np.ndarray) -> float:
    """How far stamps (n,) lie from uniform ones, at most, in intervals."""
    places = (time - time[0]) / (time[-1] - time[0]) * (len(time) - 1)
    return float(np.max(np.abs(places - np.arange(len(time)))))


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


def _rate_of_rounded(time: np.ndarray, rounding: float) -> tuple[float, float]:
    """The rate of a uniform clock whose stamps (n,), rounded or cut off to `rounding` s, are these, and how well known.

    Such stamps keep within one rounding step of a straight line. Those whose slopes allow it are an interval, for the
    range of what a line leaves is convex in its slope; of its rates the shortest decimal is taken, and how
    far it may be off is returned relative to it.
    """
    index = np.arange(len(time))

    def leaves(interval: float) -> float:
        return float(np.ptp(time - interval * index))

    middle, wide = float(np.polyfit(index, time, 1)[0]), 3.0 * rounding / (len(time) - 1)
    low, high = middle - wide, middle + wide
    for _ in range(_HALVINGS):
        first, second = low + (high - low) / 3.0, high - (high - low) / 3.0
        low, high = (low, second) if leaves(first) < leaves(second) else (first, high)
    middle = 0.5 * (low + high)
    most = max(rounding, leaves(middle)) * (1.0 + SAME_RATE)
    sides = []
    for way in (-wide, wide):
        inside, outside = 0.0, 1.0
        for _ in range(_HALVINGS):
            half = 0.5 * (inside + outside)
            inside, outside = (half, outside) if leaves(middle + half * way) <= most else (inside, half)
        sides.append(middle + outside * way)
    rate, known = 0.5 * (1.0 / sides[0] + 1.0 / sides[1]), 0.5 * (sides[1] - sides[0]) / middle
    plain = _plain_rate(rate, known)
    return plain, known + abs(plain / rate - 1)


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
            f"{where}: time does not increase at {len(back)} place(s), first after row {i + 1} of the data, "
            f"{time[i] - time[0]:g} s from the start, by {time[i + 1] - time[i]:g} s; sort the rows"
        )


def _grid_size(time: np.ndarray) -> int:
    """How many uniform times lead from the first stamp to the last, those at which a sample is missing among them."""
    step = np.diff(time)
    usual = float(np.mean(np.delete(step, _gaps(step)))) if _gaps(step).size else float(np.mean(step))
    return max(2, round((time[-1] - time[0]) / usual) + 1)


def _grid(time: np.ndarray, size: int) -> np.ndarray:
    """Uniform times of least squares: the jitter of the first and of the last stamp does not move all others."""
    step = np.diff(time)
    gaps, taken = _gaps(step), np.ones(step.size)
    taken[gaps] = np.rint(step[gaps] / np.mean(np.delete(step, gaps)))
    index = np.append(0.0, np.cumsum(taken))
    if index[-1] != size - 1:
        return np.linspace(time[0], time[-1], size)
    interval, start = np.polyfit(index, time - time[0], 1)
    return time[0] + start + interval * np.arange(size)


def _gaps(step: np.ndarray) -> np.ndarray:
    """Which steps lack samples: lost ones only lengthen steps, where jitter shortens about as many."""
    median = float(np.median(step))
    spread = float(np.median(np.abs(step - median))) / _MEDIAN
    longer = max(HALF * median, _STEADY * spread)
    gaps = np.flatnonzero(step > median + longer)
    return gaps if gaps.size > 2 * np.count_nonzero(step < median - longer) else gaps[:0]


def _shortest_cycle(time: np.ndarray, grid: np.ndarray, columns: np.ndarray) -> float:
    """Of each channel the cycle below whose frequency nearly all its power is, in s: the shortest of them, or 0."""
    lines = []
    for column in columns.T:
        there = np.isfinite(column)
        if not np.any(there):
            return 0.0
        even = np.interp(grid, time[there], column[there])
        power = np.cumsum(np.abs(np.fft.rfft((even - even.mean()) * np.hanning(even.size))) ** 2)
        lines.append(int(np.searchsorted(power, NEARLY_ALL * power[-1])))
    return float((grid[-1] - grid[0]) / max(lines)) if lines and max(lines) else 0.0


def _on_grid(where: str, time: np.ndarray, grid: np.ndarray, columns: np.ndarray, notes: list[str]) -> np.ndarray:
    """Columns (n, k) at the times of the grid, not a number where samples are missing."""
    step = np.diff(time)
    gaps = _gaps(step)
    usual = np.delete(step, gaps)
    interval = (grid[-1] - grid[0]) / (len(grid) - 1)
    jitter = float(np.std(usual))
    if jitter > max(TOLERABLE * interval, WITHIN_CYCLE * _shortest_cycle(time, grid, columns)):
        raise BadInput(
            f"{where}: the time steps jitter by {100 * jitter / interval:.0f} % (rms) of {interval:.4g} s; "
            "record again with a hardware clock, or resample the file yourself"
        )
    # a first or last stamp that wavers may lie beyond a grid of least squares
    nearest = np.clip(np.rint((time - grid[0]) / interval).astype(int), 0, len(grid) - 1)
    off = float(np.max(np.abs(time - grid[nearest])))
    if off <= NEGLIGIBLE * interval:  # the samples are those of the grid
        made = np.full((len(grid), columns.shape[1]), np.nan)
        made[nearest] = columns
        return made
    if np.any(np.isinf(columns)):
        return columns  # the check for numbers reports these; a spline would only spread them
    made, edges = np.empty((len(grid), columns.shape[1])), np.zeros(0, int)
    switched: list[int] = []
    coarse: list[int] = []
    for k, column in enumerate(columns.T):
        there = np.isfinite(column)
        if is_switched(column[there]) or is_rough(column[there]):  # a spline would ring at its edges
            made[:, k] = _nearest(time[there], column[there], grid)
            switched.append(k)
            edges = np.union1d(edges, edges_of(made[:, k]))
    for k, column in enumerate(columns.T):
        there = np.isfinite(column)
        if not np.any(there):  # the check for numbers reports it
            made[:, k] = np.nan
            continue
        if k not in switched:
            own = (time[there], column[there], grid)
            coarse += [k] if _steps_hide(column[there], (time - grid[nearest])[there] / interval) else []
            made[:, k] = _nearest(*own) if k in coarse else _between_edges(*own, grid[edges])
        at = np.searchsorted(time[there], grid)
        before, after = time[there][np.maximum(at - 1, 0)], time[there][np.minimum(at, np.count_nonzero(there) - 1)]
        lost = after - before > np.median(step) + max(HALF * np.median(step), _STEADY * jitter)
        made[lost & (np.minimum(grid - before, after - grid) > HALF * interval), k] = np.nan
    if jitter:
        notes.append(
            f"{where}: the time steps jitter by {100 * jitter / interval:.1f} % (rms); "
            f"resampled by cubic spline at {1 / interval:.6g} Hz"
            + (", a signal in steps larger than that moves it by the nearest stamp" if coarse else "")
        )
    return made


def _nearest(time: np.ndarray, column: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """(m,) the sample (n,) whose stamp is nearest to each time of the grid."""
    return np.asarray(column[np.rint(np.interp(grid, time, np.arange(time.size))).astype(int)])


def _steps_hide(column: np.ndarray, off: np.ndarray) -> bool:
    """Whether the steps of a converter hide what its stamps are off by: (n,) samples, and sample intervals.

    Between such steps a spline would show a signal without any, and as quiet as if it were known better. What moves it
    by half of what a step errs by adds an eighth to that.
    """
    moved = float(np.sqrt(np.mean(np.diff(column) ** 2) * np.mean(off**2))) if column.size > 1 else 0.0
    return moved < HALF * converter_step(column) / np.sqrt(12.0)


def _between_edges(time: np.ndarray, column: np.ndarray, grid: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """(m,) a channel (n,) at the times of the grid: a cubic spline of its own between the times at which another leaps.

    A mass that a force drives in steps accelerates in steps: a spline through them rings on either side. A sample so
    near to an edge that its stamp does not say the side is left out.
    """
    from scipy.interpolate import CubicSpline

    if column.size < 2:
        return np.full(grid.size, np.nan)
    vague = NEGLIGIBLE * (grid[-1] - grid[0]) / (grid.size - 1)
    parts, after = (np.searchsorted(edges, time + off, "right") for off in (-vague, vague))
    made, places = np.empty(grid.size), np.searchsorted(edges, grid, "right")
    for part in np.unique(places):
        own = (parts == part) & (after == part)
        if np.count_nonzero(own) < _OF_A_SPLINE:  # a dwell of a few samples tells no curve
            own = np.ones(time.size, bool)
        made[places == part] = CubicSpline(time[own], column[own])(grid[places == part])
    return made


def _once(where: str, time: np.ndarray, columns: np.ndarray, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Rows without those whose stamp the next one repeats: a discontinuity, before and after it, or a row once more.

    What holds from the stamp on is the last of them, as in FMI 3.0, 2.2.1 (events). A clock that is too coarse repeats
    stamps too, often, and then every channel goes on.
    """
    again, same = time[1:] == time[:-1], columns[1:] == columns[:-1]
    goes_on = again & ~np.any(same, axis=1)
    if not np.any(again) or np.count_nonzero(goes_on) > LONE * time.size:
        return time, columns
    again, alike = np.append(again, False), np.append(np.all(same, axis=1), False)
    jumps, copies = np.count_nonzero(again & ~alike), np.count_nonzero(again & alike)
    said = [f"{jumps} discontinuities stand in two rows with one time stamp, and hold from it on"] if jumps else []
    said += [f"{copies} row(s) are written twice, and taken once"] if copies else []
    notes.append(f"{where}: {'; '.join(said)}")
    return time[~again], columns[~again]

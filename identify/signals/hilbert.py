"""The analytic signal of a finite recording: envelope, instantaneous frequency and their derivatives.

The discrete Hilbert transform takes the recording as one period of a periodic signal, so a decay, which starts at full
size and ends at nothing, is bent near both ends, and differentiating its phase blows the noise up. Four things mend it:

* un-decay: the recording is multiplied by exp(+h t) first, and the factor is taken out of the derivatives afterwards;
* both ends are continued by the recording's own neighbouring cycle, scaled to fit;
* the analytic signal is turned back by a smooth carrier phase and low-passed there, where it is slow, with a kernel
  that has no transmission one frequency further (the harmonics and what is left of an offset);
* the derivatives are those of that kernel, so nothing is differenced.

Theory: Feldman, Bucher, Rotberg 2009, section 4.1 and Eq. 9 (whose cross term is `2 i (A'/A) psi'`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ...recording.resolution import converter_step
from ...recording.smoothing import convolved, harris
from .limits import DECAY_CYCLES, DECAY_FLOOR, DECAY_PART, FEWEST_CYCLES
from .registry import budget, numerics

_END_PART = numerics(50, "of a record", why="the level of either end is taken over one of so many parts")
_SHORTEST = numerics(16, "samples", why="of a padded transform")
_SLOWEST = numerics(1.5, "cycles", why="the slowest line has one and a half in the record")
_HALF_A_BIN = numerics(0.5, "bins", why="the largest lies no farther from the bin that shows it")
_SEGMENT = numerics((64, 1024), "samples", why="of the segments of a periodogram, at least and at most")
_SEGMENTS = numerics(16, "segments", why="that an averaged periodogram has between them")
_FEWEST_LINES = numerics(4, "lines", why="of which a median is taken")
_INDEPENDENT = numerics(
    1.6, "segments a length", why="independent ones among those that overlap by half under this window"
)
STEP_NOISE = numerics(float(np.sqrt(12.0)), "steps a standard deviation", why="of a value that is rounded evenly")
_MOST_FALL = numerics(25.0, "natural logarithm", why="noise at the far end must stay a number")
_DRIFT = numerics(3, "times slower than the motion", why="what is slower fades out as drift")
_KNOT = numerics(8, "cycles a knot, and samples a cycle", why="a carrier is smooth over several cycles")

LONG = budget(2**18, "samples", why="something less says as much, where an answer is not meant for the last digit")
_FURTHER_PASSES = budget(
    2, "passes", why="after one the knots of the first carrier still show: 6e-5 of omega0² on the built-in rig"
)
KERNEL_CYCLES = numerics(
    3.0, "cycles", why="the shortest Blackman kernel that has its first zero one carrier frequency away"
)


@dataclass(frozen=True)
class AnalyticSignal:
    """Slow part of the analytic signal `X = A exp(i psi)` of a recording, by sample; every field has shape (n,)."""

    time: np.ndarray  # s, from the first sample
    amplitude: np.ndarray  # A, unit of the recording
    phase: np.ndarray  # psi, rad, unwrapped
    omega: np.ndarray  # psi', rad/s
    growth: np.ndarray  # A'/A, 1/s
    curvature: np.ndarray  # A''/A, 1/s2
    chirp: np.ndarray  # psi'', rad/s2
    slow: np.ndarray  # complex: the un-decayed signal as turned back by `carrier` and low-passed
    carrier: np.ndarray  # rad
    equation_first: np.ndarray  # X'/X, complex, as an equation of motion under the low-pass has it: see `_passed`
    equation_second: np.ndarray  # X''/X, likewise
    undecay: float  # 1/s
    kernel: int  # samples of the low-pass kernel
    period: float  # samples a cycle that it was made for


def dominant_frequency(x: np.ndarray, fs: float) -> float:
    """Frequency in Hz of the largest line in the spectrum of `x` (n,) at `fs` Hz, interpolated between bins.

    Raises BadInput when `x` is constant or shorter than two cycles.
    """
    x = np.asarray(x, float)
    x = x - np.linspace(np.mean(x[: max(1, x.size // _END_PART)]), np.mean(x[-max(1, x.size // _END_PART) :]), x.size)
    size = 2 ** int(np.ceil(np.log2(max(_SHORTEST, 2 * x.size))))
    power = np.abs(np.fft.rfft(x * np.hanning(x.size + 2)[1:-1] ** 0.25, size)) ** 2
    slowest = max(1, int(np.ceil(_SLOWEST * size / x.size)))  # at least one and a half cycles must fit
    if power.size <= slowest + 2 or not np.any(power[slowest:] > 0):
        raise BadInput("No oscillation found: the recording is constant or shorter than two cycles; record more of it.")
    k = min(slowest + int(np.argmax(power[slowest:-1])), power.size - 2)
    a, b, c = (np.log(power[k + j] + 1e-300) for j in (-1, 0, 1))
    bend = a - 2 * b + c
    top = 0.5 * (a - c) / bend if bend < 0 else 0.0
    return (k + float(np.clip(top, -_HALF_A_BIN, _HALF_A_BIN))) * fs / size


def noise_level(x: np.ndarray, fs: float) -> float:
    """Standard deviation of the white noise on `x` (n,), from the median of the upper quarter of its spectrum.

    It is at least that of the converter's steps, which a motion of few steps follows so slowly that it shows less.

    The signal must be sampled at 10 samples a cycle or more, so that it has nothing but noise up there.
    """
    x = np.asarray(x, float)
    size = min(x.size, max(_SEGMENT[0], min(_SEGMENT[1], x.size // _SEGMENTS)))
    lines = size // 2 + 1
    first = int(0.75 * lines)
    if lines - 1 - first < _FEWEST_LINES:
        return 0.0
    top = welch(x, fs, harris(size, periodic=True))[first:-1]
    # periodograms averaged over few segments: the median lies below the mean (chi-square with about 2 K degrees)
    segments = max(1.0, _INDEPENDENT * x.size / size)
    median_to_mean = (1 - 1 / (9 * segments)) ** 3
    return max(float(np.sqrt(np.median(top) / median_to_mean * fs / 2)), converter_step(x) / STEP_NOISE)


def welch(x: np.ndarray, fs: float, window: np.ndarray) -> np.ndarray:
    """(size // 2 + 1,) spectral density of a signal (n,) at ``fs`` Hz, in its unit squared per Hz (Welch 1967).

    Averaged over segments under a window (size,), which overlap by half and have a straight line taken off.
    """
    size = window.size
    segments = np.lib.stride_tricks.sliding_window_view(x, size)[:: size - size // 2]
    place = np.linspace(-1.0, 1.0, size)
    total, at_once = np.zeros(size // 2 + 1), max(1, 2**16 // size)
    for begin in range(0, len(segments), at_once):
        part = segments[begin : begin + at_once]
        part = part - np.mean(part, axis=1, keepdims=True)
        part -= (part @ place)[:, None] * (place / (place @ place))
        total += np.sum(np.abs(np.fft.rfft(part * window, axis=1)) ** 2, axis=0)
    density = total / (len(segments) * fs * np.sum(window**2))
    density[1 : -1 if size % 2 == 0 else None] *= 2.0
    return density


def analytic_signal(
    x: np.ndarray,
    fs: float,
    *,
    undecay: float | None = None,
    kernel_cycles: float = KERNEL_CYCLES,
    frequency: float | None = None,
    by_kernel: bool = False,
) -> AnalyticSignal:
    """Analytic signal of `x` (n,), sampled at `fs` Hz, with its smoothed derivatives (Eq. 9).

    `undecay`: 1/s, the h of the exp(+h t) applied first; None takes it from the fall of the envelope (0 when it does
    not fall). `kernel_cycles`: length of the low-pass kernel in cycles of the dominant frequency.
    `frequency`: that one in Hz, where it is known already.
    `by_kernel`: the kernel alone, which has no transmission at twice the carrier either, takes the negative frequencies
    away. The Hilbert transform, whose tails reach the continuation from everywhere, then only makes the carrier; half a
    kernel from the ends nothing but the recording is left in the result.
    Raises BadInput when there are fewer than five cycles or fewer than five samples a cycle.
    Near the ends, within half a kernel, the values lean on the continuation: cut them before use.
    """
    x = np.asarray(x, float)
    f = dominant_frequency(x, fs) if frequency is None else frequency
    period = fs / f
    if x.size < FEWEST_CYCLES * period or period < FEWEST_CYCLES:
        raise BadInput(
            f"The strongest line swings {x.size / period:.1f} times in it, each over {period:.1f} samples; the Hilbert "
            "transform needs at least 5 cycles of at least 5 samples: record longer or sample faster."
        )
    t = np.arange(x.size) / fs
    if undecay is None:
        undecay = _mean_decay(x, period, fs)
    undecay = float(np.clip(undecay, 0.0, _MOST_FALL / t[-1]))  # noise at the far end must stay a number
    y = (x - _rest(x[-max(x.size // 2, int(np.ceil(KERNEL_CYCLES * period))) :] if undecay else x)) * np.exp(
        undecay * t
    )
    pad = int(np.ceil((kernel_cycles + 2) * period))
    y = _continued(y, period, pad)
    X = _hilbert(y, f / fs)
    carrier, rate, turn = _carrier(X, period, fs)
    length = round(kernel_cycles * period)
    X = 2.0 * y.astype(complex) if by_kernel else X
    # each further pass turns by the phase that the one before found: what is left at last is the envelope alone
    z, first, second = _derivatives(X, carrier, rate, turn, fs, length)
    for _ in range(_FURTHER_PASSES):
        phase = carrier + np.unwrap(np.angle(z))
        if by_kernel:
            phase = _own_ends(phase, pad + length // 2, length)
        carrier, rate, turn = _smooth_phase(phase, fs, length)
        z, first, second = _derivatives(X, carrier, rate, turn, fs, length)
    phase = carrier + np.unwrap(np.angle(z))
    passed = _passed(X, carrier, rate, turn, fs, length)
    keep = slice(pad, pad + x.size)
    z, phase = z[keep], phase[keep]
    first, second = _decaying(first[keep], second[keep], undecay)
    passed = _decaying(passed[0][keep], passed[1][keep], undecay)
    growth, omega = np.real(first), np.imag(first)
    return AnalyticSignal(
        time=t,
        amplitude=np.abs(z) * np.exp(-undecay * t),
        phase=phase,
        omega=omega,
        growth=growth,
        curvature=np.real(second) + omega**2,
        chirp=np.imag(second) - 2 * growth * omega,
        slow=z,
        carrier=carrier[keep],
        equation_first=passed[0],
        equation_second=passed[1],
        undecay=undecay,
        kernel=length,
        period=period,
    )


def turned_alike(y: np.ndarray, fs: float, signal: AnalyticSignal, by_kernel: bool = False) -> np.ndarray:
    """`Y/X` (n,), complex: the analytic signal of `y` (n,), turned and low-passed exactly as that of `signal`, over it.

    What holds between the two recordings, such as an equation of motion, then holds between what passed of them.
    """
    pad = int(np.ceil(signal.kernel + 2 * signal.period))
    Y = _hilbert(
        _continued((y - np.mean(y)) * np.exp(signal.undecay * signal.time), signal.period, pad), 1 / signal.period
    )
    Y = 2.0 * np.real(Y) if by_kernel else Y
    turned = Y[pad : pad + y.size] * np.exp(-1j * signal.carrier)
    return _low_pass(turned, fs, signal.kernel)[0] / signal.slow


def blackman(length: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Blackman kernel of unit sum over `length` samples (made odd), with its first and second derivative per sample."""
    half = max(2, length // 2)
    u = np.arange(-half, half + 1) / (half + 0.5)
    w = 0.42 + 0.5 * np.cos(np.pi * u) + 0.08 * np.cos(2 * np.pi * u)
    dw = -np.pi * (0.5 * np.sin(np.pi * u) + 0.16 * np.sin(2 * np.pi * u)) / (half + 0.5)
    ddw = -(np.pi**2) * (0.5 * np.cos(np.pi * u) + 0.32 * np.cos(2 * np.pi * u)) / (half + 0.5) ** 2
    scale = 1 / w.sum()
    k = np.arange(-half, half + 1)
    # exact on polynomials: the first kernel must give the slope of a line, the second the bend of a parabola
    dw = -dw / np.sum(dw * k)
    ddw = ddw - ddw.sum() * scale * w
    ddw = 2 * ddw / np.sum(ddw * k**2)
    return w * scale, dw, ddw


def _derivatives(
    X: np.ndarray, carrier: np.ndarray, rate: np.ndarray, turn: np.ndarray, fs: float, length: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`X` turned back by the carrier and low-passed, and X'/X and X''/X of what passed, the carrier put on again."""
    z, dz, ddz = _low_pass(X * np.exp(-1j * carrier), fs, length)
    z = np.where(np.abs(z) > 1e-300, z, 1e-300)
    first = dz / z + 1j * rate
    return z, first, ddz / z + 2j * rate * dz / z - rate**2 + 1j * turn


def _passed(
    X: np.ndarray, carrier: np.ndarray, rate: np.ndarray, turn: np.ndarray, fs: float, length: int
) -> tuple[np.ndarray, np.ndarray]:
    """What passes of X' and of X'', over what passes of X, the derivatives taken before the low-pass.

    Taken behind it (`_derivatives`), they are those of the motion that is seen. Taken before, by parts on the kernel,
    they go with a force and with laws that are low-passed alike, however fast the frequency runs within the kernel.
    """
    Z = X * np.exp(-1j * carrier)
    z, dz, ddz = _low_pass(Z, fs, length)
    slow, dslow, _ = _low_pass(rate * Z, fs, length)
    z = np.where(np.abs(z) > 1e-300, z, 1e-300)
    bent = _low_pass((1j * turn + rate**2) * Z, fs, length)[0]
    return np.asarray((dz + 1j * slow) / z), np.asarray((ddz + 2j * dslow - bent) / z)


def _decaying(first: np.ndarray, second: np.ndarray, undecay: float) -> tuple[np.ndarray, np.ndarray]:
    """X'/X and X''/X of a motion from those of the same times exp(undecay t)."""
    return first - undecay, second - 2 * undecay * first + undecay**2


def _own_ends(phase: np.ndarray, edge: int, length: int) -> np.ndarray:
    """A phase (n,) whose ends, `edge` samples each, go on as a cubic through the next `length`, then straight."""
    if phase.size < 2 * (edge + length):
        return phase
    out = phase
    for _ in range(2):  # the start, then the end turned round
        place = np.arange(edge + length, dtype=float)
        cubic = np.polynomial.Polynomial.fit(place[edge:], out[edge : edge + length], 3)
        far = float(max(0, edge - length))
        ahead = np.maximum(place[:edge], far)
        out = np.concatenate([cubic(ahead) + cubic.deriv()(far) * (place[:edge] - ahead), out[edge:]])[::-1]
    return out


def _smooth_phase(phase: np.ndarray, fs: float, length: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A phase (n,) under the kernel, with its two derivatives, so that no corner is left in it."""
    place = np.arange(phase.size, dtype=float)
    line = np.polynomial.Polynomial.fit(place, phase, 3)  # taken out first: the kernel bends a parabola at its ends
    half = length // 2 + 1
    rest = phase - line(place)
    rest = np.pad(rest, half, mode="reflect", reflect_type="odd")
    smooth, slope, bend = (values[half:-half] for values in _low_pass(rest, fs, length))
    return smooth + line(place), slope + line.deriv(1)(place) * fs, bend + line.deriv(2)(place) * fs**2


def _low_pass(Z: np.ndarray, fs: float, length: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    w, dw, ddw = blackman(length)
    z, dz, ddz = (convolved(Z, k) for k in (w, dw, ddw))
    return z, dz * fs, ddz * fs**2


def _rest(x: np.ndarray) -> float:
    """The middle of a motion (n,), weighed so that whole cycles and parts of one say nothing.

    A plain mean holds the part of a cycle that is left over: a line beside the motion's own, larger once un-decayed.
    """
    weight = np.blackman(x.size + 2)[1:-1]
    return float(weight @ x / np.sum(weight))


def _mean_decay(x: np.ndarray, period: float, fs: float) -> float:
    """Rate 1/s at which the energy of the recording falls, 0 where it does not."""
    cycles = int(x.size // period)
    step = int(period)
    rms = np.array([np.std(x[i * step : (i + 1) * step]) for i in range(cycles)])
    top = int(np.argmax(rms))
    floor = max(DECAY_FLOOR * float(np.min(rms)), DECAY_PART * float(rms[top]))
    stop = top + int(np.argmax(rms[top:] < floor)) if np.any(rms[top:] < floor) else cycles
    if stop - top < DECAY_CYCLES or top > cycles // DECAY_CYCLES:
        return 0.0
    return max(0.0, -float(np.polyfit(np.arange(stop - top) * step / fs, np.log(rms[top:stop]), 1)[0]))


def _continued(y: np.ndarray, period: float, pad: int) -> np.ndarray:
    """`y` with `pad` samples before and after it, each end going on with its own last cycle, tapered to zero."""
    before = _forward(y[::-1], period, pad)[::-1]
    return np.concatenate([before, y, _forward(y, period, pad)])


def _forward(y: np.ndarray, period: float, pad: int) -> np.ndarray:
    """`pad` samples after the end of `y`: its last cycle again and again, with the lag and factor that fit best."""
    from scipy.interpolate import CubicSpline

    last = y[-int(np.ceil(3.5 * period)) :]
    place = np.arange(last.size) - (last.size - 1)
    curve = CubicSpline(place, last)
    cycle = place[-int(np.ceil(period)) :]
    best = (np.inf, period, 1.0)
    for lag in period * np.linspace(0.85, 1.15, 121):
        before = curve(cycle - lag)
        energy = float(before @ before)
        factor = float(before @ last[-cycle.size :]) / energy if energy > 0 else 0.0
        misfit = float(np.sum((last[-cycle.size :] - factor * before) ** 2))
        if misfit < best[0]:
            best = (misfit, float(lag), factor)
    _, lag, factor = best
    factor = float(np.clip(factor, 1 / 2, 2.0))
    ahead = np.arange(1, pad + 1)
    turns = np.ceil(ahead / lag)
    taper = np.clip((pad - ahead) / (2 * period), 0, 1)
    return factor**turns * curve(ahead - turns * lag) * np.sin(0.5 * np.pi * taper) ** 2


def _hilbert(y: np.ndarray, f: float) -> np.ndarray:
    """Analytic signal by FFT; what is slower than a third of `f` (cycles per sample) fades out as drift."""
    from scipy.fft import fft, ifft, next_fast_len

    size = int(next_fast_len(y.size) or y.size)
    spectrum = np.asarray(fft(y, size))
    k = np.arange(size) / size
    gain = np.where(k < 1 / 2, 2.0, 0.0) * np.sin(0.5 * np.pi * np.clip(k / (f / _DRIFT), 0, 1)) ** 2
    return np.asarray(ifft(spectrum * gain))[: y.size]


def _carrier(X: np.ndarray, period: float, fs: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smooth phase near that of `X`, rad, with its two derivatives: a spline with a knot every eight cycles."""
    from scipy.interpolate import make_lsq_spline

    n = X.size
    phase = np.unwrap(np.angle(X))
    weight = np.sqrt(np.abs(X) / np.max(np.abs(X)) + 1e-3)
    # averaged over a quarter cycle: enough for a carrier, and the spline fit stays small
    step = max(1, int(period / _KNOT))
    place = np.arange(0, n, step, dtype=float)
    pieces = max(1, int(n / (_KNOT * period)))
    knots = np.concatenate([[0.0] * 4, np.linspace(0, n - 1, pieces + 1)[1:-1], [float(n - 1)] * 4])
    place[-1] = n - 1
    index = place.astype(int)
    spline = make_lsq_spline(place, phase[index], knots, k=3, w=weight[index])
    k = np.arange(n)
    return spline(k), spline(k, 1) * fs, spline(k, 2) * fs**2

"""A stretch of motion as the Hilbert transform sees it, and how its sensors' noise reaches what is fitted to it.

Every number that is fitted to the instantaneous modal parameters is, to first order, a weighted sum of the noise of the
samples. The weights are followed backwards through both low-passes to the samples themselves; the covariance is then
that of white noise, with no guess at how many independent points a smooth curve holds.

To first order a disturbance dX of the analytic signal (and dF of the force's) leaves in the equation of motion

    de = (dX'' + 2 h dX' + omega0² dX - dF/m) / X,
    d(omega0²) = -Re de + (A'/A) Im de / omega,    d(2h) = -Im de / omega.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...files.computed_once import computed_once
from ...recording.smoothing import convolved
from ..signals.hilbert import KERNEL_CYCLES, AnalyticSignal, analytic_signal, blackman, turned_alike
from ..signals.limits import DECAY_CYCLES
from ..signals.registry import numerics
from ..signals.signals import Signal
from .limits import CLEAR, CUT_CYCLES, LEAST_FREQUENCY, LEAST_NOISE

_ADVICE = "let it ring longer or release it from a larger amplitude"
LOW_PASS_CYCLES = numerics(2.0, "cycles", why="of the last low-pass, which has no transmission at twice the frequency")
_SMOOTH = numerics(
    6, "degree", why="of the polynomial in time that follows the logarithm of an amplitude closely enough to weigh with"
)


@dataclass(frozen=True, eq=False)
class Stretch:
    """A decay or a driven stretch; `inside` are its samples but for the ends, `keep` those that are left low-passed."""

    signal: AnalyticSignal  # of the displacement
    fs: float
    noise: float  # standard deviation, unit of the displacement
    low_pass_kernel: np.ndarray
    inside: slice
    ratio: np.ndarray | None = None  # F/X, complex
    force_noise: float = 0.0
    rung_in: int = 0  # so many low-passed values at the beginning hold the rig's own ringing beside the driven motion
    run_out: int = 0  # so many of the last that stand clear of a decay's noise lean on where friction stopped it

    @property
    def keep(self) -> slice:
        """The samples at which low-passed values are known."""
        half = self.low_pass_kernel.size // 2
        return slice(self.inside.start + half, self.inside.stop - half)

    def low_pass(self, values: np.ndarray) -> np.ndarray:
        """(..., n) by sample to (..., k) at `keep`."""
        return convolved(values[..., self.inside], self.low_pass_kernel, "valid")

    def before_low_pass(self, weights: np.ndarray) -> np.ndarray:
        """Weights (..., k) of low-passed values as weights (..., n) of the values by sample."""
        out = np.zeros((*weights.shape[:-1], self.signal.time.size), weights.dtype)
        out[..., self.inside] = convolved(weights, self.low_pass_kernel, "full")
        return out

    @computed_once
    def clear(self) -> np.ndarray:
        """Where, of `keep`, the motion stands clear of its noise: (k,) of bool.

        A decay that came down to its noise is not clear again.
        """
        s, keep = self.signal, self.keep
        level = CLEAR * self.noise * float(np.sqrt(2 * np.sum(blackman(s.kernel)[0] ** 2)))
        clear = (s.amplitude[keep] > level) & (s.omega[keep] > 0)
        if self.ratio is None and not np.all(clear):
            first = int(np.argmax(clear))
            clear[first + int(np.argmin(clear[first:])) :] = False
        clear[: self.rung_in] = False
        if self.run_out:
            clear[np.flatnonzero(clear)[-self.run_out :]] = False
        return clear

    @computed_once
    def width(self) -> float:
        """Mean square width, s², of the kernel that the analytic signal was low-passed with."""
        w = blackman(self.signal.kernel)[0]
        return float(np.sum(w * (np.arange(w.size) - w.size // 2) ** 2)) / self.fs**2

    @computed_once
    def _unbent(self) -> np.ndarray:
        """(n,) what the low-pass took off the motion by its (un-decayed) curvature, as a factor to put it back."""
        s = self.signal
        bent = s.curvature + 2 * s.undecay * s.growth + s.undecay**2
        smooth = self.low_pass(bent)  # the second derivative is the noisiest of all
        if self.ratio is None:  # a decay bends at its ends as it does beside them
            bent = np.pad(smooth, (self.keep.start, bent.size - self.keep.stop), mode="edge")
        else:
            bent[self.keep] = smooth
        return 1 - 0.5 * self.width * bent

    @computed_once
    def amplitude(self) -> np.ndarray:
        """(n,) envelope by sample, before the low-pass."""
        return self.signal.amplitude * np.maximum(self._unbent, _LEAST_UNBENT)

    @computed_once
    def smooth_amplitude(self) -> np.ndarray:
        """(n,) envelope without the noise of its neighbours: a polynomial of its logarithm over the clear motion.

        What weighs the points must not share their noise: 1/A, noisy, is off to the same side as the point itself.
        """
        if self.ratio is not None or not np.any(self.clear):
            return self.amplitude
        clear = np.flatnonzero(self.clear) + self.keep.start
        quarter = int(self.signal.period / 4)
        asked = clear[:: max(1, quarter)]
        degree = min(_SMOOTH, asked.size - 1)  # of a few cycles
        fit = np.polynomial.Polynomial.fit(asked, np.log(self.amplitude[asked]), degree, w=self.amplitude[asked])
        half = self.low_pass_kernel.size // 2
        place = np.clip(np.arange(self.amplitude.size), clear[0] - half, clear[-1] + half)
        return np.exp(fit(place))

    @computed_once
    def smooth_motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Envelope and phase (k,) at `keep`, low-passed: without the ripple that the negative frequencies leave."""
        s, keep = self.signal, self.keep
        level, beside = self.low_pass(np.stack([self.amplitude * np.exp(s.undecay * s.time), s.phase - s.carrier]))
        return level * np.exp(-s.undecay * s.time[keep]), beside + s.carrier[keep]

    def passed(self, factor: np.ndarray, motion: np.ndarray | float = 1.0) -> np.ndarray:
        """What passes the first low-pass of `factor` (p, n) times X times `motion` (n,), over what passes of X.

        Of `motion` itself what passes is known: 1, or `equation_first`. Only the factor's variation is asked here.
        """
        s = self.signal
        moving = np.broadcast_to(motion * s.slow * self._unbent, s.slow.shape)
        rows = np.concatenate([factor * moving, moving[None]])
        whole = convolved(rows, blackman(s.kernel)[0])
        return whole[:-1] / whole[-1] * motion

    def point_variance(
        self, squared: np.ndarray, damping: np.ndarray, inverse_mass: float, slope: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """Variance (k,) of low-passed omega0² at `keep` from the sensors' noise; of 2 h it is this over omega².

        Args:
            squared, damping: omega0² (n,) and h (n,), by sample.
            inverse_mass: 1/kg; 0 without a force.
            slope: d(omega0²)/d ln A, or 1j omega d(2 h)/d ln A, (n,) of the law to which the value is to be compared.
        """
        first, zeroth = (values[self.keep] for values in self.of_displacement(squared, damping))
        zeroth = zeroth + (slope[self.keep] if isinstance(slope, np.ndarray) else slope)
        w, dw, ddw = blackman(self.signal.kernel)
        w, dw, ddw = (np.convolve(kernel, self.low_pass_kernel) for kernel in (w, dw * self.fs, ddw * self.fs**2))
        moved = np.sum(ddw**2) + np.abs(first) ** 2 * np.sum(dw**2) + np.abs(zeroth) ** 2 * np.sum(w**2)
        moved = moved + 2 * np.real(zeroth) * np.sum(ddw * w)
        drive = (self.force_noise * inverse_mass) ** 2 * np.sum(w**2)
        return 2 * (self.noise**2 * moved + drive) / self.signal.amplitude[self.keep] ** 2

    def shared_noise(self, squared: np.ndarray, damping: np.ndarray, inverse_mass: float) -> np.ndarray:
        """What the low-passed equation of motion over X shares of its noise with what is put into it, (4, k) complex.

        Means at `keep` of the equation's error times the conjugate of the noise of low-passed dX/X, d(X'/X) and dF/X,
        and of dX/X by sample, which makes the weights; arguments as `point_variance` has them.
        """
        first, zeroth = (values[self.keep] for values in self.of_displacement(squared, damping))
        kernels, low = blackman(self.signal.kernel), self.low_pass_kernel
        w, dw, ddw = (np.convolve(kernel, low) for kernel in kernels)
        dw, ddw = dw * self.fs, ddw * self.fs**2
        by_sample = np.pad(kernels[0], low.size // 2)
        over = 2 / self.signal.amplitude[self.keep] ** 2
        place, weight = (over * self.noise**2 * (np.sum(ddw * k) + zeroth * np.sum(w * k)) for k in (w, by_sample))
        growth = self.signal.growth[self.keep] + self.signal.undecay
        speed = over * self.noise**2 * first * np.sum(dw**2) - growth * place
        return np.stack([place, speed, -over * inverse_mass * self.force_noise**2 * np.sum(w**2), weight])

    def of_displacement(self, squared: np.ndarray, damping: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The factors (n,) of the un-decayed z' and z itself in the equation of motion, that of z'' being 1."""
        s = self.signal
        u, w = s.undecay, s.omega
        first = 2j * w - 2 * u + 2 * damping
        zeroth = -(w**2) + 1j * s.chirp + u**2 - 2j * w * u + 2 * damping * (1j * w - u) + squared
        return first, zeroth

    def noise_weights(
        self,
        equation: np.ndarray,
        amplitude: np.ndarray,
        squared: np.ndarray,
        damping: np.ndarray,
        inverse_mass: float = 0.0,
    ) -> tuple[np.ndarray, np.ndarray]:
        """How the noise of each sample of displacement and force, (p, n) both, enters p numbers.

        Args:
            equation: (p, n), complex; each number changes by the real part of its sum with de.
            amplitude: (p, n), real; and by its sum with dA/A.
            squared, damping: omega0² (n,) and h (n,), by sample.
            inverse_mass: 1/kg.
        """
        s = self.signal
        first, zeroth = self.of_displacement(squared, damping)
        kernels = blackman(s.kernel)
        back = np.exp(s.undecay * s.time - 1j * s.carrier)

        def to_samples(weights: np.ndarray, kernel: np.ndarray) -> np.ndarray:
            return convolved(weights / s.slow, kernel[::-1])

        moved = to_samples(equation * zeroth + amplitude, kernels[0])
        moved = moved + to_samples(equation * first, kernels[1]) * self.fs
        moved = moved + to_samples(equation, kernels[2]) * self.fs**2
        drive = np.zeros(equation.shape)
        if self.ratio is not None:
            drive = 2 * np.real(to_samples(-inverse_mass * equation, kernels[0]) * back)
        return 2 * np.real(moved * back), drive


def free_stretch(decay: Signal) -> Stretch:
    """The displacement of a free decay.

    Raises:
        BadInput: fewer than eight cycles, or fewer than five samples a cycle.
    """
    signal = analytic_signal(decay.samples, decay.fs, frequency=decay.frequency)
    return _stretch(signal, decay, LOW_PASS_CYCLES, "FREEVIB", _ADVICE)


def forced_stretch(displacement: Signal, drive: Signal) -> Stretch:
    """The displacement of a driven stretch and the force on it, sampled alike; arguments and errors as above.

    Where the motion is never much slower than the line that the kernels are made for, they keep the negative
    frequencies out by themselves, and half a kernel is cut from the ends as of a decay: a burst is short.
    """
    if np.ptp(drive.samples) == 0:
        raise BadInput("FORCEVIB needs a force; this record has none: treat it as a free decay.")
    x, fs = displacement.samples, displacement.fs
    signal = analytic_signal(x, fs, undecay=0.0, frequency=displacement.frequency)
    inner = slice(signal.kernel, -signal.kernel)
    by_kernel = bool(np.min(signal.omega[inner], initial=np.inf) > LEAST_FREQUENCY * 2 * np.pi * fs / signal.period)
    cut = CUT_CYCLES
    if by_kernel:
        signal = analytic_signal(x, fs, undecay=0.0, frequency=displacement.frequency, by_kernel=True)
        cut = KERNEL_CYCLES / 2
    stretch = _stretch(signal, displacement, LOW_PASS_CYCLES, "FORCEVIB", "drive it longer", cut)
    force_noise = max(drive.noise, LEAST_NOISE * float(np.max(np.abs(drive.samples))))
    return replace(stretch, ratio=turned_alike(drive.samples, fs, signal, by_kernel), force_noise=force_noise)


def decay_stretch(decay: Signal) -> Stretch:
    """A free decay from as near its beginning as the kernel allows to where it sinks into its noise: FREEVIB's results.

    Nothing but the recording is in its values: half a kernel is cut from each end and no more, the Hilbert transform's
    tails do not reach the continuation (``analytic_signal``), and what the laws ask of the ends is extrapolated
    (``with_ends``). Of the noise behind the decay no more is kept than the last values ask for: un-decayed it is the
    larger part of the recording, and its wandering phase pulls at the whole carrier. The last low-pass is the shortest
    smooth one without transmission at twice the frequency, where the signal itself, in the place of its analytic one,
    leaves a ripple: Hann's window over a cycle.

    Raises:
        BadInput: as ``free_stretch``.
    """
    whole = free_stretch(decay)
    part = decay
    if np.any(whole.clear):
        last = whole.keep.start + int(np.max(np.flatnonzero(whole.clear)))
        part = decay.part(0, min(decay.n, last + int(np.ceil((CUT_CYCLES + 1) * whole.signal.period))))
    signal = analytic_signal(part.samples, decay.fs, frequency=part.frequency, by_kernel=True)
    stretch = _stretch(signal, part, 1.0, "FREEVIB", _ADVICE, KERNEL_CYCLES / 2)
    kernel = np.hanning(stretch.low_pass_kernel.size + 2)[1:-1]
    kernel = kernel / np.sum(kernel)
    return replace(stretch, signal=with_ends(signal, decay.fs), noise=whole.noise, low_pass_kernel=kernel)


def _stretch(
    signal: AnalyticSignal,
    displacement: Signal,
    cycles: float,
    method: str,
    advice: str,
    cut_cycles: float = CUT_CYCLES,
) -> Stretch:
    n, fs = displacement.n, displacement.fs
    middle = float(np.median(signal.omega))
    period = 2 * np.pi / middle * fs if middle > 0 else float("inf")
    cut = int(np.ceil(cut_cycles * period)) if np.isfinite(period) else n
    if n - 2 * cut < DECAY_CYCLES * period:
        what = "decay" if method == "FREEVIB" else "driven stretch"
        least = DECAY_CYCLES + 2 * cut_cycles
        raise BadInput(
            f"The {what} has {n / period:.1f} cycles; {method} needs at least {least:.0f}, of which "
            f"{cut_cycles:g} are cut from each end: {advice}."
        )
    noise = max(displacement.noise, LEAST_NOISE * float(np.max(np.abs(signal.amplitude))))
    return Stretch(signal, fs, noise, blackman(int(cycles * period))[0], slice(cut, n - cut))


# The half kernel at each end of a stretch, which leans on the continuation, extrapolated from what does not.

_LEAST_UNBENT = numerics(0.5, "part of an envelope", why="by no more it is straightened")
_DEGREE = numerics(3, "degree", why="of the polynomial that continues a decay")
_KERNELS = numerics(1.0, "kernels", why="behind the end that are asked")


def with_ends(signal: AnalyticSignal, fs: float) -> AnalyticSignal:
    """A signal whose ends, half a kernel each, are extrapolated; a stretch too short for that stays as it is."""
    edge, asked = signal.kernel // 2, int(_KERNELS * signal.kernel)
    n = signal.time.size
    if n < 2 * (edge + asked):
        return signal
    log = np.log(np.abs(signal.slow)) + 1j * signal.phase  # of the un-decayed motion
    fields = {
        name: getattr(signal, name).copy()
        for name in ("amplitude", "phase", "omega", "growth", "curvature", "chirp", "slow", "equation_first")
    }
    for ends, inner in (
        (slice(0, edge), slice(edge, edge + asked)),
        (slice(n - edge, n), slice(n - edge - asked, n - edge)),
    ):
        centre = signal.time[inner].mean()
        scale = asked / fs
        at, known = (signal.time[ends] - centre) / scale, (signal.time[inner] - centre) / scale
        q = np.polynomial.polynomial.polyfit(known, np.column_stack([log[inner].real, log[inner].imag]), _DEGREE)
        value, slope, bend = (
            np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyder(q, m) if m else q) / scale**m
            for m in range(3)
        )
        growth = slope[0] - signal.undecay
        fields["amplitude"][ends] = np.exp(value[0] - signal.undecay * signal.time[ends])
        fields["phase"][ends] = value[1]
        fields["omega"][ends] = slope[1]
        fields["growth"][ends] = growth
        fields["curvature"][ends] = bend[0] + growth**2
        fields["chirp"][ends] = bend[1]
        fields["slow"][ends] = np.exp(value[0] + 1j * (value[1] - signal.carrier[ends]))
        fields["equation_first"][ends] = growth + 1j * slope[1]
    return replace(signal, **fields)


# The noise of low-passed curves, point against point: white in the samples, it is anything but white in a curve.

_A_CYCLE = numerics(2, "points a cycle", why="both low-passes together pass nothing faster than the frequency itself")
_QUADRATURE = numerics(
    10, "samples between points", why="sums of kernels are exact with: they and what they weigh are smooth over a cycle"
)
_OWN = numerics(
    1e-3,
    "part of the variance of a point",
    why="that is its own, so that no combination of points passes for free of noise",
)


@dataclass(frozen=True, eq=False)
class CurveNoise:
    """Points (q,) among a stretch's low-passed values, and the Cholesky factor of their covariance, banded."""

    points: np.ndarray
    used: np.ndarray  # (q,) of bool: those that stand clear of the noise
    factor: np.ndarray  # (bands, q), lower

    def weigh(self, values: np.ndarray) -> np.ndarray:
        """The inverse covariance times (..., k) low-passed values, as (..., k): zero but at the points."""
        from scipy.linalg import cho_solve_banded

        out = np.zeros(values.shape)
        given = np.where(self.used, values[..., self.points], 0.0)
        solved = cho_solve_banded((self.factor, True), given.reshape(-1, self.points.size).T).T
        out[..., self.points] = np.where(self.used, solved.reshape(given.shape), 0.0)
        return out

    def whitened(self, values: np.ndarray) -> np.ndarray:
        """Of (k,) low-passed values what each point adds to those before it, (q,), over its own error.

        Noise alone leaves ones, each by itself (less where the kernels pass nothing); zero where no point counts.
        """
        from scipy.linalg import solve_banded

        bands = self.factor.shape[0] - 1
        return np.asarray(solve_banded((bands, 0), self.factor, np.where(self.used, values[self.points], 0.0)))

    @property
    def count(self) -> int:
        """How many points count."""
        return int(np.count_nonzero(self.used))


def curve_noise(
    stretch: Stretch,
    equation: np.ndarray,
    amplitude: np.ndarray,
    squared: np.ndarray,
    damping: np.ndarray,
    inverse_mass: float,
) -> CurveNoise:
    """Covariance of a low-passed value that changes by the real part of `equation` de plus `amplitude` dA/A.

    Args:
        stretch: of n samples.
        equation: (n,), complex; de is the error of the equation of motion over X (``modal_stretch``).
        amplitude: (n,), real.
        squared, damping, inverse_mass: omega0² (n,), h (n,) and 1/m, as ``Stretch.noise_weights`` has them.
    """
    from scipy.linalg import cholesky_banded

    step = max(1, round(stretch.signal.period / _A_CYCLE))
    thin = max(1, round(step / _QUADRATURE))
    apart_by = _QUADRATURE if thin > 1 else step  # in samples of the sums
    points = np.arange(0, stretch.clear.size, thin * apart_by)
    used = stretch.clear[points]
    moved, drive = _rows(stretch, points, thin, equation, amplitude, squared, damping, inverse_mass)
    width = moved.shape[1]
    bands = np.zeros((min(1 + (width - 1) // apart_by, points.size), points.size))
    for rows, noise in ((moved, stretch.noise), (drive, stretch.force_noise)):
        if rows is None:
            continue
        rows = np.where(used[:, None], rows, 0.0)
        for apart in range(len(bands)):
            shift = apart * apart_by
            shared = np.einsum("ij,ij->i", rows[: points.size - apart, shift:], rows[apart:, : width - shift])
            bands[apart, : points.size - apart] += thin * noise**2 * shared
    bands[0] = np.where(used, (1 + _OWN) * bands[0], 1.0)
    scale = 1 / np.sqrt(bands[0])
    for apart in range(len(bands)):
        bands[apart, : points.size - apart] *= scale[: points.size - apart] * scale[apart:]
    factor = cholesky_banded(bands, lower=True)
    for apart in range(len(factor)):  # row i of the factor back to its own unit
        factor[apart, : points.size - apart] /= scale[apart:]
    return CurveNoise(points, used, factor)


def _rows(
    stretch: Stretch,
    points: np.ndarray,
    thin: int,
    equation: np.ndarray,
    amplitude: np.ndarray,
    squared: np.ndarray,
    damping: np.ndarray,
    inverse_mass: float,
) -> tuple[np.ndarray, np.ndarray | None]:
    """How the noise of each `thin`-th sample about each point enters it: (q, samples) of displacement and of force."""
    s, fs = stretch.signal, stretch.fs
    low, of_low = _every(stretch.low_pass_kernel, thin)
    kernels = [_every(kernel, thin)[0] for kernel in blackman(s.kernel)]
    of_kernel = _every(blackman(s.kernel)[0], thin)[1]
    middle = stretch.inside.start + stretch.low_pass_kernel.size // 2 + points[:, None]
    at = middle + of_low
    samples = middle + thin * np.arange((of_low[0] - of_kernel[-1]) // thin, (of_low[-1] - of_kernel[0]) // thin + 1)
    first, zeroth = stretch.of_displacement(squared, damping)
    inside = np.clip(samples, 0, s.time.size - 1)
    back = np.exp(s.undecay * s.time - 1j * s.carrier)[inside] * (samples == inside)

    def spread(weights: np.ndarray, kernel: np.ndarray) -> np.ndarray:
        return convolved(thin * low * (weights / s.slow)[at], kernel[::-1], "full")

    moved = spread(equation * zeroth + amplitude, kernels[0]) + spread(equation * first, kernels[1]) * fs
    moved = moved + spread(equation, kernels[2]) * fs**2
    if stretch.ratio is None:
        return 2 * np.real(moved * back), None
    return 2 * np.real(moved * back), 2 * np.real(spread(-inverse_mass * equation, kernels[0]) * back)


def _every(kernel: np.ndarray, thin: int) -> tuple[np.ndarray, np.ndarray]:
    """Each `thin`-th weight of a kernel (k,) from its middle on either side, for as many, and its place beside it."""
    half = kernel.size // 2
    places = np.arange(-(half // thin), (kernel.size - 1 - half) // thin + 1) * thin
    return kernel[half + places], places

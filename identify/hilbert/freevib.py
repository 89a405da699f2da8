"""FREEVIB: natural frequency and damping of a free decay as functions of its amplitude.

Feldman, Bucher, Rotberg 2009, Eqs. 9-12 (Feldman 1994): with the analytic signal `X'' + 2 h0 X' + omega0^2 X = 0`,

    omega0^2 = omega^2 - A''/A + 2 (A'/A)^2 + A' omega' / (A omega),    h0 = -A'/A - omega' / (2 omega).

For a linear system `viscous = 2 h0`. The low-passed values are those of the motion's fundamental: the mean of X'/X over
a cycle is that of the fundamental, because X'/X is an analytic function of exp(2 i psi), harmonics smaller than it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ..signals.hilbert import KERNEL_CYCLES, blackman
from ..signals.signals import Signal
from .instantaneous import free_modal_parameters
from .limits import CURVE_LEAST, KERNELS_A_VALUE, LEAST_NOISE
from .modal_stretch import LOW_PASS_CYCLES, free_stretch


@dataclass(frozen=True)
class FreeVib:
    """Low-passed instantaneous modal parameters of one free decay; every array has shape (n,)."""

    time: np.ndarray  # s, from the first sample of the decay
    amplitude: np.ndarray  # envelope, unit of the recording
    omega: np.ndarray  # instantaneous frequency, rad/s
    omega0: np.ndarray  # rad/s, sqrt of the low-passed omega0^2(t)
    damping: np.ndarray  # low-passed h0(t), 1/s; viscous / 2 of a linear system
    omega0_std: np.ndarray  # rad/s, of a point: noise of the recording and what low-passing bends off the curve
    damping_std: np.ndarray  # 1/s
    per_point: float  # independent values per point of the curves: they are smoother than they are dense


def freevib(decay: Signal) -> FreeVib:
    """FREEVIB on the displacement of a free decay.

    Raises BadInput when the decay is shorter than eight cycles or has fewer than five samples a cycle.
    """
    fs = decay.fs
    stretch = free_stretch(decay)
    signal, kernel, low_pass, keep = stretch.signal, stretch.low_pass_kernel, stretch.low_pass, stretch.keep
    period = 2 * np.pi / float(np.median(signal.omega)) * fs
    omega0_squared, h0 = free_modal_parameters(signal)
    squared, damping = low_pass(omega0_squared), low_pass(h0)
    amplitude = signal.amplitude[keep]
    omega = low_pass(signal.omega)
    good = (squared > 0) & (amplitude > 0) & (omega > 0)
    if not np.any(good):
        raise BadInput("FREEVIB finds no positive natural frequency: this is not a free decay of one oscillator.")
    # the noise of omega and of A'/A: white noise through both kernels in series, on a circle of radius A
    slope_kernel = np.convolve(blackman(round(KERNEL_CYCLES * period))[1], kernel)
    gain = float(np.sqrt(2 * np.sum(slope_kernel**2))) * fs
    slope = max(decay.noise, LEAST_NOISE * float(np.max(amplitude))) * gain / amplitude
    bias = 0.5 * _second_moment(period) / fs**2
    omega0 = np.sqrt(np.where(squared > 0, squared, np.nan))
    span = (KERNEL_CYCLES + LOW_PASS_CYCLES) * period
    return FreeVib(
        time=signal.time[keep][good],
        amplitude=amplitude[good],
        omega=omega[good],
        omega0=omega0[good],
        damping=damping[good],
        omega0_std=np.hypot(slope, bias * _bend(omega0, fs))[good],
        damping_std=np.hypot(slope, bias * _bend(damping, fs))[good],
        per_point=min(1.0, KERNELS_A_VALUE / span),  # the kernels' effective length is a third of their joint length
    )


def _second_moment(period: float) -> float:
    """Mean square width in samples of the two kernels in series."""
    moment = 0.0
    for cycles in (KERNEL_CYCLES, LOW_PASS_CYCLES):
        w = blackman(round(cycles * period))[0]
        moment += float(np.sum(w * (np.arange(w.size) - w.size // 2) ** 2))
    return moment


def _bend(curve: np.ndarray, fs: float) -> np.ndarray:
    """Size of the second derivative of a smooth curve (n,) of time: a low-pass takes it, times half its width, off."""
    if curve.size < CURVE_LEAST:
        return np.zeros_like(curve)
    return np.nan_to_num(np.abs(np.gradient(np.gradient(curve, 1 / fs), 1 / fs)))

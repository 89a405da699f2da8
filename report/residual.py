"""Spectra of the response and of what a model leaves of it: at which frequency something is missing."""

from __future__ import annotations

import numpy as np

from ..export.render import plain_text
from ..model.display import scale_of
from .comparison import Comparison
from .style import EXACT, MEASURED, MODEL, drawing, legend_below, log_ticks, svg

#: Resolution: this many lines below the natural frequency.
_LINES = 40
_HIGHEST = 6.0


def spectrum_figure(
    comparison: Comparison, natural: float, unit: str, key: str = "spectrum", source: str = "model"
) -> str:
    """SVG of two amplitude spectral densities, in the response's unit per root hertz.

    Args:
        comparison: the recording.
        natural: natural frequency, Hz; the picture reaches to six times that.
        unit: of the response.
        key: name of the picture within its page.
        source: what simulated.
    """
    name = plain_text(comparison.name)
    fs = comparison.fs
    f, density = spectral_density(comparison.measured, fs, natural)
    _, rest = spectral_density(comparison.residual, fs, natural)
    scale = scale_of(unit, density)
    per_root = f"{scale.unit}/√Hz"
    with drawing(height=2.9) as figure:
        axes = figure.subplots()
        axes.semilogy(f, density * scale.factor, color=MEASURED, label="measured response", linewidth=1.1)
        axes.semilogy(f, rest * scale.factor, color=MODEL, label=f"{source} − measured")
        white = comparison.sensor_rms / np.sqrt(fs / 2) * scale.factor
        if white > 0:
            axes.axhline(white, color=EXACT, linestyle="--", linewidth=1.1, label="sensor noise")
        axes.margins(x=0)
        log_ticks(axes.yaxis)
        axes.set_xlabel("Frequency [Hz]")
        axes.set_ylabel(f"Spectral density [{per_root}]")
        axes.set_title(name)
        legend_below(figure, *axes.get_legend_handles_labels(), columns=3)
        return svg(figure, key, f"{name}: spectral density of response and residual in {per_root}")


def spectral_density(signal: np.ndarray, fs: float, natural: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (m,) up to six times the natural one, Hz, and amplitude density (m,), in the signal's unit per √Hz.

    By Welch's method; values of ``signal`` (n,) that are not finite count as zero.
    """
    from scipy.signal import welch

    size = int(min(max(_LINES * fs / natural, 64), signal.size))
    f, power = welch(np.where(np.isfinite(signal), signal, 0.0), fs, nperseg=size)
    view = (f > 0) & (f <= _HIGHEST * natural)
    return f[view], np.sqrt(power[view])

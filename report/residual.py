"""Spectra of the response and of what a model leaves of it: at which frequency something is missing."""

from __future__ import annotations

import numpy as np

from ..export.render import plain_text
from ..identify.signals.hilbert import welch
from ..model.display import scale_of
from .chart import Chart
from .comparison import Comparison
from .style import EXACT, MEASURED, MODEL

#: Resolution: this many lines below the natural frequency.
_LINES = 40
_HIGHEST = 6.0


def spectrum_figure(
    comparison: Comparison, natural: float, unit: str, key: str = "spectrum", source: str = "model"
) -> Chart:
    """Chart of two amplitude spectral densities, in the response's unit per root hertz.

    Args:
        comparison: the recording.
        natural: natural frequency, Hz; the picture reaches to six times that.
        unit: of the response.
        key: name of the chart within its page.
        source: what simulated.
    """
    name = plain_text(comparison.name)
    fs = comparison.fs
    f, density = spectral_density(comparison.measured, fs, natural)
    _, rest = spectral_density(comparison.residual, fs, natural)
    scale = scale_of(unit, density)
    per_root = f"{scale.unit}/√Hz"
    chart = Chart(key, f"{name}: spectral density of response and residual in {per_root}")
    (panel,) = chart.row(1, height=230)
    panel.line(f, density * scale.factor, MEASURED, "measured response", width=1.1)
    panel.line(f, rest * scale.factor, MODEL, f"{source} − measured")
    white = comparison.sensor_rms / np.sqrt(fs / 2) * scale.factor
    if white > 0:
        panel.rule(white, EXACT, "sensor noise")
    panel.x.set(label="Frequency [Hz]", tight=True)
    panel.y.set(label=f"Spectral density [{per_root}]", log=True)
    panel.title = name
    return chart


def spectral_density(
    signal: np.ndarray, fs: float, natural: float, highest: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (m,) up to six times the natural one, Hz, and amplitude density (m,), in the signal's unit per √Hz.

    Where there are further natural frequencies, up to twice the ``highest``. By Welch's method; values of ``signal``
    (n,) that are not finite count as zero.
    """
    size = int(min(max(_LINES * fs / natural, 64), signal.size))
    f, window = np.fft.rfftfreq(size, 1.0 / fs), np.hanning(size + 1)[:-1]
    power = welch(np.where(np.isfinite(signal), signal, 0.0), fs, window)
    view = (f > 0) & (f <= max(_HIGHEST * natural, 2.0 * (highest or 0.0)))
    return f[view], np.sqrt(power[view])

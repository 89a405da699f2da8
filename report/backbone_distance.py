"""How far the measured backbones lie from the model's: what Fig. 4 shows as one line, taken apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from ..model.describing import natural_motion
from ..model.display import scale_of
from .backbone_figure import backbone_kind, model_backbone
from .chart import Chart
from .style import EXACT, FORCED, FREE, MODEL

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..model import Oscillator
    from ..verify.verification import Verification

_TWO_PI = 2 * np.pi
_MARKS = 16
_GRID, _MEAN_GRID = 120, 48
#: The view takes in this part of the distances, those of the upper decade of amplitudes.
_SEEN = 0.98


def distance_figure(identification: Identification, verification: Verification | None = None) -> Chart:
    """Chart of measured minus modelled natural frequency over amplitude, Hz.

    The zero line is the model's mean natural frequency (its describing function), which is what FREEVIB and FORCEVIB
    measure; the exact backbone is drawn against it, where there is one (no law has a memory).
    """
    model = identification.oscillator
    curves = identification.measured.curves
    top = max((float(c.amplitude.max()) for c in curves), default=0.0)
    scale = scale_of(model.response.displacement_unit, top)
    pairs = [p for c in verification.recordings for p in c.backbones] if verification else []
    seen = [a for a in (*(c.amplitude for c in curves), *(own.amplitude for _, own in pairs)) if a.size]
    if not curves:
        raise BadInput("neither a decay nor a slow sweep gave a backbone that the model could be held against")
    low = min(float(a.min()) for a in seen)
    mean = mean_frequency(model, low, max(float(a.max()) for a in seen))
    drawn: list[tuple[np.ndarray, np.ndarray]] = []
    chart = Chart("distance")
    (panel,) = chart.row(1)
    for curve in curves:
        order = np.argsort(curve.amplitude)
        a = curve.amplitude[order]
        drawn.append((a, curve.omega0[order] / _TWO_PI - mean(a)))
        if curve.method == "freevib":
            panel.line(a * scale.factor, drawn[-1][1], FREE, "decays, FREEVIB", width=0.9)
        else:
            panel.line(a * scale.factor, drawn[-1][1], FORCED, "forced records, FORCEVIB", dash=":", width=2.0)
    for _, own in pairs:
        a, distance = _thin(own.amplitude, own.frequency - mean(own.amplitude))
        marker = "o" if own.method == "regression" else "s"
        label = f"FMU's output, {own.method}"
        panel.dots(a * scale.factor, distance, MODEL, label, marker=marker, size=3.6, hollow=True)
    if backbone_kind(model) == "exact":
        a, omega = model_backbone(model, np.geomspace(low, top, 120))
        panel.line(a * scale.factor, omega / _TWO_PI - mean(a), EXACT, "model, exact backbone", width=0.9)
    lowest, highest = _view(drawn, top)
    panel.y.set(label="Frequency − model's [Hz]", low=lowest, high=highest)
    panel.x.set(label=scale.label("Amplitude"), log=True)
    chart.title = f"Measured natural frequency minus the model's, in Hz, over amplitude in {scale.unit}"
    return chart


def mean_frequency(model: Oscillator, low: float, high: float) -> Callable[[np.ndarray], np.ndarray]:
    """The model's mean natural frequency, Hz, as a function of amplitudes (n,) from ``low`` to ``high``.

    It is the root of the equivalent stiffness (NaN where there is none), at some amplitudes and interpolated.
    """
    grid = np.geomspace(low, high, _GRID if backbone_kind(model) == "exact" else _MEAN_GRID)
    frequency = natural_motion(model, grid)[0] / _TWO_PI
    if not np.any(np.isfinite(frequency)):
        raise BadInput("at these amplitudes no natural motion of the model was found; simulate it instead")
    if not np.all(np.isfinite(frequency)):
        return lambda amplitude: np.interp(amplitude, grid, frequency)
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(np.log(grid), frequency)
    return lambda amplitude: spline(np.log(amplitude))


def _thin(amplitude: np.ndarray, distance: np.ndarray, points: int = _MARKS) -> tuple[np.ndarray, np.ndarray]:
    """At most so many points, evenly over the logarithm of the amplitude."""
    order = np.argsort(amplitude)
    if amplitude.size > points:
        a = np.log(amplitude[order])
        order = order[np.unique(np.searchsorted(a, np.linspace(a[0], a[-1], points)).clip(0, a.size - 1))]
    return amplitude[order], distance[order]


def _view(drawn: list[tuple[np.ndarray, np.ndarray]], top: float) -> tuple[float, float]:
    """Limits, Hz: small amplitudes are noise, and noise must not set the view."""
    pieces = [distance[(a > 0.1 * top) & np.isfinite(distance)] for a, distance in drawn]
    values = np.concatenate([*pieces, np.zeros(1)])
    reach = 5 * max(float(np.quantile(np.abs(values), _SEEN)), 1e-6)
    return -reach, reach

"""How far the measured backbones lie from the model's: what Fig. 4 shows as one line, taken apart."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..model.describing import natural_motion
from ..model.display import scale_of
from .backbone_figure import backbone_kind, model_backbone
from .style import EXACT, FORCED, FREE, MODEL, drawing, legend_below, log_ticks, svg

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..model import Oscillator
    from ..verify.verification import Verification

_TWO_PI = 2 * np.pi
_POINTS = 200
_GRID, _MEAN_GRID = 120, 48
#: The view takes in this part of the distances, those of the upper decade of amplitudes.
_SEEN = 0.98


def distance_figure(identification: Identification, verification: Verification | None = None) -> str:
    """SVG of measured minus modelled natural frequency over amplitude, Hz.

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
    with drawing(height=3.0) as figure:
        axes = figure.subplots()
        styles = {
            "freevib": {"color": FREE, "linewidth": 0.9, "label": "decays, FREEVIB"},
            "forcevib": {"color": FORCED, "linestyle": ":", "linewidth": 2.0, "label": "forced records, FORCEVIB"},
        }
        for curve in curves:
            drawn.append(_thin(curve.amplitude, curve.omega0 / _TWO_PI - mean(curve.amplitude)))
            axes.plot(drawn[-1][0] * scale.factor, drawn[-1][1], **styles[curve.method])
        for _, own in pairs:
            a, distance = _thin(own.amplitude, own.frequency - mean(own.amplitude), 16)
            look: dict[str, Any] = {"marker": "o" if own.method == "regression" else "s", "linestyle": "none"}
            label = f"FMU's output, {own.method}"
            axes.plot(
                a * scale.factor, distance, markersize=3.6, color=MODEL, markerfacecolor="white", label=label, **look
            )
        if backbone_kind(model) == "exact":
            a, omega = model_backbone(model, np.geomspace(low, top, 120))
            distance = omega / _TWO_PI - mean(a)
            axes.plot(a * scale.factor, distance, color=EXACT, linewidth=0.9, label="model, exact backbone")
        axes.set_ylim(*_view(drawn, top))
        axes.set_xscale("log")
        log_ticks(axes.xaxis)
        axes.set_xlabel(scale.label("Amplitude"))
        axes.set_ylabel("Frequency − model's [Hz]")
        legend = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
        legend_below(figure, list(legend.values()), list(legend), columns=3)
        title = f"Measured natural frequency minus the model's, in Hz, over amplitude in {scale.unit}"
        return svg(figure, "distance", title)


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


def _thin(amplitude: np.ndarray, distance: np.ndarray, points: int = _POINTS) -> tuple[np.ndarray, np.ndarray]:
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

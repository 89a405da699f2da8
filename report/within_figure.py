"""What happens within a decay's cycles as a picture: Eq. 5's natural frequency, harmonics, half-waves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..model.display import scale_of
from .chart import Chart, Dash, Panel
from .hilbert_figures import BAND
from .style import AFTER, FORCED, FREE, MEASURED, MODEL, RESPONSE

if TYPE_CHECKING:
    from ..identify.hilbert.modal_result import ModalCurve
    from ..identify.hilbert.within_the_cycle import WithinTheCycle

_TWO_PI = 2 * np.pi
#: Cycles of which the natural frequency is drawn at every instant.
_CYCLES = 4.0
#: So far below the noise the picture goes on.
_BELOW = 5.0
#: Of so many harmonics as are drawn: the largest.
_COLORS = (FREE, FORCED, MODEL, RESPONSE)


def within_figure(curve: ModalCurve, unit: str, key: str = "within") -> Chart:
    """Chart of a decay's natural frequency within the cycle, its harmonics and its half-waves over the amplitude.

    Args:
        curve: of a decay, with what is within its cycles.
        unit: of the displacement.
        key: name of the chart within its page.
    """
    cycle = curve.within
    assert cycle is not None  # the caller draws decays that have it
    chart = Chart(key, f"{curve.recording}: natural frequency within the cycle, harmonics and half-waves")
    pace, harmonics, sides = chart.row(1, 1, 1)
    _pace(pace, curve, cycle)
    _harmonics(harmonics, curve, cycle, unit)
    _sides(sides, cycle, unit)
    return chart


def _pace(panel: Panel, curve: ModalCurve, cycle: WithinTheCycle) -> None:
    """Eq. 5 where the amplitude is largest, about its mean, Eq. 6."""
    first = int(curve.amplitude.argmax())
    until = curve.time[first] + _CYCLES * _TWO_PI / curve.omega[first]
    seen = (curve.time >= curve.time[first]) & (curve.time <= until)
    time = curve.time[seen]
    panel.line(time, cycle.omega0[seen] / _TWO_PI, MEASURED, "at each instant (Eq. 5)", width=1.0)
    panel.line(time, curve.omega0[seen] / _TWO_PI, AFTER, "mean of the cycle (Eq. 6)", dash="--")
    panel.x.set(label="Time [s]")
    panel.y.set(label="Frequency [Hz]")
    panel.title = "Natural frequency"


def _harmonics(panel: Panel, curve: ModalCurve, cycle: WithinTheCycle, unit: str) -> None:
    """Those that stand out of the noise, with what a part of them is known to."""
    scale = scale_of(unit, curve.amplitude)
    order = np.argsort(curve.amplitude)
    at = curve.amplitude[order] * scale.factor
    largest = np.argsort(-np.max(np.abs(cycle.harmonics), axis=1))[: len(_COLORS)]
    found = [(cycle.orders[i], cycle.harmonics[i]) for i in sorted(largest) if np.any(cycle.harmonics[i])]
    for i, (n, u) in enumerate(found):
        name = "centre" if n == 0 else f"harmonic {n}"
        panel.line(at, np.abs(u[order]) * scale.factor, _COLORS[i], name)
    noise = BAND * cycle.harmonics_std[order] * scale.factor
    panel.line(at, noise, MEASURED, f"{BAND:g} std. errors", dash=":")
    top = max([float(np.max(noise)), *(float(np.max(np.abs(u))) * scale.factor for _, u in found)])
    panel.x.set(log=True, label=scale.label("Amplitude A"))
    panel.y.set(log=True, label=scale.label("Size"), low=float(np.min(noise)) / _BELOW, high=2 * top)
    panel.title = "Harmonics" if found else "Harmonics: none above the noise"


def _sides(panel: Panel, cycle: WithinTheCycle, unit: str) -> None:
    scale = scale_of(unit, cycle.peaks)
    styles: tuple[tuple[str, Dash, str], ...] = ((FREE, "-", "above rest"), (FORCED, "--", "below rest"))
    for peak, omega, (color, dash, name) in zip(cycle.peaks, cycle.omega, styles, strict=True):
        order = np.argsort(peak)
        panel.line(peak[order] * scale.factor, omega[order] / _TWO_PI, color, name, dash=dash)
    panel.x.set(label=scale.label("Peak"))
    panel.y.set(label="Frequency [Hz]")
    panel.title = "Half-waves"

"""What happens within a decay's cycles as a picture: Eq. 5's natural frequency, harmonics, half-waves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..model.display import scale_of
from .hilbert_figures import BAND
from .style import AFTER, FORCED, FREE, MEASURED, MODEL, RESPONSE, drawing, legend_below, log_ticks, svg

if TYPE_CHECKING:
    from ..identify.hilbert.modal_result import ModalCurve
    from ..identify.hilbert.within_the_cycle import WithinTheCycle

_TWO_PI = 2 * np.pi
#: Cycles of which the natural frequency is drawn at every instant.
_CYCLES = 4.0
_POINTS = 400
#: So far below the noise the picture goes on.
_BELOW = 5.0
#: Of so many harmonics as are drawn: the largest.
_COLORS = (FREE, FORCED, MODEL, RESPONSE)


def within_figure(curve: ModalCurve, unit: str, key: str = "within") -> str:
    """SVG of a decay's natural frequency within the cycle, its harmonics and its half-waves over the amplitude.

    Args:
        curve: of a decay, with what is within its cycles.
        unit: of the displacement.
        key: name of the picture within its page.
    """
    cycle = curve.within
    assert cycle is not None  # the caller draws decays that have it
    with drawing(height=3.5) as figure:
        pace, harmonics, sides = figure.subplots(1, 3)
        _pace(pace, curve, cycle)
        _harmonics(harmonics, curve, cycle, unit)
        _sides(sides, cycle, unit)
        handles, labels = zip(
            *(
                pair
                for axes in (pace, harmonics, sides)
                for pair in zip(*axes.get_legend_handles_labels(), strict=True)
            ),
            strict=True,
        )
        legend_below(figure, list(handles), list(labels), columns=5)
        return svg(figure, key, f"{curve.recording}: natural frequency within the cycle, harmonics and half-waves")


def _pace(axes: Any, curve: ModalCurve, cycle: WithinTheCycle) -> None:
    """Eq. 5 where the amplitude is largest, about its mean, Eq. 6."""
    first = int(curve.amplitude.argmax())
    until = curve.time[first] + _CYCLES * _TWO_PI / curve.omega[first]
    seen = (curve.time >= curve.time[first]) & (curve.time <= until)
    time = curve.time[seen]
    axes.plot(time, cycle.omega0[seen] / _TWO_PI, color=MEASURED, linewidth=1.0, label="at each instant (Eq. 5)")
    axes.plot(time, curve.omega0[seen] / _TWO_PI, color=AFTER, label="mean of the cycle (Eq. 6)")
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Frequency [Hz]")
    axes.set_title("Natural frequency")


def _harmonics(axes: Any, curve: ModalCurve, cycle: WithinTheCycle, unit: str) -> None:
    """Those that stand out of the noise, with what a part of them is known to."""
    scale = scale_of(unit, curve.amplitude)
    order = np.argsort(curve.amplitude)[:: max(1, curve.amplitude.size // _POINTS)]
    largest = np.argsort(-np.max(np.abs(cycle.harmonics), axis=1))[: len(_COLORS)]
    found = [(cycle.orders[i], cycle.harmonics[i]) for i in sorted(largest) if np.any(cycle.harmonics[i])]
    for i, (n, u) in enumerate(found):
        name = "centre" if n == 0 else f"harmonic {n}"
        axes.plot(curve.amplitude[order] * scale.factor, np.abs(u[order]) * scale.factor, color=_COLORS[i], label=name)
    noise = BAND * cycle.harmonics_std[order] * scale.factor
    axes.plot(
        curve.amplitude[order] * scale.factor, noise, color=MEASURED, linestyle=":", label=f"{BAND:g} std. errors"
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    top = max([float(np.max(noise)), *(float(np.max(np.abs(u))) * scale.factor for _, u in found)])
    axes.set_ylim(float(np.min(noise)) / _BELOW, 2 * top)
    log_ticks(axes.xaxis)
    log_ticks(axes.yaxis)
    axes.set_xlabel(scale.label("Amplitude A"))
    axes.set_ylabel(scale.label("Size"))
    axes.set_title("Harmonics" if found else "Harmonics: none above the noise")


def _sides(axes: Any, cycle: WithinTheCycle, unit: str) -> None:
    scale = scale_of(unit, cycle.peaks)
    styles = ((FREE, "-", "above rest"), (FORCED, "--", "below rest"))
    for peak, omega, (color, line, name) in zip(cycle.peaks, cycle.omega, styles, strict=True):
        order = np.argsort(peak)[:: max(1, peak.size // _POINTS)]
        axes.plot(peak[order] * scale.factor, omega[order] / _TWO_PI, color=color, linestyle=line, label=name)
    axes.set_xlabel(scale.label("Peak"))
    axes.set_ylabel("Frequency [Hz]")
    axes.set_title("Half-waves")

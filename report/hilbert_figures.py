"""FREEVIB's and FORCEVIB's curves as pictures: over time, backbones with bands and Eq. 14, characteristics (Eq. 15)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..identify.hilbert.static_force import (
    StaticCharacteristic,
    friction_characteristic,
    measured_response,
    medians,
    spring_characteristic,
)
from ..model import units
from ..model.display import number, scale_of
from .covered import Spans, covered, parted, spans_of
from .style import FORCED, FREE, MEASURED, RESPONSE, drawing, legend_below, log_ticks, svg

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import ModalCurve

_TWO_PI = 2 * np.pi
_POINTS = 400
#: Bands are drawn to so many standard errors.
BAND = 2.0
_METHODS = {"freevib": (FREE, "-.", "decays, FREEVIB"), "forcevib": (FORCED, ":", "driven, FORCEVIB")}


def time_figure(curve: ModalCurve, unit: str, key: str) -> str:
    """SVG of amplitude, instantaneous and natural frequency, and damping of one stretch over time, with bands."""
    step = max(1, curve.time.size // _POINTS)
    seen = slice(None, None, step)
    time = curve.time[seen]
    color = _METHODS[curve.method][0]
    scale = scale_of(unit, curve.amplitude)
    with drawing(height=2.9) as figure:
        size, pace, loss = figure.subplots(1, 3)
        size.plot(time, curve.amplitude[seen] * scale.factor, color=color)
        size.set_ylabel(scale.label("Amplitude A"))
        size.set_ylim(0, None)
        size.set_title("Amplitude")
        if curve.method == "forcevib":
            pace.plot(time, curve.omega[seen] / _TWO_PI, color=MEASURED, linewidth=0.9, label="f of the motion")
        omega0, std = curve.omega0[seen] / _TWO_PI, BAND * curve.omega0_std[seen] / _TWO_PI
        pace.fill_between(time, omega0 - std, omega0 + std, color=color, alpha=0.3, linewidth=0)
        pace.plot(time, omega0, color=color, label="natural frequency")
        pace.set_ylabel("Frequency [Hz]")
        pace.set_title("Natural frequency" if curve.method == "freevib" else "Frequency, natural and driven")
        if curve.method == "forcevib":
            pace.legend(loc="best")
        h, error = curve.damping[seen], BAND * curve.damping_std[seen]
        loss.fill_between(time, h - error, h + error, color=color, alpha=0.3, linewidth=0)
        loss.plot(time, h, color=color)
        loss.set_ylabel("Damping h [1/s]")
        loss.set_title("Damping")
        _view(loss, h, error)
        for axes in (size, pace, loss):
            axes.set_xlabel("Time [s]")
        return svg(figure, key, f"{curve.recording}: amplitude, natural frequency and damping over time")


def curves_figure(analysis: HilbertAnalysis, unit: str, forces: Sequence[float] = (), key: str = "curves") -> str:
    """SVG of Fig. 4: backbones over frequency with bands, free against forced, Eq. 14 and the measured amplitudes.

    Args:
        analysis: the curves.
        unit: of the displacement.
        forces: amplitudes of a sine per unit mass, at which Eq. 14 is drawn with the measured curves in it.
        key: name of the picture within its page.
    """
    scale = scale_of(unit, max(float(c.amplitude.max()) for c in analysis.curves))
    with drawing(height=4.4) as figure:
        main, close = figure.subplots(1, 2, width_ratios=[1.25, 1])
        for axes in (main, close):
            for method in _METHODS:
                _backbones(axes, analysis.of(method), method, scale.factor)
            axes.set_xlabel("Frequency [Hz]")
        for force in forces:
            response = measured_response(analysis.curves, force)
            label = "Eq. 14, from the measured curves"
            for branch in (response.lower, response.upper):
                main.plot(branch / _TWO_PI, response.amplitude * scale.factor, "--", color=RESPONSE, label=label)
                label = "_nolegend_"
        for curve in analysis.of("forcevib"):
            if np.ptp(curve.omega) > 0.2 * np.median(curve.omega):  # a sweep; a burst builds up at one frequency
                step = max(1, curve.time.size // _POINTS)
                main.plot(
                    curve.omega[::step] / _TWO_PI,
                    curve.amplitude[::step] * scale.factor,
                    color=MEASURED,
                    linewidth=0.8,
                    zorder=1.5,
                    label="measured amplitude of the sweep",
                )
        main.set_ylim(0, None)
        main.set_ylabel(scale.label("Amplitude"))
        main.set_title("Backbones and response")
        close.set_yscale("log")
        close.set_ylabel(scale.label("Amplitude"))
        close.set_title("Backbones close up, with bands")
        low, high = _reach(analysis)
        close.set_xlim(low, high)
        close.locator_params(axis="x", nbins=5)
        log_ticks(close.yaxis)
        handles: dict[str, Any] = {}
        for handle, label in zip(*main.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
        legend_below(figure, list(handles.values()), list(handles), columns=2)
        return svg(figure, key, f"Natural frequency in Hz over amplitude in {scale.unit}, with bands")


def _backbones(axes: Any, curves: Sequence[ModalCurve], method: str, factor: float) -> None:
    color, line, label = _METHODS[method]
    for curve in curves:
        a, squared, std = medians(curve.amplitude, curve.omega0, curve.omega0_std)
        f, error = squared / _TWO_PI, BAND * std / _TWO_PI
        axes.fill_betweenx(a * factor, f - error, f + error, color=color, alpha=0.25, linewidth=0)
        axes.plot(f, a * factor, linestyle=line, color=color, linewidth=1.6, label=label)


def _reach(analysis: HilbertAnalysis) -> tuple[float, float]:
    """Natural frequencies that are seen well: their errors do not fill the view."""
    seen = [c.omega0[c.omega0_std < 0.01 * c.omega0] for c in analysis.curves]
    together = np.concatenate(seen) / _TWO_PI
    if not together.size:
        together = np.concatenate([c.omega0 for c in analysis.curves]) / _TWO_PI
    low, high = np.quantile(together, (0.002, 0.998))
    margin = 0.08 * (high - low) + 0.002 * high
    return float(low - margin), float(high + margin)


def characteristic_figure(
    analysis: HilbertAnalysis, unit: str, force_unit: str, mass: float | None, what: str, key: str
) -> str:
    """SVG of Fig. 5 (``spring``) or Fig. 7 (``friction``): Eq. 15 inverted with bands, and as printed.

    The friction has its damping curve h(A) beside it, the spring itself without its linear part.
    """
    spring = what == "spring"
    make = spring_characteristic if spring else friction_characteristic
    found: dict[str, StaticCharacteristic] = {}
    for method in _METHODS:
        try:
            found[method] = make(analysis.of(method), mass)
        except BadInput:
            continue
    if not found:
        raise BadInput("the curves cover too few amplitudes for a characteristic; record a longer decay or sweep")
    of_force = force_unit if mass is not None else units.compose("X/s2", unit)
    across = scale_of(unit if spring else units.compose("X/s", unit), max(float(c.at.max()) for c in found.values()))
    with drawing(height=3.7) as figure:
        first, second = figure.subplots(1, 2)
        whole, other = (first, second) if spring else (second, first)
        up = scale_of(of_force, max(float(np.max(np.abs(c.force))) for c in found.values()))
        spans = {
            method: spans_of(c.amplitude if spring else c.amplitude * c.omega for c in analysis.of(method))
            for method in found
        }
        for method, c in found.items():
            _characteristic(whole, c, method, across.factor, up.factor, 0.0, spans[method])
        whole.set_xlabel(across.label("Displacement" if spring else "Velocity"))
        whole.set_ylabel(up.label("Force" if mass is not None else "Force per unit mass"))
        whole.set_title("Restoring force" if spring else "Friction force")
        if spring:
            linear = _linear(analysis, mass)
            rest = max(float(np.max(np.abs(c.force - linear * c.at))) for c in found.values())
            fine = scale_of(of_force, rest)
            for method, c in found.items():
                _characteristic(other, c, method, across.factor, fine.factor, linear, spans[method])
            other.set_xlabel(across.label("Displacement"))
            other.set_ylabel(fine.label("Force"))
            other.set_title(f"… without {number(linear, 4)} {of_force}/{unit} · x")
        else:
            _damping(other, analysis, unit)
        legend_below(figure, *whole.get_legend_handles_labels(), columns=2)
        return svg(figure, key, f"{'Restoring' if spring else 'Friction'} force in {up.unit} over {across.unit}")


def _linear(analysis: HilbertAnalysis, mass: float | None) -> float:
    """Stiffness of the linear spring by Eqs. 1 and 6, per unit mass where that is not known."""
    fit = analysis.forcevib or analysis.freevib
    if fit is None:
        return float(np.median(np.concatenate([c.omega0 for c in analysis.curves])) ** 2)
    return (1.0 if mass is None else mass) * fit.values["omega0"] ** 2


def _characteristic(
    axes: Any, c: StaticCharacteristic, method: str, across: float, up: float, slope: float, spans: Spans
) -> None:
    color, line, label = _METHODS[method]
    seen = covered(c.at, spans)
    at, force, band = parted(c.at[seen], spans, (c.force - slope * c.at)[seen], BAND * c.force_std[seen])
    amplitude, printed = parted(c.amplitude, spans, c.literal - slope * c.amplitude)
    for sign in (1, -1):
        axes.fill_between(
            sign * at * across, sign * (force - band) * up, sign * (force + band) * up, color=color, alpha=0.25, lw=0
        )
        axes.plot(sign * at * across, sign * force * up, linestyle=line, color=color, label=label)
        axes.plot(
            sign * amplitude * across,
            sign * printed * up,
            color=color,
            linewidth=0.7,
            label=f"{label}, Eq. 15 as printed" if sign > 0 else "_nolegend_",
        )
        label = "_nolegend_"


def _damping(axes: Any, analysis: HilbertAnalysis, unit: str) -> None:
    scale = scale_of(unit, max(float(c.amplitude.max()) for c in analysis.curves))
    shown = []
    for method, (color, line, label) in _METHODS.items():
        for curve in analysis.of(method):
            # dry friction dissipates by the speed: below and above its resonance a rig shows two dampings
            peak = int(np.argmax(curve.amplitude))
            for side in (slice(None, peak), slice(peak, None)):
                a, h, std = medians(curve.amplitude[side], curve.damping[side], curve.damping_std[side])
                if a.size < 2:
                    continue
                band = BAND * std
                axes.fill_between(a * scale.factor, h - band, h + band, color=color, alpha=0.25, linewidth=0)
                axes.plot(a * scale.factor, h, linestyle=line, color=color, label=label)
                shown.append((h, band))
    axes.set_xscale("log")
    log_ticks(axes.xaxis)
    axes.set_xlabel(scale.label("Amplitude"))
    axes.set_ylabel("Damping h [1/s]")
    axes.set_title("Damping curve")
    _view(axes, *(np.concatenate(part) for part in zip(*shown, strict=True)))


def _view(axes: Any, values: np.ndarray, band: np.ndarray) -> None:
    """A view of the values that are known better than a third of themselves, from zero where they are positive."""
    sure = values[band < 0.3 * np.abs(values)]
    shown = sure if sure.size else values
    low, high = (float(q) for q in np.quantile(shown, (0.01, 0.99)))
    margin = 0.3 * max(high - low, 0.2 * abs(high))
    axes.set_ylim(min(0.0, low - margin) if low < 0 else 0.0, high + margin)

"""FREEVIB's and FORCEVIB's curves as pictures: over time, backbones with bands and Eq. 14, characteristics (Eq. 15)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

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
from .chart import Chart, Dash, Panel
from .covered import Spans, covered, parted, spans_of
from .style import FORCED, FREE, MEASURED, RESPONSE

if TYPE_CHECKING:
    from ..identify.hilbert.hilbert_result import HilbertAnalysis
    from ..identify.hilbert.modal_result import ModalCurve

_TWO_PI = 2 * np.pi
#: Bands are drawn to so many standard errors.
BAND = 2.0
_METHODS: dict[str, tuple[str, Dash, str]] = {
    "freevib": (FREE, "-.", "decays, FREEVIB"),
    "forcevib": (FORCED, ":", "driven, FORCEVIB"),
}


def time_figure(curve: ModalCurve, unit: str, key: str) -> Chart:
    """Chart of amplitude, instantaneous and natural frequency, and damping of one stretch over time, with bands."""
    time, color = curve.time, _METHODS[curve.method][0]
    scale = scale_of(unit, curve.amplitude)
    chart = Chart(key, f"{curve.recording}: amplitude, natural frequency and damping over time", linked=True)
    size, pace, loss = chart.row(1, 1, 1, height=230)
    size.line(time, curve.amplitude * scale.factor, color)
    size.y.set(label=scale.label("Amplitude A"), low=0.0)
    size.title = "Amplitude"
    forced = curve.method == "forcevib"
    omega0, std = curve.omega0 / _TWO_PI, BAND * curve.omega0_std / _TWO_PI
    pace.band(time, omega0 - std, omega0 + std, color)
    pace.line(time, omega0, color, "natural frequency" if forced else "")
    if forced:
        pace.line(time, curve.omega / _TWO_PI, MEASURED, "f of the motion", width=0.9)
    pace.y.set(label="Frequency [Hz]")
    pace.title = "Frequency, natural and driven" if forced else "Natural frequency"
    h, error = curve.damping, BAND * curve.damping_std
    loss.band(time, h - error, h + error, color)
    loss.line(time, h, color)
    loss.y.set(label="Damping h [1/s]")
    loss.title = "Damping"
    _view(loss, h, error)
    for panel in (size, pace, loss):
        panel.x.set(label="Time [s]")
    return chart


def curves_figure(analysis: HilbertAnalysis, unit: str, forces: Sequence[float] = (), key: str = "curves") -> Chart:
    """Chart of Fig. 4: backbones over frequency with bands, free against forced, Eq. 14 and the measured amplitudes.

    Args:
        analysis: the curves.
        unit: of the displacement.
        forces: amplitudes of a sine per unit mass, at which Eq. 14 is drawn with the measured curves in it.
        key: name of the chart within its page.
    """
    scale = scale_of(unit, max(float(c.amplitude.max()) for c in analysis.curves))
    chart = Chart(key, f"Natural frequency in Hz over amplitude in {scale.unit}, with bands")
    main, close = chart.row(1.25, 1, height=340)
    for curve in analysis.of("forcevib"):
        if np.ptp(curve.omega) > 0.2 * np.median(curve.omega):  # a sweep; a burst builds up at one frequency
            label = "measured amplitude of the sweep"
            main.line(curve.omega / _TWO_PI, curve.amplitude * scale.factor, MEASURED, label, width=0.8)
    for panel in (main, close):
        for method in _METHODS:
            _backbones(panel, analysis.of(method), method, scale.factor)
        panel.x.set(label="Frequency [Hz]")
        panel.y.set(label=scale.label("Amplitude"))
    for force in forces:
        response = measured_response(analysis.curves, force)
        for branch in (response.lower, response.upper):
            x, y = branch / _TWO_PI, response.amplitude * scale.factor
            main.line(x, y, RESPONSE, "Eq. 14, from the measured curves", dash="--")
    main.y.set(low=0.0)
    main.title, close.title = "Backbones and response", "Backbones close up, with bands"
    low, high = _reach(analysis)
    close.x.set(low=low, high=high)
    close.y.set(log=True)
    return chart


def _backbones(panel: Panel, curves: Sequence[ModalCurve], method: str, factor: float) -> None:
    color, dash, label = _METHODS[method]
    for curve in curves:
        a, squared, std = medians(curve.amplitude, curve.omega0, curve.omega0_std)
        f, error = squared / _TWO_PI, BAND * std / _TWO_PI
        panel.band(a * factor, f - error, f + error, color, alpha=0.25, across=True)
        panel.line(f, a * factor, color, label, dash=dash, width=1.6)


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
) -> Chart:
    """Chart of Fig. 5 (``spring``) or Fig. 7 (``friction``): Eq. 15 inverted with bands, and as printed.

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
    chart = Chart(key)
    first, second = chart.row(1, 1, height=290)
    whole, other = (first, second) if spring else (second, first)
    up = scale_of(of_force, max(float(np.max(np.abs(c.force))) for c in found.values()))
    spans = {
        method: spans_of(c.amplitude if spring else c.amplitude * c.omega for c in analysis.of(method))
        for method in found
    }
    for method, c in found.items():
        _characteristic(whole, c, method, across.factor, up.factor, 0.0, spans[method])
    whole.x.set(label=across.label("Displacement" if spring else "Velocity"))
    whole.y.set(label=up.label("Force" if mass is not None else "Force per unit mass"))
    whole.title = "Restoring force" if spring else "Friction force"
    if spring:
        linear = _linear(analysis, mass)
        rest = max(float(np.max(np.abs(c.force - linear * c.at))) for c in found.values())
        fine = scale_of(of_force, rest)
        for method, c in found.items():
            _characteristic(other, c, method, across.factor, fine.factor, linear, spans[method])
        other.x.set(label=across.label("Displacement"))
        other.y.set(label=fine.label("Force"))
        other.title = f"… without {number(linear, 4)} {of_force}/{unit} · x"
    else:
        _damping(other, analysis, unit)
    chart.title = f"{'Restoring' if spring else 'Friction'} force in {up.unit} over {across.unit}"
    return chart


def _linear(analysis: HilbertAnalysis, mass: float | None) -> float:
    """Stiffness of the linear spring by Eqs. 1 and 6, per unit mass where that is not known."""
    fit = analysis.forcevib or analysis.freevib
    if fit is None:
        return float(np.median(np.concatenate([c.omega0 for c in analysis.curves])) ** 2)
    return (1.0 if mass is None else mass) * fit.values["omega0"] ** 2


def _characteristic(
    panel: Panel, c: StaticCharacteristic, method: str, across: float, up: float, slope: float, spans: Spans
) -> None:
    color, dash, label = _METHODS[method]
    seen = covered(c.at, spans)
    at, force, band = parted(c.at[seen], spans, (c.force - slope * c.at)[seen], BAND * c.force_std[seen])
    amplitude, printed = parted(c.amplitude, spans, c.literal - slope * c.amplitude)
    for sign in (1, -1):
        panel.band(sign * at * across, sign * (force - band) * up, sign * (force + band) * up, color, alpha=0.25)
        panel.line(sign * at * across, sign * force * up, color, label, dash=dash)
        literal = f"{label}, Eq. 15 as printed"
        panel.line(sign * amplitude * across, sign * printed * up, color, literal, width=0.7)


def _damping(panel: Panel, analysis: HilbertAnalysis, unit: str) -> None:
    scale = scale_of(unit, max(float(c.amplitude.max()) for c in analysis.curves))
    shown = []
    for method, (color, dash, label) in _METHODS.items():
        for curve in analysis.of(method):
            # dry friction dissipates by the speed: below and above its resonance a rig shows two dampings
            peak = int(np.argmax(curve.amplitude))
            for side in (slice(None, peak), slice(peak, None)):
                a, h, std = medians(curve.amplitude[side], curve.damping[side], curve.damping_std[side])
                if a.size < 2:
                    continue
                band = BAND * std
                panel.band(a * scale.factor, h - band, h + band, color, alpha=0.25)
                panel.line(a * scale.factor, h, color, label, dash=dash)
                shown.append((h, band))
    panel.x.set(log=True, label=scale.label("Amplitude"))
    panel.y.set(label="Damping h [1/s]")
    panel.title = "Damping curve"
    _view(panel, *(np.concatenate(part) for part in zip(*shown, strict=True)))


def _view(panel: Panel, values: np.ndarray, band: np.ndarray) -> None:
    """A view of the values that are known better than a third of themselves, from zero where they are positive."""
    sure = values[band < 0.3 * np.abs(values)]
    shown = sure if sure.size else values
    low, high = (float(q) for q in np.quantile(shown, (0.01, 0.99)))
    margin = 0.3 * max(high - low, 0.2 * abs(high))
    panel.y.set(low=min(0.0, low - margin) if low < 0 else 0.0, high=high + margin)

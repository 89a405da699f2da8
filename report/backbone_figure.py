"""Fig. 4 of the paper as one picture: backbones of decays and forced records, of model and FMU, and Eq. 14."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from ..model.backbone import exact_backbone
from ..model.describing import natural_motion
from ..model.display import Scale, number, pretty_unit, scale_of
from ..model.frequency_response import FrequencyResponse, frequency_response
from ..model.inner_force import without_memory
from .levels import sine_levels
from .style import EXACT, FORCED, FREE, MODEL, RESPONSE, drawing, legend_below, log_ticks, svg

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..model import Oscillator
    from ..verify.verification import Verification

_TWO_PI = 2 * np.pi
#: At most this many points of a measured curve are drawn.
_POINTS = 240
#: A mean backbone is computed at no more than so many amplitudes: each is an integration.
_MEAN_POINTS = 48
#: Eq. 14 is drawn out to where the response has come down to this part of its peak.
_SKIRT = 0.22


def backbone_figure(identification: Identification, verification: Verification | None = None) -> str:
    """SVG of the backbones: amplitude over frequency, and beside it the same close up over a logarithmic amplitude.

    Left: FREEVIB of every decay (dash-dot), FORCEVIB of every forced record (dotted), Eq. 14 at the levels at which the
    rig was driven (dashed), the model's exact backbone (thin), and where an FMU was verified its backbones (markers).
    """
    model = identification.oscillator
    curves = identification.measured.curves
    amplitudes = [c.amplitude for c in curves]
    if verification is not None:
        amplitudes += [b.amplitude for check in verification.recordings for pair in check.backbones for b in pair]
    top = max((float(a.max()) for a in amplitudes if a.size), default=0.0)
    top = max(top, model.amplitude.max if model.amplitude else 0.0) or 1.0
    floor = min((float(a.min()) for a in amplitudes if a.size), default=top / 100)
    responses = _responses(identification, top)
    scale = scale_of(model.response.displacement_unit, max([top, *(float(r.amplitude.max()) for _, r in responses)]))
    exact = model_backbone(model, np.geomspace(floor, top, 160))
    kind = backbone_kind(model)
    with drawing(height=5.2) as figure:
        main, close = figure.subplots(1, 2, width_ratios=[1.75, 1])
        for label, response in responses:
            omega, amplitude = response.curve()
            style = {"linestyle": "--", "color": RESPONSE, "linewidth": 1.2}
            known = "" if label else ", to the largest amplitude"
            main.plot(omega / _TWO_PI, amplitude * scale.factor, label=f"response, Eq. 14{known}", **style)
            peak = (response.omega0[-1] / _TWO_PI, response.amplitude[-1] * scale.factor)
            main.annotate(label, peak, (7, 0), textcoords="offset points", color=RESPONSE, fontsize=9)
        for axes in (main, close):
            _curves(axes, identification, scale)
            axes.plot(
                exact[1] / _TWO_PI,
                exact[0] * scale.factor,
                color=EXACT,
                linewidth=0.9,
                zorder=1.9,
                label=f"model, {kind} backbone",
            )
            if verification is not None:
                _fmu(axes, verification, scale, even=axes is main)
            axes.set_xlabel("Frequency [Hz]")
        main.set_ylabel(scale.label("Amplitude"))
        main.set_ylim(0, None)
        main.set_xlim(*_window(responses, identification))
        main.set_title("Backbones and response")
        close.set_yscale("log")
        close.set_ylabel(scale.label("Amplitude"))
        close.set_title("Backbones close up")
        close.locator_params(axis="x", nbins=5)
        log_ticks(close.yaxis)
        handles, labels = _once(main)
        legend_below(figure, handles, labels, columns=3)
        title = f"Natural frequency in Hz over amplitude in {scale.unit}, by {_sources(identification, verification)}"
        return svg(figure, "backbone", title)


def model_backbone(model: Oscillator, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes (n,) and the model's natural frequencies (n,), rad/s, of those at which it swings freely.

    Exact by the energy integral; with a law that has a memory there is none, and they are the mean ones.
    """
    if backbone_kind(model) == "mean":
        amplitude = amplitude[:: -(-amplitude.size // _MEAN_POINTS)]
        omega, _ = natural_motion(model, amplitude)
        there = np.isfinite(omega)
        return amplitude[there], omega[there]
    try:
        return amplitude, exact_backbone(model, amplitude)
    except BadInput:
        pass
    points = []
    for a in amplitude:  # a negative preload or a softening spring swings at some amplitudes only
        try:
            points.append((a, float(exact_backbone(model, float(a))[0])))
        except BadInput:
            continue
    table = np.array(points).reshape(-1, 2)
    return table[:, 0], table[:, 1]


def backbone_kind(model: Oscillator) -> str:
    """``exact`` or ``mean``: which backbone ``model_backbone`` gives."""
    return "exact" if without_memory(model)[1] is None else "mean"


def _responses(identification: Identification, top: float) -> list[tuple[str, FrequencyResponse]]:
    """Eq. 14 at every level of a recorded sine; else at the one level that reaches the largest amplitude."""
    model = identification.oscillator
    responses = []
    unit = pretty_unit(model.force_unit)
    if model.mass is not None:
        for level in sine_levels(identification.recordings):
            try:
                responses.append((f"{number(level)} {unit}", frequency_response(model, level)))
            except BadInput:
                continue
    if not responses:
        try:
            level = _level_for(model, top)
            response = frequency_response(model, level * (model.mass.value if model.mass else 1.0))
            responses.append(("", response))
        except BadInput:
            pass  # negative damping: no force has a steady response, and there is nothing to draw
    return responses


def _level_for(model: Oscillator, amplitude: float) -> float:
    """Force per unit mass whose response peaks at ``amplitude``: f = 2 h A sqrt(omega0² - h²), from Eq. 14."""
    omega, h = (float(series[0]) for series in natural_motion(model, amplitude))
    if not omega > 0:
        raise BadInput("the spring has softened to nothing at this amplitude; choose a smaller one")
    return 2 * h * amplitude * float(np.sqrt(max(omega**2 - h**2, 0.0)))


def _curves(axes: Any, identification: Identification, scale: Scale) -> None:
    styles = {"freevib": (FREE, "-.", "decays, FREEVIB"), "forcevib": (FORCED, ":", "forced records, FORCEVIB")}
    for curve in identification.measured.curves:
        color, line, label = styles[curve.method]
        step = max(1, curve.amplitude.size // _POINTS)
        order = np.argsort(curve.amplitude)[::step]
        axes.plot(
            curve.omega0[order] / _TWO_PI,
            curve.amplitude[order] * scale.factor,
            linestyle=line,
            color=color,
            linewidth=1.5 if curve.method == "freevib" else 2.2,
            label=label,
        )


def _fmu(axes: Any, verification: Verification, scale: Scale, *, even: bool) -> None:
    styles = {"FREEVIB": ("s", 3.6), "regression": ("o", 4.4)}
    pairs = [pair for check in verification.recordings for pair in check.backbones]
    count = int(np.clip(24 // max(len(pairs), 1), 2, 8))
    for i, (_, own) in enumerate(pairs):
        marker, size = styles.get(own.method, ("o", 4.0))
        a, f = own.amplitude, own.frequency
        if a.size < 2:
            continue
        # every curve elsewhere, so that markers do not hide one another
        shift = (np.arange(count) + (i % 4 + 0.5) / 4) / count
        spots = a.min() + (a.max() - a.min()) * shift if even else a.min() * (a.max() / a.min()) ** shift
        order = np.argsort(a)
        axes.plot(
            np.interp(spots, a[order], f[order]),
            spots * scale.factor,
            linestyle="none",
            marker=marker,
            markersize=size,
            markerfacecolor="white",
            markeredgecolor=MODEL,
            markeredgewidth=1.0,
            label=f"FMU's output, {own.method}",
        )


def _window(responses: list[tuple[str, FrequencyResponse]], identification: Identification) -> tuple[float, float]:
    """Frequencies worth seeing: the resonance of the highest response, and the backbones where they are tall."""
    seen = [identification.oscillator.omega0.value]
    peak = max((float(r.amplitude.max()) for _, r in responses), default=0.0)
    for _, response in responses:
        omega, amplitude = response.curve()
        seen += [float(w) for w in omega[amplitude > _SKIRT * peak]]
    for curve in identification.measured.curves:
        seen += [float(w) for w in curve.omega0[curve.amplitude > 0.05 * np.max(curve.amplitude)]]
    low, high = min(seen) / _TWO_PI, max(seen) / _TWO_PI
    margin = 0.04 * (high - low) + 0.005 * high
    return low - margin, high + margin


def _once(axes: Any) -> tuple[list[Any], list[str]]:
    handles: dict[str, Any] = {}
    for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
        handles.setdefault(label, handle)
    return list(handles.values()), list(handles)


def _sources(identification: Identification, verification: Verification | None) -> str:
    methods = {c.method.upper() for c in identification.measured.curves}
    words = [*sorted(methods), "the model", *(["the FMU"] if verification is not None else [])]
    return ", ".join(words)

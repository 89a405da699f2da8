"""Fig. 4 of the paper as one picture: backbones of decays and forced records, of model and FMU, and Eq. 14."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from ..model.backbone import exact_backbone
from ..model.describing import natural_motion
from ..model.display import Scale, number, pretty_unit, scale_of
from ..model.frequency_response import FrequencyResponse, frequency_response
from ..model.inner_force import without_memory
from .chart import Chart, Dash, Note, Panel
from .levels import sine_levels
from .style import EXACT, FORCED, FREE, MODEL, RESPONSE

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..model import Oscillator
    from ..verify.verification import Verification

_TWO_PI = 2 * np.pi
_METHODS: dict[str, tuple[str, Dash, str]] = {
    "freevib": (FREE, "-.", "decays, FREEVIB"),
    "forcevib": (FORCED, ":", "forced records, FORCEVIB"),
}
#: A mean backbone is computed at no more than so many amplitudes: each is an integration.
_MEAN_POINTS = 48
#: Eq. 14 is drawn out to where the response has come down to this part of its peak.
_SKIRT = 0.22


def backbone_figure(identification: Identification, verification: Verification | None = None) -> Chart:
    """Chart of the backbones: amplitude over frequency, and beside it the same close up over a logarithmic amplitude.

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
    chart = Chart("backbone")
    main, close = chart.row(1.75, 1, height=380)
    label = "response, Eq. 14" + ("" if responses and responses[0][0] else ", to the largest amplitude")
    for level, response in responses:
        omega, amplitude = response.curve()
        main.line(omega / _TWO_PI, amplitude * scale.factor, RESPONSE, label, dash="--", width=1.2)
        if level:
            x, y = float(response.omega0[-1]) / _TWO_PI, float(response.amplitude[-1]) * scale.factor
            main.marks.append(Note(x, y, level, RESPONSE))
    for panel in (main, close):
        label = f"model, {kind} backbone"
        panel.line(exact[1] / _TWO_PI, exact[0] * scale.factor, EXACT, label, width=0.9)
        _curves(panel, identification, scale)
        if verification is not None:
            _fmu(panel, verification, scale, even=panel is main)
        panel.x.set(label="Frequency [Hz]")
        panel.y.set(label=scale.label("Amplitude"))
    low, high = _window(responses, identification)
    main.x.set(low=low, high=high)
    main.y.set(low=0.0)
    main.title, close.title = "Backbones and response", "Backbones close up"
    close.y.set(log=True)
    chart.title = f"Natural frequency in Hz over amplitude in {scale.unit}, by {_sources(identification, verification)}"
    return chart


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


def _curves(panel: Panel, identification: Identification, scale: Scale) -> None:
    for curve in identification.measured.curves:
        color, dash, label = _METHODS[curve.method]
        order = np.argsort(curve.amplitude)
        x, y = curve.omega0[order] / _TWO_PI, curve.amplitude[order] * scale.factor
        panel.line(x, y, color, label, dash=dash, width=1.5 if curve.method == "freevib" else 2.2)


def _fmu(panel: Panel, verification: Verification, scale: Scale, *, even: bool) -> None:
    pairs = [pair for check in verification.recordings for pair in check.backbones]
    count = int(np.clip(24 // max(len(pairs), 1), 2, 8))
    for i, (_, own) in enumerate(pairs):
        a, f = own.amplitude, own.frequency
        if a.size < 2:
            continue
        # every curve elsewhere, so that markers do not hide one another
        shift = (np.arange(count) + (i % 4 + 0.5) / 4) / count
        spots = a.min() + (a.max() - a.min()) * shift if even else a.min() * (a.max() / a.min()) ** shift
        order = np.argsort(a)
        at = np.interp(spots, a[order], f[order])
        marker = "s" if own.method == "FREEVIB" else "o"
        label = f"FMU's output, {own.method}"
        panel.dots(at, spots * scale.factor, MODEL, label, marker=marker, size=4.0, hollow=True)


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


def _sources(identification: Identification, verification: Verification | None) -> str:
    methods = {c.method.upper() for c in identification.measured.curves}
    words = [*sorted(methods), "the model", *(["the FMU"] if verification is not None else [])]
    return ", ".join(words)

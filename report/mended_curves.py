"""Backbone and damping curve of the given and of the mended model, beside what the recordings show of them."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..diagnose.wording import effects_in_words
from ..errors import BadInput
from ..model.describing import natural_motion
from ..model.display import scale_of
from ..model.library import KNOWN
from .blocks import Section, Text, picture
from .chart import Chart, Dash
from .style import AFTER, BEFORE, MEASURED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..diagnose.result import Diagnosis
    from ..identify.hilbert.modal_result import ModalCurve
    from ..model import Oscillator

_POINTS = 160
#: A model that states no range is drawn over two decades below the largest motion.
_DECADES = 100.0
#: Into how many steps of amplitude measured curves are gathered, and from how many values on.
_STEPS, _FEWEST = 24, 8
#: How the curves of each method are drawn.
_METHODS: dict[str, tuple[Dash, str]] = {
    "freevib": ("-.", "measured, decays (FREEVIB)"),
    "forcevib": (":", "measured, driven (FORCEVIB)"),
}
#: Narrower than this part of its frequency a backbone is drawn straight.
_STRAIGHT = 0.002


def curves_section(diagnosis: Diagnosis) -> Section:
    """The picture, or why there is none."""
    amplitudes, measured = _amplitudes(diagnosis), diagnosis.measured.curves
    title = "Backbone and damping curve"
    if amplitudes is None:
        return Section(title, (Text("No picture here: no amplitude of the motion is known.", "note"),))
    outside = [e.law for e in diagnosis.effects if e.law in KNOWN and KNOWN[e.law].force is None]
    outside += [e.law for e in diagnosis.effects if e.path == "environment" and e.law not in outside]
    note = (
        f" Of {effects_in_words(outside)} nothing shows here; what differs is how its absence had bent the parameters."
        if outside
        else ""
    )
    after = diagnosis.model if diagnosis.mended else None
    caption = (
        "Natural frequency and damping over amplitude, as a free decay or a slow sweep shows them (describing "
        f"functions): {'before (dashed) and after (full line)' if after else 'the model'}.{note}"
    )
    if measured:
        caption += (
            " Grey: as measured, by the Hilbert transform and without a model; a band holds 95 % of the values of all "
            "recordings at that amplitude. Where a model's line leaves it physics is missing, or a sweep was too fast "
            "for a backbone."
        )
    draw = partial(curves_figure, diagnosis.before, after, *amplitudes, measured)
    return Section(title, (picture(draw, caption),))


def _amplitudes(diagnosis: Diagnosis) -> tuple[float, float] | None:
    """Least and largest amplitude to draw, in the displacement's unit."""
    model = diagnosis.model
    for valid in (model.amplitude, diagnosis.before.amplitude):
        if valid is not None and valid.max > 0 and math.isfinite(valid.max):
            low = valid.min if 0 < valid.min < valid.max else valid.max / _DECADES
            return low, valid.max
    moved = [force.displacement for force in diagnosis.latent]
    moved += [r.measured for r in diagnosis.records if r.response.quantity == "displacement"]
    top = max((float(np.nanmax(np.abs(x), initial=0.0)) for x in moved), default=0.0)
    return (top / _DECADES, top) if top > 0 else None


def curves_figure(
    before: Oscillator,
    after: Oscillator | None,
    low: float,
    top: float,
    measured: Sequence[ModalCurve] = (),
    key: str = "mended-curves",
) -> Chart:
    """Chart of amplitude over natural frequency, and of damping over amplitude.

    Args:
        before, after: the models; one only where ``after`` is None.
        low, top: amplitudes, in the displacement's unit.
        measured: backbones and damping curves of the recordings.
        key: name of the chart within its page.

    Raises:
        BadInput: where neither model swings freely at any of these amplitudes.
    """
    amplitude = np.geomspace(low, top, _POINTS)
    full: dict[str, Any] = {"color": AFTER, "label": "after" if after else "model"}
    pairs = [(before, {"color": BEFORE, "dash": "--", "width": 2.2, "label": "before"} if after else full)]
    if after is not None:
        pairs.append((after, full))
    scale = scale_of(before.response.displacement_unit, top)
    shown = amplitude * scale.factor
    lines: list[tuple[np.ndarray, np.ndarray, dict[str, Any]]] = []
    for model, style in pairs:
        omega, damping = natural_motion(model, amplitude)
        if np.any(np.isfinite(omega)):
            lines.append((omega / (2 * np.pi), damping, style))
    if not lines:
        raise BadInput("neither model swings freely at the amplitudes recorded")
    title = f"Natural frequency in Hz and damping in 1/s over amplitude in {scale.unit}, before and after"
    chart = Chart(key, title)
    backbone, curve = chart.row(1, 1, height=290)
    seen, heights = [frequency for frequency, _, _ in lines], [damping for _, damping, _ in lines]
    for method, (dash, label) in _METHODS.items():
        if not (curves := [curve for curve in measured if curve.method == method]):
            continue
        at, values = gathered(curves)
        look = {"color": MEASURED, "label": label, "dash": dash, "width": 2.0}
        for panel, (less, middle, more), across in ((backbone, values[0], True), (curve, values[1], False)):
            panel.band(at * scale.factor, less, more, MEASURED, alpha=0.25, across=across)
            panel.line(*((middle, at * scale.factor) if across else (at * scale.factor, middle)), **look)
        seen.append(values[0][1])
        heights.append(values[1][1])
    for frequency, damping, style in lines:
        backbone.line(frequency, shown, **style)
        curve.line(shown, damping, **style)
    lowest, highest = (float(end(np.concatenate(seen))) for end in (np.nanmin, np.nanmax))
    margin = 0.06 * (highest - lowest) + _STRAIGHT * highest
    backbone.x.set(label="Frequency [Hz]", low=lowest - margin, high=highest + margin)
    backbone.y.set(label=scale.label("Amplitude"), low=0.0)
    backbone.title = "Backbone"
    lowest, highest = (float(end(np.concatenate(heights))) for end in (np.nanmin, np.nanmax))
    margin = 0.1 * (highest - min(lowest, 0.0)) or 1.0
    curve.x.set(log=True, label=scale.label("Amplitude"))
    curve.y.set(label="Damping h [1/s]", low=lowest - margin if lowest < 0 else 0.0, high=highest + margin)
    curve.title = "Damping curve"
    return chart


def gathered(curves: Sequence[ModalCurve]) -> tuple[np.ndarray, np.ndarray]:
    """Measured curves of one method as one.

    Args:
        curves: of all recordings, one at least.

    Returns:
        Amplitudes (n,), and of frequency in Hz and of damping in 1/s the 0.025, 0.5 and 0.975 quantile of the values
        there, (2, 3, n); NaN where there are too few.
    """
    amplitude = np.concatenate([curve.amplitude for curve in curves])
    values = np.stack(
        [np.concatenate([c.omega0 for c in curves]) / (2 * np.pi), np.concatenate([c.damping for c in curves])]
    )
    edges = np.geomspace(amplitude.min(), amplitude.max(), _STEPS + 1)
    step = np.clip(np.searchsorted(edges, amplitude, side="right") - 1, 0, _STEPS - 1)
    at, found = np.sqrt(edges[1:] * edges[:-1]), np.full((2, 3, _STEPS), np.nan)
    for i in range(_STEPS):
        here = step == i
        if np.count_nonzero(here) >= _FEWEST:
            at[i] = np.median(amplitude[here])
            found[..., i] = np.quantile(values[:, here], (0.025, 0.5, 0.975), axis=1).T
    return at, found

"""Backbone and damping curve of the given and of the mended model."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ..diagnose.wording import effects_in_words
from ..errors import BadInput
from ..model.describing import natural_motion
from ..model.display import scale_of
from ..model.library import KNOWN
from .blocks import Section, Text, picture
from .chart import Chart
from .style import AFTER, BEFORE

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis
    from ..model import Oscillator

_POINTS = 160
#: A model that states no range is drawn over two decades below the largest motion.
_DECADES = 100.0
#: Narrower than this part of its frequency a backbone is drawn straight.
_STRAIGHT = 0.002


def curves_section(diagnosis: Diagnosis) -> Section:
    """The picture, or why there is none."""
    reach = _reach(diagnosis)
    title = "Backbone and damping curve"
    if reach is None:
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
    return Section(title, (picture(lambda: curves_figure(diagnosis.before, after, *reach), caption),))


def _reach(diagnosis: Diagnosis) -> tuple[float, float] | None:
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
    before: Oscillator, after: Oscillator | None, low: float, top: float, key: str = "mended-curves"
) -> Chart:
    """Chart of amplitude over natural frequency, and of damping over amplitude.

    Args:
        before, after: the models; one only where ``after`` is None.
        low, top: amplitudes, in the displacement's unit.
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
    for frequency, damping, style in lines:
        backbone.line(frequency, shown, **style)
        curve.line(shown, damping, **style)
    seen = np.concatenate([frequency for frequency, _, _ in lines])
    lowest, highest = float(np.nanmin(seen)), float(np.nanmax(seen))
    margin = 0.06 * (highest - lowest) + _STRAIGHT * highest
    backbone.x.set(label="Frequency [Hz]", low=lowest - margin, high=highest + margin)
    backbone.y.set(label=scale.label("Amplitude"), low=0.0)
    backbone.title = "Backbone"
    heights = np.concatenate([damping for _, damping, _ in lines])
    if np.nanmin(heights) >= 0:
        curve.y.set(low=0.0, high=1.1 * float(np.nanmax(heights)) or 1.0)
    curve.x.set(log=True, label=scale.label("Amplitude"))
    curve.y.set(label="Damping h [1/s]")
    curve.title = "Damping curve"
    return chart

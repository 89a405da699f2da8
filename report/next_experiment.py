"""The recording to make next: what to play, how it looks, and which models it would tell apart."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..model.display import full_stop, number, scale_of, times_text
from .blocks import Block, Section, Table, Text, picture
from .chart import Box, Chart
from .decimate import envelope
from .style import AFTER, MEASURED

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, Experiment
    from ..model import Oscillator

_PAIRS = 12
_LINES = 500


def experiment_section(diagnosis: Diagnosis) -> Section:
    """Sentence, numbers, picture of the force, pairs of models that it separates."""
    title = "The next experiment"
    plan = diagnosis.experiment
    if plan is None or plan.kind == "none":
        told = bool(diagnosis.effects) and not any(e.indistinguishable_from for e in diagnosis.effects)
        settled = told or diagnosis.verdict == "consistent"
        words = "None is needed to settle the question." if settled else "None was worked out."
        return Section(title, (Text(full_stop(plan.sentence) if plan and plan.sentence.strip() else words),))
    model = diagnosis.model
    blocks: list[Block] = [Text(full_stop(plan.sentence), "note")]
    facts = _facts(plan, model)
    if facts:
        blocks.append(Table(("What to play", ""), facts))
    if plan.signal is not None and plan.signal.size > 8 and math.isfinite(plan.fs) and plan.fs > 0:
        unit = _force_unit(model)
        band = " (band shaded)" if plan.band_hz[1] > plan.band_hz[0] else ""
        caption = f"The force to play, over time and as a spectrum{band}."
        blocks.append(picture(lambda: experiment_figure(plan, unit), caption))
    pairs = sorted(plan.separates, key=lambda pair: -pair[2] if math.isfinite(pair[2]) else math.inf)
    if pairs:
        rows = tuple(
            (first, second, times_text(times) if math.isfinite(times) else "unknown")
            for first, second, times in pairs[:_PAIRS]
        )
        more = f" {len(pairs) - _PAIRS} further pairs are left out." if len(pairs) > _PAIRS else ""
        caption = f"How far apart the two would be in this recording, as a multiple of its noise.{more}"
        blocks.append(Table(("It tells", "from", "Times the noise"), rows, (2,), caption))
    return Section(title, tuple(blocks))


def _force_unit(model: Oscillator) -> str:
    return model.force_unit if model.mass is not None else f"{model.response.displacement_unit}/s2"


def _facts(plan: Experiment, model: Oscillator) -> tuple[tuple[str, str], ...]:
    """Level, band and length as far as they are known."""
    decay = plan.kind == "decay"
    facts = [("Kind", plan.kind)]
    if math.isfinite(plan.level) and plan.level > 0:
        scale = scale_of(model.response.displacement_unit if decay else _force_unit(model), plan.level)
        facts.append(
            ("Release from" if decay else "Largest force", f"{number(plan.level * scale.factor)} {scale.unit}")
        )
    low, high = plan.band_hz
    if math.isfinite(low) and math.isfinite(high) and high > 0 and not decay:
        facts.append(("Band", f"{number(low)} to {number(high)} Hz" if high > low else f"{number(high)} Hz"))
    if math.isfinite(plan.seconds) and plan.seconds > 0:
        facts.append(("Length", f"{number(plan.seconds)} s"))
    if plan.signal is not None and math.isfinite(plan.fs) and plan.fs > 0:
        facts.append(("Sampled at", f"{number(plan.fs, 5)} Hz"))
    return tuple(facts)


def experiment_figure(plan: Experiment, unit: str, key: str = "experiment") -> Chart:
    """Chart of the force to play over time, and of its amplitude spectral density; ``unit`` is the force's."""
    signal = np.nan_to_num(np.asarray(plan.signal, float))
    time = np.arange(signal.size) / plan.fs
    scale = scale_of(unit, signal)
    chart = Chart(key, f"Force to play in {scale.unit} over {time[-1]:.4g} s, and its spectrum")
    over, spectrum = chart.row(1.5, 1, height=220)
    over.line(time, signal * scale.factor, MEASURED, width=0.9)
    over.x.set(label="Time [s]", tight=True)
    over.y.set(label=scale.label("Force"))
    over.title = "Force to play"
    f = np.fft.rfftfreq(signal.size, 1 / plan.fs)
    density = np.abs(np.fft.rfft(signal)) * math.sqrt(2 / (signal.size * plan.fs)) * scale.factor
    top = float(density.max())
    low, high = plan.band_hz
    edge = 1.6 * high if math.isfinite(high) and high > 0 else plan.fs / 2
    view = f <= max(edge, 4 * f[1])
    if math.isfinite(low) and math.isfinite(high) and high > low:
        spectrum.marks.append(Box((low, high), None))
    lines = envelope(f[view], density[view], _LINES)  # the strongest line of each stretch
    spectrum.line(lines.time, np.where(lines.high > 1e-3 * top, lines.high, np.nan), AFTER, width=1.1)
    if top > 0:
        spectrum.y.set(log=True, low=1e-3 * top, high=2 * top)
    spectrum.x.set(label="Frequency [Hz]", low=0.0, high=float(f[view][-1]))
    spectrum.y.set(label=f"Density [{scale.unit}/√Hz]")
    spectrum.title = "Its spectrum"
    return chart

"""Time histories like Figs. 3 and 6 of the paper, and the model laid over them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..export.render import plain_text
from ..model.display import Scale, number, scale_of
from .chart import Box, Chart, Panel
from .comparison import Comparison
from .decimate import envelope
from .style import EXACT, FORCED, FREE, GRID, LIGHT, MEASURED, MODEL, RESPONSE

if TYPE_CHECKING:
    from ..recording.recording import Recording

#: Kind of a stretch that was taken, its first sample and the one behind its last.
Taken = tuple[str, int, int]
#: First sample of a stretch that was left, the one behind its last, and why.
Left = tuple[int, int, str]
#: How each kind is shaded, in words and as a colour, and how strongly.
SHADES = {"free": ("blue", LIGHT), "struck": ("purple", RESPONSE), "driven": ("green", FORCED)}
_SHADE, _LEAVES = 0.22, 0.5
#: What becomes of a piece of each kind.
TAKEN = {
    "free": "it swings by itself, and is simulated without a force",
    "struck": "a blow and what rings after it, simulated together",
    "driven": "it is driven, and simulated with the recorded force",
}
#: Cycles of the close view.
_CYCLES = 7.0


def recording_figure(
    recording: Recording,
    taken: Sequence[Taken] = (),
    key: str = "recording",
    left: Sequence[Left] = (),
    begins: float | None = None,
) -> Chart:
    """Chart of force and response over time, with what was taken of it shaded by its kind, and what was left in grey.

    A page says of each piece what becomes of it to who points at it.

    Args:
        recording: as it was recorded.
        taken: kind, first sample and the one behind the last of each stretch; kinds as in ``SHADES``.
        key: name of the chart within its page.
        left: first sample and the one behind the last of each stretch that was left, and why.
        begins: s, where the first sample stands; None: where its time stamp says.
    """
    name = plain_text(recording.name)
    since = recording.start if begins is None else begins
    time, response = since + np.arange(recording.n) * recording.dt, np.asarray(recording.response, float)
    shown = [(response, recording.unit, recording.quantity.capitalize(), FREE)]
    if recording.force is not None and np.ptp(recording.force) > 0:
        what = "Base" if recording.base else "Force"
        shown.insert(0, (np.asarray(recording.force, float), recording.force_unit, what, MEASURED))
    chart = Chart(key, linked=True)
    for signal, unit, what, color in shown:
        (panel,) = chart.row(1, height=170 if len(shown) > 1 else 220)
        for kind, start, stop in taken:
            ends = _ends(since, recording, start, stop)
            said = f"Taken as {kind}, {_span(ends)}: {TAKEN[kind]}."
            panel.marks.append(Box(ends, None, SHADES[kind][1], _SHADE, said))
        for start, stop, why in left:
            ends = _ends(since, recording, start, stop)
            panel.marks.append(Box(ends, None, GRID, _LEAVES, f"Left, {_span(ends)}: {why}."))
        scale = scale_of(unit, signal)
        panel.line(time, signal * scale.factor, color, width=0.9)
        panel.y.set(label=scale.label(what))
        panel.x.set(label="Time [s]", tight=True)
    free = sum(kind == "free" for kind, _, _ in taken)
    note = f", {_count(free, 'free decay')} shaded" if free else ""
    chart.panels[0].title = name + note
    what = "force and response" if len(shown) > 1 else "response"
    chart.title = f"{name}: measured {what} over {recording.duration:.4g} s{note}"
    return chart


def _ends(since: float, recording: Recording, start: int, stop: int) -> tuple[float, float]:
    return since + start / recording.fs, since + stop / recording.fs


def _span(ends: tuple[float, float]) -> str:
    return f"{number(ends[0], 4)} to {number(ends[1], 4)} s"


def agreement_figure(
    comparison: Comparison, quantity: str, unit: str, key: str = "agreement", source: str = "model"
) -> Chart:
    """Chart of measured and simulated response where they are largest, and of their difference throughout.

    Args:
        comparison: the recording.
        quantity, unit: of the response.
        key: name of the chart within its page.
        source: what simulated: ``model`` or ``FMU``.
    """
    name = plain_text(comparison.name)
    residual = comparison.residual
    scale = scale_of(unit, comparison.measured)
    fine = scale_of(unit, residual)
    chart = Chart(key)
    close, rest = chart.row(1, 1.25)
    _close_view(close, comparison, scale, source)
    close.y.set(label=scale.label(quantity.capitalize()))
    close.title = "Where the motion is largest"
    # at least half a cycle each: the rms of less would itself swing
    cycle = samples_a_cycle(comparison.measured, _peak(comparison))
    bins = int(np.clip(2 * comparison.measured.size / cycle, 20, 500))
    band = envelope(comparison.time, residual * fine.factor, bins)
    rest.band(band.time, band.low, band.high, MODEL, "residual, extremes", alpha=0.35)
    rest.line(band.time, band.rms, MODEL, "residual, rms", width=0.9)
    level = comparison.noise_rms * fine.factor
    rest.rule(level, EXACT, "noise floor, rms")
    rest.x.set(low=float(comparison.time[0]), high=float(comparison.time[-1] + 1 / comparison.fs))
    rest.y.set(label=fine.label(f"{source[0].upper()}{source[1:]} − measured"))
    rest.title = f"What the {source} leaves"
    for panel in (close, rest):
        panel.x.set(label="Time [s]")
    chart.title = f"{name}: measured and simulated response in {scale.unit}, and their difference in {fine.unit}"
    return chart


def _close_view(panel: Panel, comparison: Comparison, scale: Scale, source: str) -> None:
    peak = _peak(comparison)
    half = int(_CYCLES / 2 * samples_a_cycle(comparison.measured, peak))
    first = int(np.argmax(np.isfinite(comparison.simulated)))
    start = min(max(peak - half, first), max(comparison.measured.size - 2 * half, 0))
    view = slice(start, start + 2 * half + 1)
    step = max(1, (2 * half) // 160)  # dots that touch would be a line
    time, measured, simulated = (
        y[view] for y in (comparison.time, comparison.measured * scale.factor, comparison.simulated * scale.factor)
    )
    panel.line(time, simulated, MODEL, source, width=1.2)
    panel.goes_on(comparison.time, comparison.measured * scale.factor, view, MEASURED, width=0.9)
    panel.goes_on(comparison.time, comparison.simulated * scale.factor, view, MODEL, width=1.2)
    panel.dots(time[::step], measured[::step], MEASURED, "measured", size=2.4)
    panel.x.set(tight=True)


def _peak(comparison: Comparison) -> int:
    """The sample of the largest motion among those that were simulated."""
    size = np.abs(comparison.measured - np.median(comparison.measured))
    return int(np.argmax(np.where(np.isfinite(comparison.simulated), size, 0.0)))


def samples_a_cycle(motion: np.ndarray, peak: int) -> float:
    """Samples a cycle of a motion (n,) around the sample ``peak``, from its changes of sign."""
    signal = motion - np.median(motion)
    for reach in (200, 1000, 5000, signal.size):
        piece = signal[max(peak - reach, 0) : peak + reach]
        loud = piece[np.abs(piece) > 0.1 * np.max(np.abs(piece))]
        changes = np.count_nonzero(np.diff(np.sign(loud)))
        if changes >= 4:
            return 2.0 * piece.size / changes
    return signal.size / _CYCLES


def _count(n: int, what: str) -> str:
    return f"{n} {what}" + ("s" if n != 1 else "")

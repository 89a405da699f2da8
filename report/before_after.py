"""Measured response and that of the old and of the mended model: over time, what each leaves over, and its spectrum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..diagnose.verdict import worst_of
from ..export.render import plain_text
from ..model.display import number, percent_text, scale_of, times_text
from ..verify.verification import NOISE_RATIO
from .blocks import Block, Cell, Section, Table, Text, picture
from .chart import Chart, Panel
from .comparison import Comparison
from .decimate import envelope
from .residual import spectral_density
from .style import AFTER, BEFORE, EXACT, MEASURED
from .time_history import samples_a_cycle

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, RecordFit
    from ..model import Oscillator
    from ..model.fit_state import Left

#: Points across a picture of half a page.
_ACROSS = 300
#: So few cycles are drawn one by one, more as the band between their extremes.
_FEW_CYCLES = 40
#: Cycles of the close view, and the most dots in it.
_CYCLES, _DOTS = 8.0, 120
#: A model that runs away does not set the view: so many times the measured motion is shown of it.
_ROOM = 2.0
_LOST = 1e4
#: Less than this part of a simulation has no spectrum worth showing.
_WHOLE = 0.95
#: More recordings than these stand in the table only, so that the page stays small; the first is seen at once.
_PICTURES, _FIRST = 8, 1


def response_section(diagnosis: Diagnosis) -> Section:
    """Tables for held-out and for training recordings, and a picture of the first: a held-out one, if there is any."""
    records = diagnosis.records
    mended = diagnosis.mended
    title = "Measured, before and after" if mended else "Measured and simulated"
    if not records:
        return Section(title, (Text("No recording was compared.", "note"),))
    held, train = ([r for r in records if r.holdout is wanted] for wanted in (True, False))
    blocks: list[Block] = []
    how = "NRMSE: rms(simulated − measured) / std(measured), simulated freely over the whole recording."
    if held:
        blocks.append(fit_table(held, f"Held out: no parameter was fitted to these. {how}", mended))
    if train:
        blocks.append(fit_table(train, "Used for the fit." if held else f"Used for the fit. {how}", mended))
    return Section(title, (*blocks, *_pictures(diagnosis)[:_FIRST]))


def more_responses_section(diagnosis: Diagnosis) -> Section:
    """The pictures of the recordings after the first, and the names of those without one."""
    drawn = _pictures(diagnosis)[_FIRST:]
    rest = [r.file for r in _ordered(diagnosis)[_PICTURES:]]
    if rest:
        drawn.append(Text(f"Without a picture, in the table only: {', '.join(rest)}."))
    return Section("The other recordings, in pictures", tuple(drawn))


def _ordered(diagnosis: Diagnosis) -> list[RecordFit]:
    """The held-out recordings, then those that the given model is farthest from."""
    held, train = ([r for r in diagnosis.records if r.holdout is wanted] for wanted in (True, False))
    return [*held, *sorted(train, key=lambda r: -_excess(r))]


def _pictures(diagnosis: Diagnosis) -> list[Block]:
    mended = diagnosis.mended
    return [
        picture(lambda r=r, i=i: response_figure(r, diagnosis.before, mended, f"response-{i + 1}"), _caption(r, mended))
        for i, r in enumerate(_ordered(diagnosis)[:_PICTURES])
    ]


def fit_sentence(records: Sequence[RecordFit], mended: bool) -> str:
    """How much is left before and after, in the worst recording that counts: a held-out one where there is one."""
    worst = worst_of(records)
    some = [r for r in records if r.holdout] or list(records)
    of = "the held-out recordings" if worst.holdout else "the recordings, none of which was held out"
    which = f"Worst of {of}, {worst.file}" if len(some) > 1 else f"{worst.file}{' (held out)' if worst.holdout else ''}"
    before, after = (_words(left) for left in (worst.left_before, worst.left_after))
    clause = f"the old model leaves {before}, the new one {after}" if mended else f"the model leaves {before}"
    floor = f"{percent_text(100 * worst.noise_floor)}" if math.isfinite(worst.noise_floor) else "an unknown part"
    return f"{which}: {clause}, where noise alone makes {floor}."


def _words(left: Left) -> str:
    if not math.isfinite(left.part):
        return "an unknown part of the motion"
    return f"{percent_text(100 * left.part)} of the motion ({times_text(left.times)} times the noise)"


def ratio_to_floor(record: RecordFit) -> float:
    """NRMSE after mending over the noise floor; NaN where either is not known."""
    return record.left_after.times if math.isfinite(record.left_after.times) else math.nan


def _excess(record: RecordFit) -> float:
    return record.left_before.times


def fit_table(records: Sequence[RecordFit], caption: str, mended: bool) -> Table:
    """NRMSE before and after (one where nothing was mended), noise floor, ratio coloured by the limit of verify."""
    rows: list[tuple[str | Cell, ...]] = []
    for r in records:
        ratio = ratio_to_floor(r)
        tone = "" if not math.isfinite(ratio) else "good" if ratio <= NOISE_RATIO else "bad"
        words = times_text(ratio) if math.isfinite(ratio) else "unknown"
        errors = (r.nrmse_before, r.nrmse_after) if mended else (r.nrmse_before,)
        rows.append((r.file, *(number(v) for v in (*errors, r.noise_floor)), Cell(words, tone)))
    mended_head, plain_head = (
        ("NRMSE before", "NRMSE after", "Noise floor", "After / floor"),
        ("NRMSE", "Noise floor", "NRMSE / floor"),
    )
    head = ("Recording", *(mended_head if mended else plain_head))
    return Table(head, tuple(rows), tuple(range(1, len(head))), caption)


def _caption(record: RecordFit, mended: bool) -> str:
    held = "held out" if record.holdout else "used for the fit"
    lines = "before (dashed), after (full line)" if mended else "the model (full line)"
    errors = f"{number(record.nrmse_before)} before, {number(record.nrmse_after)} after"
    return (
        f"{plain_text(record.file)}, {held}: measured (grey; close up, dots), {lines}. Below: what is left, against "
        "the noise floor; the spectra show at which frequency it lies. "
        f"NRMSE {errors if mended else number(record.nrmse_before)}, noise floor {number(record.noise_floor)}."
    )


def response_figure(record: RecordFit, model: Oscillator, mended: bool, key: str = "response") -> Chart:
    """Chart of one recording: response over all its time and close up, residual over time, and spectra.

    Args:
        record: with the signals measured, before and after.
        model: whose natural frequency is used.
        mended: whether ``after`` is another model than ``before``.
        key: name of the chart within its page.
    """
    measured = np.asarray(record.measured, float)
    sides = _sides(record, mended)
    name = plain_text(record.file)
    response = record.response
    scale = scale_of(response.unit, measured)
    peak = int(np.nanargmax(np.abs(measured - np.median(measured)))) if measured.size else 0
    cycle = max(samples_a_cycle(measured, peak), 1.0)
    chart = Chart(key)
    overview, close = chart.row(1.3, 1, height=250)
    rest, spectra = chart.row(1.3, 1, height=250)
    _overview(overview, record.time, measured * scale.factor, sides, scale.factor, cycle)
    overview.title = f"{name} (held out)" if record.holdout else name
    middle = _differ_most(record, mended, int(cycle))
    _close(close, record.time, measured, sides, scale.factor, peak if middle is None else middle, cycle)
    close.title = "Where the motion is largest" if middle is None else "Where before and after differ most"
    for panel in (overview, close):
        panel.x.set(label="Time [s]", tight=True)
        panel.y.set(label=scale.label(response.quantity.capitalize()))
    _residuals(rest, record, sides, cycle, response.unit)
    rest.x.set(low=float(record.time[0]), high=float(record.time[-1]))
    _spectra(spectra, record, sides, response.unit, model.omega0.value / (2 * math.pi))
    what = "what the models leave over" if mended else "what the model leaves over"
    chart.title = f"{name}: measured and simulated response in {scale.unit}, {what}, and its spectrum"
    return chart


def _sides(record: RecordFit, mended: bool) -> list[tuple[np.ndarray, dict[str, Any]]]:
    """What was simulated, and how it is drawn; one model only where nothing was mended."""
    before: dict[str, Any] = {"color": BEFORE, "dash": "--", "width": 1.5, "label": "before"}
    after: dict[str, Any] = {"color": AFTER, "width": 1.1, "label": "after" if mended else "model"}
    pairs = [(record.before, before), (record.after, after)] if mended else [(record.before, after)]
    # of a model that ran away only the beginning can be drawn
    most = _LOST * float(np.nanmax(np.abs(record.measured), initial=0.0))
    return [(np.where(np.abs(signal) <= most, signal, np.nan), style) for signal, style in pairs]


def _differ_most(record: RecordFit, mended: bool, cycle: int) -> int | None:
    """The sample around which the two models differ most over a cycle; None where they do not."""
    apart = np.nan_to_num(np.asarray(record.after, float) - np.asarray(record.before, float), posinf=0.0, neginf=0.0)
    # a model that ran away differs most where there is nothing left to see of it
    reach = _ROOM * float(np.nanmax(np.abs(record.measured), initial=0.0))
    apart = np.clip(apart, -reach, reach)
    if not mended or not np.any(apart):
        return None
    total = np.concatenate([[0.0], np.cumsum(apart**2)])
    width = min(max(cycle, 1), apart.size)
    return int(np.argmax(total[width:] - total[:-width])) + width // 2


def _overview(panel: Panel, time: np.ndarray, measured: np.ndarray, sides: Any, factor: float, cycle: float) -> None:
    n = measured.size
    if n / cycle <= _FEW_CYCLES:
        panel.line(time, measured, MEASURED, "measured", width=2.4, alpha=0.45)
        for signal, style in sides:
            panel.line(time, signal * factor, **style)
    else:
        bins = int(min(_ACROSS, n / cycle / 2))  # two cycles each: less would show a beat that is not in the signal
        band = envelope(time, measured, bins)
        centres = np.concatenate([time[:1], band.time[1:-1], time[-1:]])  # to the ends of the record
        panel.band(centres, band.low, band.high, MEASURED, "measured")
        for signal, style in sides:
            edge = envelope(time, np.where(np.isfinite(signal), signal, np.nan) * factor, bins)
            panel.line(centres, edge.high, **style)
            panel.line(centres, edge.low, **style)
    _view(panel, measured)


def _close(
    panel: Panel, time: np.ndarray, measured: np.ndarray, sides: Any, factor: float, middle: int, cycle: float
) -> None:
    half = max(int(_CYCLES / 2 * cycle), 2)
    start = min(max(middle - half, 0), max(measured.size - 2 * half, 0))
    view = slice(start, start + 2 * half + 1)
    dots = max(1, math.ceil(measured[view].size / _DOTS))
    panel.goes_on(time, measured * factor, view, MEASURED, width=0.9)
    for signal, style in sides:
        panel.line(time[view], signal[view] * factor, **style)
        panel.goes_on(time, signal * factor, view, **{**style, "label": ""})
    panel.dots(time[view][::dots], measured[view][::dots] * factor, MEASURED, "measured", size=2.4)
    _view(panel, measured[view] * factor)


def _view(panel: Panel, measured: np.ndarray) -> None:
    """The view that the curves ask for, but not far beyond what was measured."""
    low, high = float(np.nanmin(measured, initial=0.0)), float(np.nanmax(measured, initial=0.0))
    room = (high - low) * _ROOM / 2
    if room > 0:
        bottom, top = panel.limits("y")
        panel.y.set(low=max(bottom, low - room), high=min(top, high + room))


def _residuals(panel: Panel, record: RecordFit, sides: Any, cycle: float, unit: str) -> None:
    measured = np.asarray(record.measured, float)
    bins = int(np.clip(measured.size / cycle, 20, _ACROSS))
    floor = record.noise_floor * float(np.nanstd(measured))
    bands = [envelope(record.time, signal - measured, bins) for signal, _ in sides]
    scale = scale_of(unit, np.concatenate([*(band.rms for band in bands), [floor]]))
    seen = []
    for band, (_, style) in zip(bands, sides, strict=True):
        rms = np.where(band.rms > 0, band.rms, np.nan) * scale.factor
        panel.line(band.time, rms, **style)
        seen.append(rms)
    if math.isfinite(floor) and floor > 0:
        panel.rule(floor * scale.factor, EXACT, "noise floor, rms", dash=":", width=1.4)
        seen.append(np.array([floor * scale.factor]))
    _log(panel, seen)
    panel.x.set(label="Time [s]")
    panel.y.set(label=scale.label("Residual, rms"))
    panel.title = "Simulated − measured"


def _spectra(panel: Panel, record: RecordFit, sides: Any, unit: str, natural: float) -> None:
    measured = np.asarray(record.measured, float)
    old = Comparison(
        record.file, record.time, measured, sides[0][0], math.nan, record.noise_floor, True, record.response
    )
    f, response = spectral_density(old.measured, old.fs, natural)
    scale = scale_of(unit, response)
    panel.line(f, response * scale.factor, MEASURED, alpha=0.45, width=2.0)
    seen = [response * scale.factor]
    for signal, style in sides:
        if np.mean(np.isfinite(signal)) < _WHOLE:
            continue
        density = spectral_density(signal - old.measured, old.fs, natural)[1] * scale.factor
        panel.line(f, np.where(density > 0, density, np.nan), **style)
        seen.append(density)
    white = old.sensor_rms / np.sqrt(old.fs / 2) * scale.factor
    if white > 0:
        panel.rule(white, EXACT, "sensor noise", dash="-.", width=0.9)
        seen.append(np.array([white]))
    _log(panel, seen)
    panel.x.set(label="Frequency [Hz]", tight=True)
    panel.y.set(label=f"Density [{scale.unit}/√Hz]")
    panel.title = "Spectra"


def _log(panel: Panel, seen: list[np.ndarray]) -> None:
    """A logarithmic axis from a third of the least worth seeing, at most six decades down."""
    values = np.concatenate([np.ravel(v) for v in seen])
    values = values[np.isfinite(values) & (values > 0)]
    if not values.size:
        return
    top = float(np.max(values))
    panel.y.set(log=True, low=max(float(np.quantile(values, 0.02)) / 2, 1e-6 * top), high=2 * top)

"""Measured response and that of the old and of the mended model: over time, what each leaves over, and its spectrum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..export.render import plain_text
from ..model.display import number, scale_of, times_text
from ..verify.verification import NOISE_RATIO
from .blocks import Block, Cell, Section, Table, Text, picture
from .comparison import Comparison
from .decimate import envelope
from .residual import spectral_density
from .style import AFTER, BEFORE, EXACT, MEASURED, drawing, legend_below, log_ticks, svg
from .time_history import samples_a_cycle

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, RecordFit
    from ..model import Oscillator

#: Points across a picture of half a page.
_ACROSS = 300
#: So few cycles are drawn one by one, more as the band between their extremes.
_FEW_CYCLES = 40
#: Cycles of the close view, and the most points and dots in it.
_CYCLES, _POINTS, _DOTS = 8.0, 600, 120
#: A model that runs away does not set the view: so many times the measured motion is shown of it.
_ROOM = 2.0
_LOST = 1e4
#: Less than this part of a simulation has no spectrum worth showing.
_WHOLE = 0.95
#: More recordings than these stand in the table only, so that the page stays small.
_PICTURES = 8


def response_section(diagnosis: Diagnosis) -> Section:
    """Tables for held-out and for training recordings, and a picture for each, the held-out ones first."""
    records = diagnosis.records
    mended = bool(diagnosis.effects)
    title = "Measured, before and after" if mended else "Measured and simulated"
    if not records:
        return Section(title, (Text("No recording was compared.", "note"),))
    held, train = ([r for r in records if r.holdout is wanted] for wanted in (True, False))
    blocks: list[Block] = [Text(fit_sentence(records, mended))]
    how = "NRMSE: rms(simulated − measured) / std(measured), simulated freely over the whole recording."
    if held:
        blocks.append(fit_table(held, f"Held out: no parameter was fitted to these. {how}", mended))
    if train:
        blocks.append(fit_table(train, "Used for the fit." if held else f"Used for the fit. {how}", mended))
    shown = [*held, *sorted(train, key=lambda r: -_excess(r))][:_PICTURES]
    for i, r in enumerate(shown):
        caption = _caption(r, mended)
        blocks.append(
            picture(lambda r=r, i=i: response_figure(r, diagnosis.before, mended, f"response-{i + 1}"), caption)
        )
    rest = [r.file for r in records if r not in shown]
    if rest:
        blocks.append(Text(f"Without a picture, in the table only: {', '.join(rest)}."))
    return Section(title, tuple(blocks))


def fit_sentence(records: Sequence[RecordFit], mended: bool) -> str:
    """How much is left before and after, in the worst recording that counts: a held-out one where there is one."""
    held = [r for r in records if r.holdout]
    some = held or list(records)
    worst = max(some, key=lambda r: r.nrmse_before if math.isfinite(r.nrmse_before) else math.inf)
    of = "the held-out recordings" if held else "the recordings, none of which was held out"
    which = f"Worst of {of}, {worst.file}" if len(some) > 1 else f"{worst.file}{' (held out)' if held else ''}"
    before, after, floor = (_share(v) for v in (worst.nrmse_before, worst.nrmse_after, worst.noise_floor))
    clause = (
        f"the old model leaves {before} of the motion, the new one {after}"
        if mended
        else f"the model leaves {before} of the motion"
    )
    return f"{which}: {clause}, where noise alone makes {floor}."


def _share(nrmse: float) -> str:
    return f"{number(100 * nrmse)} %" if math.isfinite(nrmse) else "an unknown part"


def ratio_to_floor(record: RecordFit) -> float:
    """NRMSE after mending over the noise floor; NaN where either is not known."""
    return record.nrmse_after / record.noise_floor if record.noise_floor > 0 else math.nan


def _excess(record: RecordFit) -> float:
    ratio = record.nrmse_before / record.noise_floor if record.noise_floor > 0 else math.inf
    return ratio if math.isfinite(ratio) else math.inf


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


def response_figure(record: RecordFit, model: Oscillator, mended: bool, key: str = "response") -> str:
    """SVG of one recording: response over all its time and close up, residual over time, and spectra.

    Args:
        record: with the signals measured, before and after.
        model: whose natural frequency is used.
        mended: whether ``after`` is another model than ``before``.
        key: name of the picture within its page.
    """
    measured = np.asarray(record.measured, float)
    sides = _sides(record, mended)
    name = plain_text(record.file)
    response = record.response
    scale = scale_of(response.unit, measured)
    peak = int(np.nanargmax(np.abs(measured - np.median(measured)))) if measured.size else 0
    cycle = max(samples_a_cycle(measured, peak), 1.0)
    with drawing(height=5.7) as figure:
        grid = figure.subplots(2, 2, width_ratios=[1.3, 1])
        (overview, close), (rest, spectra) = grid
        _overview(overview, record.time, measured * scale.factor, sides, scale.factor, cycle)
        overview.set_title(f"{name} (held out)" if record.holdout else name)
        middle = _differ_most(record, mended, int(cycle))
        _close(close, record.time, measured, sides, scale.factor, peak if middle is None else middle, cycle)
        close.set_title("Where the motion is largest" if middle is None else "Where before and after differ most")
        for axes in (overview, close):
            axes.set_xlabel("Time [s]")
            axes.set_ylabel(scale.label(response.quantity.capitalize()))
        _residuals(rest, record, sides, cycle, response.unit)
        rest.set_xlim(overview.get_xlim())
        _spectra(spectra, record, sides, response.unit, model.omega0.value / (2 * math.pi))
        handles: dict[str, Any] = {}
        for axes in grid.flat:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                handles.setdefault(label, handle)
        legend_below(figure, list(handles.values()), list(handles), columns=5)
        title = f"{name}: measured and simulated response in {scale.unit}, what the models leave over, and its spectrum"
        return svg(figure, key, title)


def _sides(record: RecordFit, mended: bool) -> list[tuple[np.ndarray, dict[str, Any]]]:
    """What was simulated, and how it is drawn; one model only where nothing was mended."""
    before = {"color": BEFORE, "linestyle": "--", "linewidth": 1.5, "label": "before"}
    after = {"color": AFTER, "linestyle": "-", "linewidth": 1.1, "label": "after" if mended else "model"}
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


def _overview(axes: Any, time: np.ndarray, measured: np.ndarray, sides: Any, factor: float, cycle: float) -> None:
    n = measured.size
    if n / cycle <= _FEW_CYCLES:
        step = max(1, n // (3 * _ACROSS))
        axes.plot(time[::step], measured[::step], color=MEASURED, linewidth=2.4, alpha=0.45, label="measured")
        for signal, style in sides:
            axes.plot(time[::step], signal[::step] * factor, **style)
    else:
        bins = int(min(_ACROSS, n / cycle / 2))  # two cycles each: less would show a beat that is not in the signal
        band = envelope(time, measured, bins)
        centres = np.concatenate([time[:1], band.time[1:-1], time[-1:]])  # to the ends of the record
        axes.fill_between(centres, band.low, band.high, color=MEASURED, alpha=0.3, linewidth=0, label="measured")
        for signal, style in sides:
            edge = envelope(time, np.where(np.isfinite(signal), signal, np.nan) * factor, bins)
            axes.plot(centres, edge.high, **style)
            axes.plot(centres, edge.low, **{**style, "label": "_nolegend_"})
    axes.set_xlim(time[0], time[-1])
    _view(axes, measured)


def _close(
    axes: Any, time: np.ndarray, measured: np.ndarray, sides: Any, factor: float, middle: int, cycle: float
) -> None:
    half = max(int(_CYCLES / 2 * cycle), 2)
    start = min(max(middle - half, 0), max(measured.size - 2 * half, 0))
    view = slice(start, start + 2 * half + 1)
    size = measured[view].size
    dots, points = max(1, math.ceil(size / _DOTS)), max(1, math.ceil(size / _POINTS))
    for signal, style in sides:
        axes.plot(time[view][::points], signal[view][::points] * factor, **style)
    axes.plot(
        time[view][::dots],
        measured[view][::dots] * factor,
        linestyle="none",
        marker="o",
        markersize=2.4,
        color=MEASURED,
    )
    axes.margins(x=0)
    _view(axes, measured[view] * factor)


def _view(axes: Any, measured: np.ndarray) -> None:
    """The view that the curves ask for, but not far beyond what was measured."""
    low, high = float(np.nanmin(measured, initial=0.0)), float(np.nanmax(measured, initial=0.0))
    room = (high - low) * _ROOM / 2
    if room > 0:
        bottom, top = axes.get_ylim()
        axes.set_ylim(max(bottom, low - room), min(top, high + room))


def _residuals(axes: Any, record: RecordFit, sides: Any, cycle: float, unit: str) -> None:
    measured = np.asarray(record.measured, float)
    bins = int(np.clip(measured.size / cycle, 20, _ACROSS))
    floor = record.noise_floor * float(np.nanstd(measured))
    bands = [envelope(record.time, signal - measured, bins) for signal, _ in sides]
    scale = scale_of(unit, np.concatenate([*(band.rms for band in bands), [floor]]))
    seen = []
    for band, (_, style) in zip(bands, sides, strict=True):
        rms = np.where(band.rms > 0, band.rms, np.nan) * scale.factor
        axes.plot(band.time, rms, **style)
        seen.append(rms)
    if math.isfinite(floor) and floor > 0:
        axes.axhline(floor * scale.factor, color=EXACT, linestyle=":", linewidth=1.4, label="noise floor, rms")
        seen.append(np.array([floor * scale.factor]))
    _log(axes, seen)
    axes.set_xlabel("Time [s]")
    axes.set_ylabel(scale.label("Residual, rms"))
    axes.set_title("Simulated − measured")


def _spectra(axes: Any, record: RecordFit, sides: Any, unit: str, natural: float) -> None:
    measured = np.asarray(record.measured, float)
    old = Comparison(
        record.file, record.time, measured, sides[0][0], math.nan, record.noise_floor, True, record.response
    )
    f, response = spectral_density(old.measured, old.fs, natural)
    scale = scale_of(unit, response)
    axes.plot(f, response * scale.factor, color=MEASURED, alpha=0.45, linewidth=2.0)
    seen = [response * scale.factor]
    for signal, style in sides:
        if np.mean(np.isfinite(signal)) < _WHOLE:
            continue
        density = spectral_density(signal - old.measured, old.fs, natural)[1] * scale.factor
        axes.plot(f, np.where(density > 0, density, np.nan), **style)
        seen.append(density)
    white = old.sensor_rms / np.sqrt(old.fs / 2) * scale.factor
    if white > 0:
        axes.axhline(white, color=EXACT, linestyle="-.", linewidth=0.9, label="sensor noise")
        seen.append(np.array([white]))
    axes.margins(x=0)
    _log(axes, seen)
    axes.set_xlabel("Frequency [Hz]")
    axes.set_ylabel(f"Density [{scale.unit}/√Hz]")
    axes.set_title("Spectra")


def _log(axes: Any, seen: list[np.ndarray]) -> None:
    """A logarithmic axis from a third of the least worth seeing, at most six decades down."""
    values = np.concatenate([np.ravel(v) for v in seen])
    values = values[np.isfinite(values) & (values > 0)]
    if not values.size:
        return
    top = float(np.max(values))
    axes.set_yscale("log")
    axes.set_ylim(max(float(np.quantile(values, 0.02)) / 2, 1e-6 * top), 2 * top)
    log_ticks(axes.yaxis)

"""Time histories like Figs. 3 and 6 of the paper, and the model laid over them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..export.render import plain_text
from ..model.display import Scale, scale_of
from .comparison import Comparison
from .decimate import draw_signal, envelope
from .style import EXACT, FREE, LIGHT, MEASURED, MODEL, drawing, legend_below, svg

if TYPE_CHECKING:
    from ..identify.motion.decays import Decay
    from ..recording.recording import Recording

#: Cycles of the close view.
_CYCLES = 7.0


def recording_figure(recording: Recording, decays: Sequence[Decay] = (), key: str = "recording") -> str:
    """SVG of force and response over time, free decays shaded; ``key`` names the picture within its page."""
    name = plain_text(recording.name)
    time, response = recording.time, np.asarray(recording.response, float)
    forced = recording.force is not None and np.ptp(recording.force) > 0
    with drawing(height=3.9 if forced else 2.6) as figure:
        rows = figure.subplots(2 if forced else 1, 1, sharex=True, squeeze=False)[:, 0]
        if forced and recording.force is not None:
            force = np.asarray(recording.force, float)
            scale = scale_of(recording.force_unit, force)
            draw_signal(rows[0], time, force * scale.factor, MEASURED)
            rows[0].set_ylabel(scale.label("Force"))
        scale = scale_of(recording.unit, response)
        draw_signal(rows[-1], time, response * scale.factor, FREE)
        rows[-1].set_ylabel(scale.label(recording.quantity.capitalize()))
        rows[-1].set_xlabel("Time [s]")
        for axes in rows:
            for decay in decays:
                start, stop = (recording.start + i / recording.fs for i in (decay.start, decay.stop))
                axes.axvspan(start, stop, color=LIGHT, alpha=0.22, linewidth=0)
        note = f", {_count(len(decays), 'free decay')} shaded" if decays else ""
        rows[0].set_title(name + note)
        what = "force and response" if forced else "response"
        return svg(figure, key, f"{name}: measured {what} over {recording.duration:.4g} s{note}")


def agreement_figure(
    comparison: Comparison, quantity: str, unit: str, key: str = "agreement", source: str = "model"
) -> str:
    """SVG of measured and simulated response where they are largest, and of their difference throughout.

    Args:
        comparison: the recording.
        quantity, unit: of the response.
        key: name of the picture within its page.
        source: what simulated: ``model`` or ``FMU``.
    """
    name = plain_text(comparison.name)
    residual = comparison.residual
    scale = scale_of(unit, comparison.measured)
    fine = scale_of(unit, residual)
    with drawing(height=3.3) as figure:
        close, rest = figure.subplots(1, 2, width_ratios=[1, 1.25])
        _close_view(close, comparison, scale, source)
        close.set_ylabel(scale.label(quantity.capitalize()))
        close.set_title("Where the motion is largest")
        # at least half a cycle each: the rms of less would itself swing
        cycle = samples_a_cycle(comparison.measured, _peak(comparison))
        bins = int(np.clip(2 * comparison.measured.size / cycle, 20, 500))
        band = envelope(comparison.time, residual * fine.factor, bins)
        rest.fill_between(
            band.time, band.low, band.high, color=MODEL, alpha=0.35, linewidth=0, label="residual, extremes"
        )
        rest.plot(band.time, band.rms, color=MODEL, linewidth=0.9, label="residual, rms")
        level = comparison.noise_rms * fine.factor
        floor = "noise floor, rms" if comparison.full_floor else "sensor noise, rms"
        rest.axhline(level, color=EXACT, linestyle="--", linewidth=1.1, label=floor)
        rest.set_xlim(comparison.time[0], comparison.time[-1] + 1 / comparison.fs)
        rest.set_ylabel(fine.label(f"{source[0].upper()}{source[1:]} − measured"))
        rest.set_title(f"What the {source} leaves")
        for axes in (close, rest):
            axes.set_xlabel("Time [s]")
        handles, labels = close.get_legend_handles_labels()
        more, words = rest.get_legend_handles_labels()
        legend_below(figure, handles + more, labels + words, columns=5)
        title = f"{name}: measured and simulated response in {scale.unit}, and their difference in {fine.unit}"
        return svg(figure, key, title)


def _close_view(axes: Any, comparison: Comparison, scale: Scale, source: str) -> None:
    peak = _peak(comparison)
    half = int(_CYCLES / 2 * samples_a_cycle(comparison.measured, peak))
    first = int(np.argmax(np.isfinite(comparison.simulated)))
    start = min(max(peak - half, first), max(comparison.measured.size - 2 * half, 0))
    view = slice(start, start + 2 * half + 1)
    step = max(1, (2 * half) // 160)  # dots that touch would be a line
    time, measured, simulated = (
        y[view] for y in (comparison.time, comparison.measured * scale.factor, comparison.simulated * scale.factor)
    )
    axes.plot(
        time[::step], measured[::step], linestyle="none", marker="o", markersize=2.4, color=MEASURED, label="measured"
    )
    axes.plot(time, simulated, color=MODEL, linewidth=1.2, label=source)
    axes.margins(x=0)


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

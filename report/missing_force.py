"""The force that a model lacks: as a smoother finds it that knows no law, and as the named effects make it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..export.render import plain_text
from ..model import units
from ..model.display import Scale, scale_of
from .blocks import Block, Section, Text, picture
from .chart import Chart, Panel
from .style import AFTER, LIGHT, MEASURED
from .time_history import samples_a_cycle

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, LatentForce

_BINS = 41
_FEWEST = 5
_CYCLES = 10.0
_POINTS = 600
_PICTURES = 3
#: Standard errors that a force must exceed somewhere to be worth a picture.
_SURE = 3.0


def force_section(diagnosis: Diagnosis) -> Section:
    """A picture of the recording that shows the missing force best."""
    title = "The missing force"
    usable, drawn = _usable(diagnosis), _drawn(diagnosis)
    if not drawn:
        why = "nothing is missing" if diagnosis.verdict == "consistent" else "it was not reconstructed"
        return Section(title, (Text(f"There is no missing force to show: {why}."),))
    blocks: list[Block] = [
        Text(
            "Per unit mass and positive where it opposes a positive motion, as inside the bracket of the equation. It "
            "was found by a smoother that knows no law. Where the band of the spread is narrow the force is a "
            "function of that variable; where it is wide something else decides it: the other variable, time, or the "
            "motion before."
        )
    ]
    blocks.append(drawn[0])
    quiet = [latent.file for latent in usable if not _rises(latent)]
    if quiet and len(quiet) < len(usable):
        blocks.append(Text(f"In {', '.join(quiet)} it does not rise above its uncertainty."))
    return Section(title, tuple(blocks))


def more_forces(diagnosis: Diagnosis) -> list[Block]:
    """The pictures of the other recordings that show it."""
    return _drawn(diagnosis)[1:]


def _usable(diagnosis: Diagnosis) -> list[LatentForce]:
    return [latent for latent in diagnosis.latent if latent.force.size > 1 and np.any(np.isfinite(latent.force))]


def _drawn(diagnosis: Diagnosis) -> list[Block]:
    usable, unit = _usable(diagnosis), diagnosis.model.response.displacement_unit
    drawn = []
    for i, latent in enumerate([latent for latent in usable if _rises(latent)][:_PICTURES] or usable[:1]):
        named = " Line: the named effects along the same motion, averaged alike." if latent.named is not None else ""
        caption = (
            f"{plain_text(latent.file)}: mean of the missing force over displacement and over velocity, with its "
            "spread (light) and the smoother's standard error (dark); below, a stretch of it over time (thick grey)."
            f"{named}"
        )
        drawn.append(picture(lambda latent=latent, i=i: force_figure(latent, unit, f"missing-{i + 1}"), caption))
    return drawn


def _rises(latent: LatentForce) -> bool:
    """Whether the force is anywhere beyond what its standard error explains; also where that is not known."""
    force, std = np.asarray(latent.force, float), np.asarray(latent.std, float)
    known = np.isfinite(force) & (std > 0)
    return not known.any() or bool(np.max(np.abs(force[known]) / std[known]) > _SURE)


def force_figure(latent: LatentForce, unit: str, key: str = "missing") -> Chart:
    """Chart of the missing force over displacement, over velocity and over time.

    Args:
        latent: force with its standard deviation along one recording.
        unit: of the displacement.
        key: name of the chart within its page.
    """
    force, std = np.asarray(latent.force, float), np.asarray(latent.std, float)
    named = None if latent.named is None else np.asarray(latent.named, float)
    up = scale_of(units.compose("X/s2", unit), force)
    name = plain_text(latent.file)
    title = f"{name}: missing force per unit mass in {up.unit} over displacement, velocity and time"
    chart = Chart(key, title)
    for panel, motion, what, symbol in zip(
        chart.row(1, 1),
        (latent.displacement, latent.velocity),
        ("Displacement", "Velocity"),
        ("X", "X/s"),
        strict=True,
    ):
        across = scale_of(units.compose(symbol, unit), motion)
        _over(panel, np.asarray(motion, float) * across.factor, force, std, named, up)
        panel.x.set(label=across.label(what))
        panel.y.set(label=up.label("Force per unit mass"))
        panel.title = f"Over {what.lower()}"
    (stretch,) = chart.row(1, height=230)
    _stretch(stretch, latent, force, std, named, up)
    stretch.title = f"Over time, {name}"
    return chart


def _over(
    panel: Panel, at: np.ndarray, force: np.ndarray, std: np.ndarray, named: np.ndarray | None, up: Scale
) -> None:
    """Means over bins of ``at``; the band of the spread is the standard deviation of what falls into the bin."""
    there = np.isfinite(at) & np.isfinite(force)
    if not there.any():
        return
    low, high = float(at[there].min()), float(at[there].max())
    if not high > low:
        return
    place = np.clip(((at[there] - low) / (high - low) * _BINS).astype(int), 0, _BINS - 1)
    count = np.bincount(place, minlength=_BINS)
    full = count >= _FEWEST
    if not full.any():
        return

    def mean(values: np.ndarray) -> np.ndarray:
        known = np.isfinite(values[there])
        total = np.bincount(place[known], values[there][known], _BINS)[full]
        many = np.bincount(place[known], minlength=_BINS)[full]
        return np.where(many > 0, total / np.maximum(many, 1), np.nan) * up.factor

    middle = (low + (np.arange(_BINS) + 0.5) * (high - low) / _BINS)[full]
    centre = mean(force)
    spread = np.sqrt(np.maximum(mean(force**2) / up.factor - (centre / up.factor) ** 2, 0.0)) * up.factor
    error = np.sqrt(np.maximum(mean(std**2) / up.factor, 0.0)) * up.factor
    panel.band(middle, centre - spread, centre + spread, LIGHT, "spread in the bin")
    panel.band(middle, centre - error, centre + error, MEASURED, "± standard error", alpha=0.4)
    panel.dots(middle, centre, MEASURED, "missing force")
    if named is not None:
        panel.line(middle, mean(named), AFTER, _NAMED, width=1.6)


_NAMED = "named effects"


def _stretch(
    panel: Panel, latent: LatentForce, force: np.ndarray, std: np.ndarray, named: np.ndarray | None, up: Scale
) -> None:
    """Some cycles around where the missing force is largest beside its uncertainty."""
    size = np.nan_to_num(np.abs(force - np.nanmedian(force)))
    sure = size / np.where(np.isfinite(std) & (std > 0), std, np.inf)
    middle = int(np.argmax(sure if np.any(sure > 0) else size))
    cycle = samples_a_cycle(np.nan_to_num(np.asarray(latent.displacement, float)), middle)
    half = max(int(_CYCLES / 2 * cycle), 2)
    start = min(max(middle - half, 0), max(force.size - 2 * half, 0))
    view = slice(start, start + 2 * half + 1, max(1, 2 * half // _POINTS))
    time = np.asarray(latent.time, float)[view]
    centre, error = force[view] * up.factor, np.nan_to_num(std[view]) * up.factor
    panel.band(time, centre - error, centre + error, MEASURED, alpha=0.4)
    panel.line(time, centre, MEASURED, width=2.6, alpha=0.45)
    if named is not None:
        panel.line(time, named[view] * up.factor, AFTER, _NAMED, width=1.6)
    panel.x.set(label="Time [s]", tight=True)
    panel.y.set(label=up.label("Force per unit mass"))

"""How well the model reproduces the recordings: the verdict in a sentence, a table, a picture for each."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..export.render import plain_text
from ..identify.signals.hilbert import dominant_frequency
from ..model.display import number, percent_text, times_text
from ..model.equations import FORCE
from ..model.fit_state import LACKING
from .blocks import Block, Cell, Figure, Section, Table, Text
from .comparison import Comparison
from .residual import spectrum_figure
from .time_history import agreement_figure

#: A residual so close to the noise needs no spectrum to look into.
_CLEAN = 1.05
#: Leaving more than this part of the motion is no reproduction, whatever the noise.
_POOR = 0.1


def verdict(shown: Sequence[Comparison]) -> Text:
    """The outcome in one sentence."""
    if not shown:
        return Text("The model was identified, but nothing could be simulated to compare it with.", "bad")
    judged = [c for c in shown if c.passed is not None]
    if not judged:
        return _fit_verdict(shown)
    failed = [c for c in judged if not c.passed]
    if failed:
        worst = max(failed, key=lambda c: c.ratio if math.isfinite(c.nrmse) else math.inf)
        what = FORCE if worst.response.quantity == FORCE else "motion"
        how = (
            f"its simulation leaves {percent_text(100 * worst.nrmse)} of the {what} of {worst.name}, "
            f"{times_text(worst.ratio)} times what noise explains"
            if math.isfinite(worst.nrmse)
            else f"its simulation of {worst.name} diverges"
        )
        rest = f"{len(failed)} of the {len(judged)} recordings" if len(judged) > 1 else "the recording"
        if 1 < len(judged) == len(failed):
            rest = f"any of the {len(judged)} recordings"
        return Text(f"The model does not reproduce {rest}: {how}.", "bad")
    worst = max(judged, key=lambda c: c.ratio)
    held = [c.name for c in judged if c.held_out]
    which = f"all {len(judged)} recordings" if len(judged) > 1 else "the recording"
    if held:
        which += f", among them {', '.join(held)}, which the identification has not seen"
    if worst.ratio > LACKING:  # its own errors are so wide that they allow it
        return Text(
            f"The model reproduces {which} no better than its own errors allow: its FMU leaves "
            f"{percent_text(100 * worst.nrmse)} of the motion of {worst.name}, {times_text(worst.ratio)} times the "
            f"noise, where {percent_text(100 * worst.limit)} would still pass.",
            "note",
        )
    return Text(
        f"The model reproduces {which}: its FMU leaves at most {times_text(worst.ratio)} times the noise floor.", "good"
    )


def _fit_verdict(shown: Sequence[Comparison]) -> Text:
    worst = max(shown, key=lambda c: c.nrmse if math.isfinite(c.nrmse) else math.inf)
    tone = "bad" if not worst.nrmse <= _POOR else "note" if worst.ratio > LACKING else "good"
    of = "the recordings it was identified from" if len(shown) > 1 else "the recording it was identified from"
    where = f" ({worst.name})" if len(shown) > 1 else ""
    return Text(
        f"The model leaves at most {percent_text(100 * worst.nrmse)} of the motion of {of}{where}, "
        f"{times_text(worst.ratio)} times the noise; it was not verified as an FMU here.",
        tone,
    )


def agreement_section(shown: Sequence[Comparison], source: str, natural: float | None = None) -> Section:
    """Table and pictures.

    Args:
        shown: one for each recording.
        source: what simulated, ``model`` or ``FMU``.
        natural: natural frequency, Hz; by default that of each recording's largest line.
    """
    if not shown:
        return Section("Measured and simulated", ())
    blocks: list[Block] = [_table(shown)]
    spectral = _spectral(shown)
    for i, c in enumerate(shown):
        key = f"agreement-{i + 1}"
        name = plain_text(c.name)
        blocks.append(
            Figure(
                agreement_figure(c, c.response.quantity, c.response.unit, key, source),
                f"{name}: measured (dots) and simulated by the {source} (line) where the motion is largest, and what "
                "is left throughout, its rms against the noise.",
            )
        )
        if c in spectral:
            about = natural or dominant_frequency(c.measured, c.fs)
            blocks.append(
                Figure(
                    spectrum_figure(c, about, c.response.unit, f"spectrum-{i + 1}", source),
                    f"{name}: spectra of the response and of what is left. Noise on the force shows at the resonance; "
                    "a peak elsewhere, or one far above the noise, is physics that the model lacks.",
                )
            )
    return Section("Measured and simulated", tuple(blocks))


def _spectral(shown: Sequence[Comparison]) -> list[Comparison]:
    """Which recordings are worth a spectrum: those beyond their noise, else the one that is closest to it."""
    beyond = [c for c in shown if c.passed is False or (c.passed is None and not c.ratio <= _CLEAN)]
    usable = [c for c in shown if math.isfinite(c.nrmse)]
    return [c for c in beyond if c in usable] or ([max(usable, key=lambda c: c.ratio)] if usable else [])


def _table(shown: Sequence[Comparison]) -> Table:
    full = shown[0].by_fmu
    head = ["Recording", "NRMSE", "Noise floor", "Times the noise"]
    if full:
        head += ["Backbone within", "Reproduced"]
    rows = []
    for c in shown:
        row: list[str | Cell] = [c.name + (" (held out)" if c.held_out else "")]
        row += [number(c.nrmse), number(c.noise_floor), times_text(c.ratio)]
        if full:
            row.append("" if c.backbone_error is None else f"{number(c.backbone_error, 2)} Hz")
            row.append(Cell("yes", "good") if c.passed else Cell("no", "bad"))
        rows.append(tuple(row))
    how = (
        "over the whole recording, or over its free decays where no force drives it"
        if full
        else "stretch by stretch, each from initial values of its own"
    )
    caption = (
        f"NRMSE: rms(simulated − measured) / std(measured), simulated freely {how}. Noise floor: the same of a perfect "
        "model, from the noise of the sensor and that of the recorded force. Times the noise: the one over the other."
    )
    return Table(tuple(head), tuple(rows), (1, 2, 3, 4) if full else (1, 2, 3), caption)

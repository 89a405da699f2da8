"""The report of a verification: one HTML page that says whether an FMU answers as recorded, and if not, why."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..export.render import plain_text
from ..model.display import full_stop, number, scale_of
from .agreement import agreement_section, verdict
from .blocks import Block, Items, Page, Section, Table, Text, picture
from .chart import Chart
from .comparison import of_verification
from .style import MEASURED, MODEL

if TYPE_CHECKING:
    from ..verify.verification import RecordingCheck, Verification


def verification_page(verification: Verification) -> Page:
    """The report.

    Args:
        verification: the FMU's runs along the recordings.
    """
    shown = of_verification(verification)
    sections = [
        Section("What does not agree", tuple(_failed(verification))),
        agreement_section(shown, "FMU"),
        Section("Backbones", tuple(_backbones(verification))),
        Section("How it was judged", tuple(_judged(verification))),
    ]
    return Page(f"Verification of {verification.fmu}", sections, lead=[verdict(shown)])


def _failed(verification: Verification) -> list[Block]:
    failures = [f"{c.file}: {full_stop(reason)}" for c in verification.recordings for reason in c.failed]
    return [Items(tuple(failures))] if failures else []


def _backbones(verification: Verification) -> list[Block]:
    return [
        picture(
            lambda c=c, i=i: _backbone_figure(c, f"backbones-{i + 1}"),
            f"{plain_text(c.file)}: natural frequency over amplitude, from the recording and, in the same way, from "
            "the FMU's response.",
        )
        for i, c in enumerate(verification.recordings)
        if c.backbones
    ]


def _backbone_figure(check: RecordingCheck, key: str) -> Chart:
    scale = scale_of(
        check.response.displacement_unit, np.concatenate([b.amplitude for pair in check.backbones for b in pair])
    )
    chart = Chart(key, f"Natural frequency in Hz over amplitude in {scale.unit}, of recording and FMU")
    (panel,) = chart.row(1)
    for recorded, simulated in check.backbones:
        panel.line(recorded.amplitude * scale.factor, recorded.frequency, MEASURED, "recording", width=2.2)
        panel.line(simulated.amplitude * scale.factor, simulated.frequency, MODEL, "FMU", dash="--")
    panel.x.set(label=scale.label("Amplitude"))
    panel.y.set(label="Natural frequency [Hz]")
    return chart


def _judged(verification: Verification) -> list[Block]:
    rows = []
    for c in verification.recordings:
        asks, often = "–", "–"
        if c.score is not None:
            asks = c.score.parameter or "all together"
            often = "often" if c.score.chance > 0.1 else f"once in {number(1 / max(c.score.chance, 1e-99), 2)}"
        over = "–" if c.backbone_over_limit is None else f"{number(100 * c.backbone_over_limit, 2)} %"
        limit = number(c.nrmse_limit, 3) if np.isfinite(c.nrmse_limit) else "–"
        rows.append((c.file, number(c.nrmse, 3), limit, over, asks, often))
    head = ("Recording", "NRMSE", "Allowed", "Backbone, of what is allowed", "Parameter asked for most", "By chance")
    caption = (
        "Allowed: what noise and the model's own errors exceed once in a thousand. Asked for most: the parameter whose "
        "change would bring the simulation nearest to the recording, and how often chance asks for as much."
    )
    blocks: list[Block] = [Table(head, tuple(rows), (1, 2, 3), caption)]
    if besides := [f"{c.file}: {full_stop(words)}" for c in verification.recordings for words in c.besides]:
        blocks += [Text("Left aside, for it is no part of the motion:"), Items(tuple(besides))]
    return blocks

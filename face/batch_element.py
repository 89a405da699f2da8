"""Stages of an entry whose motion was prescribed: its element identified and diagnosed, kept as any other row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..fleet.kept_files import DIAGNOSIS
from ..fleet.manifest import Entry
from ..fleet.outcome import Outcome
from .element import diagnosed_element, fmu_of, identified_element, write_element_diagnosis
from .row import page_or_why, parameters_of, picture_of
from .workflow import seconds_allowed

if TYPE_CHECKING:
    from ..prescribed.element_fit import ElementFit
    from ..recording import Recording


def identified(
    entry: Entry, key: str, read: Callable[[], Sequence[Recording]], said: list[str], *, model: str, report: str
) -> tuple[Outcome, Callable[[Path], None]]:
    """The element of an entry, and what writes its files.

    Args:
        entry: of the manifest.
        key: under which it is kept.
        read: gives its recordings.
        said: what was said while they were read.
        model, report: names of its files.
    """
    from ..files.writing import write
    from ..model.element_file import save_element
    from ..report.element_page import element_page

    fit = identified_element(read, name=entry.name, laws=entry.how["with"], every=False, notes=said.append)
    page, without = page_or_why(entry.how["report"], lambda: element_page(fit, files=(model,)).html)
    force = fit.motions[0].force
    picture, left = picture_of(force - force.mean(), _left_of(fit))
    outcome = Outcome(
        key=key,
        name=entry.name,
        state="good" if fit.left is None else "doubtful",
        sentence=fit.left or "the element leaves no more than noise",
        wanted=entry.how["diagnose"] == "always" or (fit.left is not None and entry.how["diagnose"] == "unfit"),
        parameters=parameters_of(fit.element),
        recordings=tuple(dict(r) for r in fit.element.identified.recordings),
        model=model,
        picture=picture,
        left=left,
        page=None if page is None else report,
        notes=tuple(dict.fromkeys([*(s.removeprefix("note: ") for s in said), *fit.notes, *without])),
    )

    def files(place: Path) -> None:
        save_element(fit.element, place / model)
        if page is not None:
            write(place / report, page)

    return outcome, files


def diagnosed(
    entry: Entry, before: Outcome, training: Sequence[Recording], held: Sequence[Recording]
) -> tuple[Outcome, Callable[[Path], None]]:
    """What a diagnosis makes of an entry, and what writes its files."""
    from ..diagnose.files import MODEL, REPORT

    how = {"progress": lambda _what, _part: None, "seconds": seconds_allowed(None)}
    told = diagnosed_element(training, held, name=entry.name, **how)
    best = told.found.best
    clean = best.left is None
    mended = told.found.after is not None
    outcome = replace(
        before,
        state="mended" if mended and clean else "good" if told.verdict == "consistent" else "doubtful",
        sentence=told.sentence,
        stage="diagnose",
        wanted=False,
        attempts=0,
        verdict=told.verdict,
        effects=told.effects,
        parameters=parameters_of(best.element),
        recordings=tuple(dict(r) for r in best.element.identified.recordings),
        left=() if mended else before.left,
        model=f"{DIAGNOSIS}/{MODEL}",
        page=f"{DIAGNOSIS}/{REPORT}",
        notes=tuple(dict.fromkeys([*before.notes, *best.notes])),
    )

    made = fmu_of(best.element)

    def files(place: Path) -> None:
        write_element_diagnosis(place / DIAGNOSIS, told.found, made)

    return outcome, files


def _left_of(fit: ElementFit) -> np.ndarray:
    """(n,) what is left of the first recording's force, zero where nothing was fitted."""
    motion = fit.motions[0]
    return np.where(motion.told, motion.force - fit.forces[0], 0.0)

"""The report of a diagnosis: what is missing from a model, where it shows, and what to do next, as one HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ..diagnose.wording import effects_in_words
from ..files.spoken import spoken
from ..identify.signals.odds import ABOVE_NOISE
from ..model.display import full_stop, pretty_unit
from ..model.show import warnings as model_warnings
from .before_after import fit_sentence, more_responses_section, response_section
from .blocks import Block, Items, Page, Section, Text
from .effects import considered_section, effects_section, lead_table, shift_section
from .learnt_curve import learnt_section
from .location import location_section
from .mended_curves import curves_section
from .missing_force import force_section, more_forces
from .next_experiment import experiment_section
from .provenance import files_text, recordings_table

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, Effect
    from ..model.fit_state import Left

#: How each verdict is shown: a shape and words that come before the sentence, and the colour.
VERDICTS = {
    "consistent": ("✓ Consistent.", "good"),
    "missing-physics": ("◆ Missing physics.", "note"),
    "unexplained": ("▲ Unexplained.", "bad"),
}
#: Of a model that leaves more than noise, where nothing that was tried tells more.
_BEYOND_NOISE = ("≈ Close, and not to the noise.", "note")


def diagnosis_page(diagnosis: Diagnosis, *, files: Sequence[str] = ()) -> Page:
    """The report.

    Args:
        diagnosis: what ``diagnose`` returns.
        files: names of the files written beside the page.
    """
    said = _says_what_is_left(diagnosis)
    left = [Text(fit_sentence(diagnosis.records, diagnosis.mended), lead="What is left:")] if diagnosis.records else []
    response, others = response_section(diagnosis), more_responses_section(diagnosis)
    sections = [
        replace(response, blocks=(*left, *response.blocks)) if said else response,
        learnt_section(diagnosis),
        location_section(diagnosis),
        force_section(diagnosis),
        *(
            replace(section, folded=True)
            for section in (
                effects_section(diagnosis),
                considered_section(diagnosis),
                shift_section(diagnosis),
                curves_section(diagnosis),
                replace(others, blocks=(*others.blocks, *more_forces(diagnosis))),
                experiment_section(diagnosis),
            )
        ),
        Section("What remains, and what to know", tuple(_remainder(diagnosis))),
        Section("The measuring chain, which is no physics of the rig", tuple(_chain(diagnosis)), folded=True),
        Section("Where the numbers come from", tuple(_provenance(diagnosis, files)), folded=True),
    ]
    mark, tone = mark_of(diagnosis)
    lead: list[Block] = [Text(full_stop(diagnosis.sentence), tone, mark), *lead_table(diagnosis)]
    if not said:
        lead += left
    lead.append(Text(next_step(diagnosis, files), lead="What to do next:"))
    if diagnosis.experiment is not None and _planned(diagnosis):
        lead.append(Text(full_stop(diagnosis.experiment.sentence), lead="The next experiment:"))
    return Page(f"Diagnosis of {diagnosis.before.name}", sections, lead=lead)


def beyond_noise(diagnosis: Diagnosis) -> Left | None:
    """What the model, mended or given, leaves of the recording of which it leaves most times the noise; None at it."""
    left = [record.left_after if diagnosis.mended else record.left_before for record in diagnosis.records]
    most = max(left, key=lambda one: one.times, default=None)
    return None if most is None or most.times <= ABOVE_NOISE else most


def mark_of(diagnosis: Diagnosis) -> tuple[str, str]:
    """The verdict's shape and words, and its colour."""
    close = diagnosis.verdict == "consistent" and beyond_noise(diagnosis) is not None
    return _BEYOND_NOISE if close else VERDICTS.get(diagnosis.verdict, ("", "note"))


def _says_what_is_left(diagnosis: Diagnosis) -> bool:
    """Whether the verdict's own sentence says what is left of what was held out: twice is not needed at the top."""
    return diagnosis.verdict == "missing-physics" and any(record.holdout for record in diagnosis.records)


def next_step(diagnosis: Diagnosis, files: Sequence[str] = ()) -> str:
    """What a person should do with the verdict, in one or two sentences."""
    again = "; to be surer, make the next experiment below" if _planned(diagnosis) else ""
    if diagnosis.verdict == "consistent":
        if beyond_noise(diagnosis) is None:
            return f"use the model as it is, within what the recordings covered{again}."
        return (
            "use the model where what it leaves is small enough for you; its parameters may be off by more than their "
            f"errors{again}."
        )
    if diagnosis.verdict == "missing-physics":
        mended = next((name for name in files if name.endswith(".yaml")), "")
        names = list(dict.fromkeys(effect.law for effect in diagnosis.effects))
        named = f"use the mended model{f' ({mended})' if mended else ''}"
        named += f", and look for {effects_in_words(names)}." if names else "."
        doubt = _doubt(diagnosis.effects)
        how = "make the next experiment" if _planned(diagnosis) else "record what would tell"
        return named + (f" {doubt}: {how} before you rely on the name." if doubt else "")
    where = " where it is said to fail below" if diagnosis.location is not None else ""
    plan = ", make the next experiment" if _planned(diagnosis) else ""
    return f"do not rely on the model{where}; look at the rig there{plan}, and diagnose again."


def _doubt(effects: Sequence[Effect]) -> str:
    """What the recordings cannot tell; by their names alone, which the verdict above has put into words."""
    rivals = [f"{e.effect} from {spoken(e.indistinguishable_from, 'or')}" for e in effects if e.indistinguishable_from]
    return f"These recordings cannot tell {', nor '.join(rivals)}" if rivals else ""


def _planned(diagnosis: Diagnosis) -> bool:
    return diagnosis.experiment is not None and diagnosis.experiment.kind != "none"


def remarks(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Notes of the diagnosis and warnings about the mended model, each once and with its full stop."""
    notes = [*diagnosis.notes, *model_warnings(diagnosis.model)]
    return tuple(dict.fromkeys(full_stop(note) for note in notes if note.strip()))


def _chain(diagnosis: Diagnosis) -> list[Block]:
    if not diagnosis.chain:
        return [Text("Nothing was taken off: the sensors show zero at zero, and the force runs as it was taken.")]
    return [Items(tuple(full_stop(fact.sentence) for fact in diagnosis.chain))]


def _remainder(diagnosis: Diagnosis) -> list[Block]:
    if diagnosis.remainder:
        rest = Text(full_stop(diagnosis.remainder), "bad")
    elif diagnosis.verdict == "unexplained":
        rest = Text("What the model leaves over stays unexplained; it is shown above.", "bad")
    else:
        model = "mended" if diagnosis.mended else "given"
        most = beyond_noise(diagnosis)
        if most is None:
            rest = Text(f"Nothing stays beyond the noise: the {model} model reproduces these recordings.", "good")
        else:
            rest = Text(f"The {model} model leaves {most.of_noise} in {most.file}, which is not seen to follow it.")
    notes = remarks(diagnosis)
    return [rest, *([Text("Take note:"), Items(notes)] if notes else [])]


def _provenance(diagnosis: Diagnosis, files: Sequence[str]) -> list[Block]:
    model = diagnosis.model
    origin = model.identified
    unit = pretty_unit(model.response.unit)
    force = pretty_unit(model.force_unit) if any(r.force is not None for r in diagnosis.records) else "none recorded"
    held = [r.file for r in diagnosis.records if r.holdout]
    blocks: list[Block] = [
        *recordings_table(origin),
        Text(
            "Held out: " + (", ".join(held) if held else "no recording; the noise is judged on the training ones") + "."
        ),
        Text(f"Method: {origin.method or 'not stated'}. Software: {origin.software or 'not stated'}."),
        Text(f"Response: {model.response.quantity} in {unit}; force: {force}."),
    ]
    return [*blocks, *files_text(files)]

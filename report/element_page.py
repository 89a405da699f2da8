"""The pages of an element: loops of the force over displacement and velocity, its numbers, what was found missing."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

import numpy as np

from ..diagnose.wording import effects_in_words
from ..export.render import plain_text
from ..identify.signals.odds import ABOVE_NOISE
from ..model.display import full_stop, number, percent_text, pretty_unit, scale_of, times_text, value_text
from ..model.effect_words import effect_in_words
from ..model.element import Element
from ..model.show import percent
from ..prescribed.element_fit import ElementFit, ElementFound
from ..prescribed.tell import next_test, sentence_of, verdict_of, where_it_fails
from ..prescribed.tell_ways import dependence_in_words, not_told, of_element
from .blocks import Block, Cell, Code, Items, Page, Section, Table, Text, picture
from .chart import Chart
from .diagnosis_page import VERDICTS
from .effects import probability_text
from .provenance import files_text, recordings_table
from .style import EXACT, FREE, MEASURED, MODEL

#: Points of a loop that are drawn at most.
_POINTS = 4000


def element_page(fit: ElementFit, *, files: Sequence[str] = ()) -> Page:
    """The page of an identification; ``files`` are the names of those made beside it."""
    yaml = next((name for name in files if name.endswith(".yaml")), "element.yaml")
    recordings = dict.fromkeys(recording.name.partition("#")[0] for recording in fit.recordings)
    again = f"dashpot diagnose {shlex.join([yaml, *recordings])} --prescribed COLUMN -o diagnosis"
    lead: list[Block] = []
    if fit.left:
        said = full_stop(f"{fit.left[0].upper()}{fit.left[1:]}")
        words = f"{said} The force holds something that the members of Eq. 17 do not."
        lead = [
            Text(words, "warn", "▲ More than noise is left."),
            Code("What is missing (COLUMN is that of the motion; read as here):", again),
        ]
    else:
        lead = [Text("The element gives every force to within its noise.", "good", "✓")]
    sections = [
        loops_section([fit]),
        Section("The element", (equation_text(fit.element), numbered_text(fit.element), members_table(fit.element))),
        records_section(fit, None),
        notes_section(fit.notes),
        Section("Where the numbers come from", (*_provenance(fit), *files_text(files)), folded=True),
    ]
    return Page(f"Identification of {fit.element.name}", sections, lead=lead)


def element_diagnosis_page(found: ElementFound, *, files: Sequence[str] = ()) -> Page:
    """The page of a diagnosis."""
    verdict = verdict_of(found)
    mark, tone = VERDICTS[verdict]
    lead: list[Block] = [Text(sentence_of(found), tone, mark)]
    if found.after is not None:
        lead.append(_named_table(found))
    lead.append(Text(next_test(found), lead="The next test:"))
    fits = [found.before] if found.after is None else [found.before, found.after]
    statement, _ = where_it_fails(found.before)
    best = found.best.element
    notes = [*found.best.notes, *(f"for want of time not tried: {what}" for what in found.found.untried)]
    sections = [
        loops_section(fits),
        Section("Where the members of Eq. 17 fail", (Text(statement),)),
        records_section(found.before, found),
        Section("The mended element", (equation_text(best), numbered_text(best), members_table(best))),
        Section("What else was tried", _tried(found), folded=True),
        notes_section(notes),
        Section("Where the numbers come from", (*_provenance(found.best), *files_text(files)), folded=True),
    ]
    return Page(f"Diagnosis of {best.name}", sections, lead=lead)


def loops_section(fits: Sequence[ElementFit]) -> Section:
    """Force over displacement and over velocity, and over time, measured and modelled; the last fit is the best."""
    shown = "the model" if len(fits) == 1 else "Eq. 17 alone and the mended element"
    blocks = [
        picture(
            lambda i=i: loop_figure(fits, i, f"loops-{i + 1}"),
            f"{plain_text(record.file)}: force over displacement, over velocity, and over time, as recorded and as "
            f"{shown} gives it. Of the first half cycle nothing is fitted.",
        )
        for i, record in enumerate(fits[-1].records)
    ]
    return Section("Loops", tuple(blocks))


def loop_figure(fits: Sequence[ElementFit], i: int, key: str) -> Chart:
    """Chart of one recording's loops."""
    fit, unit, force_unit = fits[-1], fits[-1].element.unit, fits[-1].element.force_unit
    motion = fit.motions[i]
    every = max(1, motion.n // _POINTS)
    loop = slice(None, None, every)
    across, along = scale_of(unit, motion.displacement), scale_of(f"{unit}/s", motion.velocity)
    up = scale_of(force_unit, motion.force)
    chart = Chart(key, f"{plain_text(fit.records[i].file)}: force in {up.unit} over displacement and velocity")
    left, right = chart.row(1, 1, height=300)
    (below,) = chart.row(1, height=220)
    time = motion.start + motion.dt * np.arange(motion.n)
    where = ((left, motion.displacement * across.factor), (right, motion.velocity * along.factor), (below, time))
    names = ["model"] if len(fits) == 1 else ["Eq. 17 alone", "mended element"]
    colors = [MODEL] if len(fits) == 1 else [EXACT, MODEL]
    for panel, x in where:
        at = slice(None) if panel is below else loop  # over time a page keeps what it can be enlarged to
        panel.line(x[at], (motion.force * up.factor)[at], MEASURED, "measured", width=1.1)
        for one, name, color in zip(fits, names, colors, strict=True):
            made = np.where(motion.told, one.forces[i], np.nan)
            panel.line(x[at], (made * up.factor)[at], color, name, width=1.0)
        panel.y.set(label=up.label("Force"))
    left.x.set(label=across.label("Displacement"))
    right.x.set(label=along.label("Velocity"))
    below.x.set(label="Time [s]", tight=True)
    (rest,) = chart.row(1, height=150)
    for one, name, color in zip(fits, names, colors, strict=True):
        missing = np.where(motion.told, motion.force - one.forces[i], np.nan)
        rest.line(time, missing * up.factor, color, f"measured − {name}" if len(fits) > 1 else "", width=0.9)
    rest.rule(motion.noise * up.factor, FREE, "noise, rms")
    rest.x.set(label="Time [s]", tight=True)
    rest.y.set(label=up.label("What is left"))
    return chart


def equation_text(element: Element) -> Text:
    """The force in letters."""
    return Text(element.equation(), "equation")


def numbered_text(element: Element) -> Text:
    """The force with its numbers."""
    values = element.values()

    def shown(name: str) -> str:
        text = number(values[name], 4)
        return f"({text})" if text.startswith("−") else text

    return Text(element.equation(shown), "equation")


def members_table(element: Element) -> Table:
    """Value, standard error, percent, unit and meaning of each parameter that is not left at zero."""
    words, rows = element.descriptions(), []
    for name, p in element.parameters().items():
        if p.std is None and not p.value:
            continue
        value, error = value_text(p)
        rows.append((name, value, error, percent_text(percent(p)), pretty_unit(p.unit), words[name]))
    head = ("Parameter", "Value", "± std error", "relative", "Unit", "Meaning")
    return Table(head, tuple(rows), (1, 2, 3), "As the machine has it. Members that are not listed are zero.")


def records_section(before: ElementFit, found: ElementFound | None) -> Section:
    """What is left of each recording's force."""
    after = before if found is None else found.best
    rows: list[tuple[str | Cell, ...]] = []
    for one, other in zip(before.records, after.records, strict=True):
        rows.append(_row(one.file, one.nrmse, other.nrmse, other.noise_floor, found is not None))
    if found is not None:
        for one, other in zip(found.held_before, found.held_after, strict=True):
            name = f"{one.file}, {'its last third, ' if found.in_pieces else ''}held out"
            rows.append(_row(name, one.nrmse, other.nrmse, other.noise_floor, True))
    columns = ("Left", "Noise", "Times the noise") if found is None else ("Before", "After", "Noise", "Times the noise")
    head = ("Recording", *columns)
    caption = "Root mean square of what is left over the force's standard deviation, of the samples that are fitted."
    return Section("What is left", (Table(head, tuple(rows), tuple(range(1, len(head))), caption),))


def _row(name: str, before: float, after: float, noise: float, mended: bool) -> tuple[str | Cell, ...]:
    times = Cell(times_text(after / noise), "good" if after / noise <= ABOVE_NOISE else "")
    shown = [f"{number(100 * value, 3)} %" for value in ((before, after) if mended else (after,))]
    return (plain_text(name), *shown, f"{number(100 * noise, 2)} %", times)


def notes_section(notes: Sequence[str]) -> Section:
    """What is to be known."""
    sentences = tuple(dict.fromkeys(full_stop(f"{note[0].upper()}{note[1:]}") for note in notes))
    return Section("What to know", (Items(sentences),) if sentences else ())


def _named_table(found: ElementFound) -> Table:
    rows: list[tuple[str | Cell, ...]] = []
    for named in found.found.named:
        term = next(t for t in found.best.element.terms if t.law.name == named.law.name)
        sizes = []
        for name, p in term.parameters.items():
            value, error = value_text(p)
            unit = pretty_unit(p.unit)
            sizes.append(f"{name} {value}{f' ± {error}' if error else ''}{'' if unit == '1' else f' {unit}'}")
        rivals = effects_in_words(named.rivals, "or") if named.rivals else "nothing: no other law does as well"
        rows.append((effect_in_words(named.law.name), ", ".join(sizes), probability_text(named.odds), rivals))
    element = found.best.element
    for way in found.found.dependent:
        one = of_element(way.way, element)
        size = f"{way.way.how}"
        if one.parameter is not None:
            value, error = value_text(one.parameter)
            unit = pretty_unit(one.parameter.unit)
            size = f"{one.form.parameter} {value}{f' ± {error}' if error else ''}{'' if unit == '1' else f' {unit}'}"
        words = dependence_in_words(way, element)
        rivals = not_told(way) or "nothing: no other form or law does as well"
        rows.append((f"{words[0].upper()}{words[1:]}", size, probability_text(way.odds), rivals))
    return Table(("What is missing", "Its size", "Probability", "Not distinguished from"), tuple(rows), cards=True)


def _tried(found: ElementFound) -> tuple[Table, ...]:
    rows = tuple((" + ".join(other.names) or "the members alone", full_stop(why)) for other, why in found.found.tried)
    return (Table(("Laws", "Why not"), rows, cards=True),) if rows else ()


def _provenance(fit: ElementFit) -> list[Block]:
    return [*recordings_table(fit.element.identified), Text(f"Method: {fit.element.identified.method}.")]

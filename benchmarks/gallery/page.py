"""The gallery as one page of HTML: what came out of all recordings, then each with a picture and its figures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dashpot.report.blocks import Block, Cell, Items, Page, Section, Table, Text, picture

from .compare import broken, percent
from .entry import Entry
from .outcome import Effect, Outcome
from .pictures import draw

_HEAD = (
    "Recording",
    "Verdict",
    "Named (odds)",
    "Plain linear fit",
    "Identified",
    "Mended",
    "Plain, held out",
    "Mended, held out",
    "Published",
    "Seconds",
)


def gallery_page(outcomes: Mapping[str, Outcome], entries: Mapping[str, Entry], folder: Path) -> str:
    """The page; `folder` holds a folder for each entry, with what the commands wrote."""
    rows = tuple(_row(entries[name], outcome) for name, outcome in outcomes.items())
    right = sum(bool(outcome.right) for outcome in outcomes.values())
    sentences = [sentence for name, outcome in outcomes.items() for sentence in broken(entries[name], outcome)]
    lead: list[Block] = [
        Text(
            f"{len(outcomes)} recordings that other people made, through the commands as a user would type them; "
            f"of {right} the verdict says what is documented. Errors are free runs, "
            "rms(simulated - measured) / std(measured), in per cent. "
            "The plain linear fit shares nothing with this software."
        ),
        Table(_HEAD, rows, numeric=(3, 4, 5, 6, 7, 9)),
    ]
    if sentences:
        lead += [Text("Bounds that are broken:", "bad"), Items(tuple(sentences))]
    sections = [_section(entries[name], outcome, folder / name) for name, outcome in outcomes.items()]
    return Page("Recordings of other people", sections, lead=lead).html


def _row(entry: Entry, outcome: Outcome) -> tuple[str | Cell, ...]:
    plain = {role: _worst(outcome, role, "plain") for role in ("training", "holdout")}
    before = _worst(outcome, "training", "before")
    after = _worst(outcome, "training", "after")
    published = "; ".join(f"{figure.value:g} {figure.unit}" for figure in entry.published) or "-"
    return (
        entry.name,
        Cell(outcome.verdict, "good" if outcome.right else "bad"),
        " + ".join(_named(effect) for effect in outcome.effects) or "-",
        percent(plain["training"]),
        Cell(percent(before), _against(before, plain["training"])),
        Cell(percent(after), _against(after, plain["training"])),
        percent(plain["holdout"]),
        Cell(percent(outcome.error("holdout")), _against(outcome.error("holdout"), plain["holdout"])),
        published,
        f"{outcome.seconds:.0f}",
    )


def _named(effect: Effect) -> str:
    odds = f" ({effect.odds:.3g})" if effect.odds is not None else ""
    return effect.effect + odds


def _against(error: float | None, plain: float | None) -> str:
    """Good where it beats the plain fit, bad where the plain fit beats it."""
    return "" if error is None or plain is None else "good" if error < plain else "bad"


def _worst(outcome: Outcome, role: str, what: str) -> float | None:
    values = [getattr(errors, what) for errors in outcome.errors if errors.role == role]
    known = [value for value in values if value is not None]
    return max(known) if known else None


def _section(entry: Entry, outcome: Outcome, work: Path) -> Section:
    blocks: list[Block] = [
        Text(f"{entry.physics}.", lead="Documented:"),
        Text(outcome.sentence or outcome.verdict, "good" if outcome.right else "bad"),
    ]
    if entry.note:
        blocks.append(Text(entry.note, lead="The file:"))
    for piece in (entry.training[0], *entry.holdout[:1], *entry.tests[:1]):
        if (work / piece.file).is_file():
            drawn = picture(
                lambda piece=piece: draw(entry, piece, work),
                f"{piece.file}: the whole, and its largest motion. Measured, free runs, and what they leave.",
            )
            blocks.append(drawn)
    if outcome.effects:
        blocks.append(_effects(outcome))
    if outcome.remainder:
        blocks.append(Text(outcome.remainder, lead="Left over:"))
    blocks += [_errors(outcome), *_judged(outcome)]
    if outcome.parameters:
        rows = tuple(
            (name, _value(value), _value(std), unit) for name, (value, std, unit) in outcome.parameters.items()
        )
        blocks.append(Table(("Parameter", "Identified", "±", "Unit"), rows, (1, 2)))
    if entry.published:
        published = tuple((figure.what, f"{figure.value:g} {figure.unit}", figure.source) for figure in entry.published)
        blocks.append(Table(("Elsewhere", "Reached", "By"), published))
    steps = tuple(
        (command, Cell(end, "" if end == "done" else "bad"), _value(code), f"{seconds:.1f}", said)
        for command, end, code, seconds, said in outcome.steps
    )
    blocks.append(Table(("Command", "Ended", "Exit code", "Seconds", "Last line of stderr"), steps, (2, 3)))
    if outcome.notes:
        blocks.append(Items(outcome.notes))
    return Section(f"{entry.name}: {entry.title}", tuple(blocks))


def _effects(outcome: Outcome) -> Table:
    rows = tuple(
        (
            effect.effect,
            "not given" if effect.odds is None else f"{effect.odds:.3g}",
            ", ".join(effect.group) or "-",
            Cell(effect.counts, "bad" if effect.counts == "not documented" else "good"),
        )
        for effect in outcome.effects
    )
    return Table(("Named", "Odds", "Not to be told from", "Documented"), rows)


def _errors(outcome: Outcome) -> Table:
    rows = tuple(
        (
            errors.file,
            errors.role,
            *(percent(value) for value in (errors.plain, errors.before, errors.after)),
            "-" if errors.rms_after is None else f"{1e3 * errors.rms_after:.4g}e-3",
        )
        for errors in outcome.errors
    )
    head = ("Free run, % of the motion", "", "Plain linear fit", "Identified", "Mended", "rms, unit of the response")
    return Table(head, rows, (2, 3, 4, 5))


def _judged(outcome: Outcome) -> list[Block]:
    if not outcome.judged:
        return []
    rows = tuple((file, role, *(percent(value) for value in values)) for file, role, *values in outcome.judged)
    return [Table(("The diagnosis' own table, %", "", "Before", "After", "Noise"), rows, (2, 3, 4))]


def _value(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"

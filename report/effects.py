"""What is missing, by name: the laws with their numbers, what else was tried, how the old parameters had been bent."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from ..diagnose.result import SURE
from ..diagnose.wording import effects_in_words
from ..errors import BadInput
from ..model.as_recorded import parameter_as_recorded
from ..model.display import full_stop, number, percent_text, pretty_unit, quantity_text, scale_of, typeset, value_text
from ..model.effect_words import effect_in_words
from ..model.library import find
from ..model.machine_units import words_of_product
from ..model.parameter import Parameter
from ..model.show import percent
from .blocks import Block, Cell, Section, Table, Text
from .location import PATHS
from .parameters import equation_blocks

if TYPE_CHECKING:
    from ..diagnose.result import Considered, Diagnosis, Effect
    from ..model.law import Law

#: A parameter counts as bent from here on, in standard errors.
BENT = 3.0
#: Laws that were not run, so many for one and the same reason, stand together in one sentence.
_ALIKE = 4
#: A percentage beyond this says only that the parameter is near zero.
_FAR = 999.0


def effects_section(diagnosis: Diagnosis) -> Section:
    """Each effect as a card with its parameters, and the mended equation of motion."""
    if not diagnosis.effects and not diagnosis.mended:
        why = {
            "consistent": "Nothing: the recordings support no effect beyond the given model.",
            "unexplained": "None of the library brings the held-out recordings down to their noise, so none is named.",
        }
        return Section("What is missing", (Text(why.get(diagnosis.verdict, "No effect is named.")),))
    blocks: list[Block] = []
    for effect in diagnosis.effects:
        blocks += effect_blocks(effect, diagnosis.of_machine(effect))
    if not diagnosis.effects:
        blocks.append(Text("No effect is named: the strength of each law that was put in is zero within its error."))
    blocks.append(Text("The mended equation of motion, in letters and with its numbers:"))
    return Section("What is missing", (*blocks, *equation_blocks(diagnosis.model)))


def lead_table(diagnosis: Diagnosis) -> list[Table]:
    """What is missing at one glance: the effect, its strength in the machine's units, its share, how probable it is."""
    rows: list[tuple[str | Cell, ...]] = []
    for effect in diagnosis.effects:
        sizes = [f"{name} {size_text(diagnosis, effect, name)}" for name in effect.parameters]
        if is_curve(effect):
            sizes = [
                next((form.text for form in diagnosis.forms if form.effect == effect.effect), "a curve, drawn below")
            ]
        rivals = effect.indistinguishable_from
        rival_words = effects_in_words(rivals, "or") if rivals else "nothing: no other law does as well"
        share = "" if effect.share is None else f"{number(100 * effect.share)} % of what is left without it"
        rows.append((effect_in_words(effect.law), ", ".join(sizes), share, probability_text(effect.odds), rival_words))
    head = ("What is missing", "Its size", "It takes", "Probability", "Not distinguished from")
    return [Table(head, tuple(rows), cards=True)] if rows else []


def is_curve(effect: Effect) -> bool:
    """Whether an effect is a learnt curve, whose heights at its knots tell a person nothing."""
    return effect.law.startswith(f"{effect.effect}/") and effect.effect.startswith("free/")


def size_text(diagnosis: Diagnosis, effect: Effect, name: str) -> str:
    """A parameter of an effect as the machine has it, lengths in the unit as recorded or with a fitting prefix."""
    given = effect.parameters[name]
    own, length = parameter_as_recorded(diagnosis.model, given), diagnosis.model.response.displacement_unit
    if own.unit == given.unit == length != "rad":
        scale = scale_of(length, given.value)
        std = None if given.std is None else given.std * scale.factor
        own = Parameter(given.value * scale.factor, std, scale.unit)
    return quantity_text(diagnosis.of_machine(effect).get(name, own))


def probability_text(odds: float) -> str:
    """Odds as a probability in percent, with as many nines as it has."""
    if not odds > 0:
        return "not known" if math.isnan(odds) else "0 %"
    if odds >= SURE:
        return f"more than {100 * SURE / (1 + SURE):.4f} %"
    missing = 100 / (1 + odds)
    digits = max(0, -math.floor(math.log10(missing))) if missing < 10 else 0
    return f"{100 - missing:.{digits}f} %"


def effect_blocks(effect: Effect, of_machine: Mapping[str, Parameter] = MappingProxyType({})) -> list[Block]:
    """What the effect is, in words, and its parameters, as ``of_machine`` has them too."""
    law = _law(effect.law)
    rows: list[tuple[str | Cell, ...]] = []
    if law is None:
        rows.append(("What it is", f"A law of your own, {effect.law}."))
    else:
        rows.append(("What it is", law.sentence))
    rows.append(("Where in the rig", f"{PATHS.get(effect.path, effect.path).capitalize()} (path: {effect.path})"))
    if law is not None:
        what = "Term per unit mass" if law.force else "What it changes"
        rows.append((what, law.in_words(lambda name: name)))
        rows.append(("Backbone, damping curve", law.curves or "Not stated."))
        rows.append(("Literature", full_stop(law.source)))
    if effect.indistinguishable_from:
        rows.append(("Not distinguished from", effects_in_words(effect.indistinguishable_from, "or")))
        rows.append(("What would tell", full_stop(effect.separated_by) if effect.separated_by else "Not known."))
    else:
        rows.append(("Not distinguished from", "No other law of the library does as well on these recordings."))
        if effect.separated_by:
            rows.append(("To be surer still", full_stop(effect.separated_by)))
    rows.append(("Odds", _odds(effect)))
    words = {p.name: p.description for p in law.parameters} if law else {}
    numbers = []
    for name, own in effect.parameters.items():
        meaning = words.get(name, "")
        both = [(of_machine[name], words_of_product(meaning))] if name in of_machine else []
        for p, text in (*both, (own, meaning)):
            value, error = value_text(p)
            numbers.append((name, value, error, percent_text(percent(p)), pretty_unit(p.unit), text))
    head = ("Parameter", "Value", "± std error", "relative", "Unit", "Meaning")
    return [Table((_title(effect_in_words(effect.law)), ""), tuple(rows)), Table(head, tuple(numbers), (1, 2, 3))]


def _odds(effect: Effect) -> str:
    """Against all that was tried in its place, in words."""
    what = "That it is one of these" if effect.indistinguishable_from else "That it is this"
    size = f"more than {SURE:,.0f}" if effect.odds >= SURE else number(effect.odds)
    takes = "" if effect.share is None else f" It takes {number(100 * effect.share)} % of what is left without it."
    return f"{what}: {size} to 1 against all that was tried instead.{takes}"


def _title(words: str) -> str:
    """As it stands above a card; a name alone keeps its small letters."""
    return words[:1].upper() + words[1:] if " " in words else words


def _law(name: str) -> Law | None:
    """The law of that name; None for one that this library does not have (a user's own)."""
    try:
        return find(name)
    except BadInput:
        return None


def considered_section(diagnosis: Diagnosis) -> Section:
    """What was tried and not taken, the closest first."""
    title = "What was considered, and why not"
    if not diagnosis.considered:
        return Section(title, (Text("No other law was tried."),))
    ranked = by_rank(diagnosis)
    same = Counter(tried.why_not for tried in ranked if _unknown(tried.holdout_nrmse))
    alike = [why for why, count in same.items() if count >= _ALIKE]
    rows = tuple(
        (effect_in_words(tried.effect), _known(tried.holdout_nrmse), _bic(tried.delta_bic), tried.why_not)
        for tried in ranked
        if not (tried.why_not in alike and _unknown(tried.holdout_nrmse))
    )
    held = [r for r in diagnosis.records if r.holdout]
    which = "model that was taken" if diagnosis.effects else "given model"
    took = f" The {which} leaves {number(max(r.nrmse_after for r in held))} at most." if held else ""
    caption = (
        "Sorted by what each leaves of the held-out recordings (NRMSE). ΔBIC: Bayesian information criterion less that "
        f"of the model without the effect; the more negative, the more the training recordings ask for it.{took}"
    )
    blocks: list[Block] = []
    if rows:
        blocks.append(Table(("Effect", "Held-out NRMSE", "ΔBIC", "Why not"), rows, (1, 2), caption))
    for why in alike:
        names = ", ".join(tried.effect for tried in ranked if tried.why_not == why and _unknown(tried.holdout_nrmse))
        blocks.append(Text(f"{names}.", lead=f"Not run, as {why}:"))
    return Section(title, tuple(blocks))


def by_rank(diagnosis: Diagnosis) -> list[Considered]:
    """The laws that were tried, the least held-out NRMSE first, then the least BIC; those without numbers last."""

    def rank(tried: Considered) -> tuple[float, float]:
        error = tried.holdout_nrmse
        known = error is not None and math.isfinite(error)
        bic = tried.delta_bic if tried.delta_bic is not None and math.isfinite(tried.delta_bic) else math.inf
        return (error if known and error is not None else math.inf, bic)

    return sorted(diagnosis.considered, key=rank)


def _unknown(value: float | None) -> bool:
    return value is None or not math.isfinite(value)


def _known(value: float | None) -> str | Cell:
    return Cell("not run", "quiet") if value is None or not math.isfinite(value) else number(value)


def _bic(value: float | None) -> str:
    if value is None:
        return "–"
    if not math.isfinite(value):
        return number(value)
    return typeset(f"{value:+.1f}" if abs(value) < 100 else f"{value:+.0f}")


@dataclass(frozen=True)
class Shift:
    """One parameter of the given family before and after mending.

    Attributes:
        name: of the parameter.
        before, after: with standard errors.
        errors: (after - before) in standard errors of ``after``; None where that has none.
        percent: (after - before) in percent of ``before``; None where that is zero.
    """

    name: str
    before: Parameter
    after: Parameter
    errors: float | None
    percent: float | None

    @property
    def bent(self) -> bool:
        """Whether the shift is beyond what the standard error allows."""
        return self.errors is not None and abs(self.errors) > BENT

    @property
    def errors_text(self) -> str:
        """The shift in standard errors with its sign; empty where it is not known."""
        if self.errors is None:
            return ""
        return typeset(f"{self.errors:+.1f}" if abs(self.errors) < 99.95 else f"{self.errors:+.0f}")

    @property
    def percent_text(self) -> str:
        """The shift in percent with its sign; empty where it is not known or says nothing."""
        if self.percent is None or abs(self.percent) > _FAR:
            return ""
        return typeset(f"{self.percent:+.2g}" if abs(self.percent) < 99.5 else f"{self.percent:+.0f}") + " %"


def shifts(diagnosis: Diagnosis) -> tuple[Shift, ...]:
    """How far each parameter had been bent, in the model's order."""
    after = diagnosis.model.parameters()
    moved = []
    for name, old in diagnosis.before.parameters().items():
        if name not in after:
            continue
        new = after[name]
        apart = new.value - old.value
        sure = new.std is not None and math.isfinite(new.std) and new.std > 0 and math.isfinite(apart)
        errors = apart / new.std if sure and new.std else None
        percent = 100 * apart / abs(old.value) if math.isfinite(apart) and old.value else None
        moved.append(Shift(name, old, new, errors, percent))
    return tuple(moved)


def shift_section(diagnosis: Diagnosis) -> Section:
    """The given model's parameters before and after mending."""
    title = "How the missing physics had bent the old parameters"
    if not diagnosis.effects:
        return Section(title, (Text("Nothing was mended, so no parameter has moved."),))
    moved = shifts(diagnosis)
    words = diagnosis.before.descriptions()
    rows: list[tuple[str | Cell, ...]] = []
    for shift in moved:
        value, error = value_text(shift.after)
        rows.append(
            (
                shift.name,
                number(shift.before.value, _digits(value)),
                value,
                error or Cell("–", "quiet"),
                errors_cell(shift),
                shift.percent_text,
                pretty_unit(shift.after.unit),
                words.get(shift.name, ""),
            )
        )
    head = ("Parameter", "Before", "After", "± std error", "Shift / std error", "Shift", "Unit", "Meaning")
    caption = (
        "Before: the given model fitted anew to the same recordings, and not the values of its file. Shift: after less "
        f"before, over the new standard error; beyond {BENT:g} of these a parameter had been standing in for what was "
        "missing."
    )
    return Section(title, (Text(_bent_sentence(moved)), Table(head, tuple(rows), (1, 2, 3, 4, 5), caption)))


def errors_cell(shift: Shift) -> Cell:
    """The shift in standard errors, coloured where it is beyond what they allow."""
    if shift.errors is None:
        return Cell("–", "quiet")
    return Cell(shift.errors_text, "bad" if shift.bent else "")


def _digits(text: str) -> int:
    """Significant digits of a printed number, at least three."""
    return max(sum(c.isdigit() for c in text.partition("·")[0].lstrip("−0.")), 3)


def _bent_sentence(moved: Sequence[Shift]) -> str:
    bent = sorted((shift for shift in moved if shift.bent), key=lambda shift: -abs(shift.errors or 0.0))
    if not bent:
        return f"No parameter had been bent by more than {BENT:g} standard errors."
    first = bent[0]
    more = f", {', '.join(shift.name for shift in bent[1:])} as well" if len(bent) > 1 else ""
    return f"{first.name} had been bent most, by {first.errors_text[1:]} standard errors{more}."

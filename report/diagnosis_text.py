"""A diagnosis in words: what ``dashpot diagnose`` prints."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING

from ..diagnose.wording import effects_in_words
from ..export.render import plain_text
from ..model.display import full_stop, number, quantity_text, times_text
from ..model.effect_words import effect_in_words
from ..model.formula.nearest_words import in_words
from .before_after import fit_sentence, ratio_to_floor
from .diagnosis_page import mark_of, next_step, remarks
from .effects import BENT, is_curve, shifts, size_text
from .location import PATHS

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, Effect, RecordFit
    from ..model import Parameter

_WIDTH = 100
#: Longest lists; the page has all.
_RECORDS, _EFFECTS, _PARAMETERS, _BENT, _NOTES = 6, 2, 5, 5, 3
_NAME = 30


def describe(diagnosis: Diagnosis) -> str:
    """The diagnosis as text of some forty lines of at most a hundred columns; the page says it at length."""
    mark, _ = mark_of(diagnosis)
    lines = _wrapped(f"{mark} {full_stop(diagnosis.sentence)}", "", 6)
    lines += _wrapped(f"To do: {next_step(diagnosis)}", "", 4)
    if diagnosis.effects:
        lines += ["", "What is missing"]
        for effect in diagnosis.effects[:_EFFECTS]:
            lines += _effect(effect, diagnosis)
        if len(diagnosis.effects) > _EFFECTS:
            lines += _wrapped("and " + effects_in_words([e.law for e in diagnosis.effects[_EFFECTS:]]), "  ", 2)
    for form in [form for form in diagnosis.forms if form.information == 0.0]:
        numbers = ", ".join(f"{name} = {_value(p)}" for name, p in form.constants.items())
        lines += ["", f"The shape of {form.effect}, within its band", f"  {form.text}", *_wrapped(numbers, "  ", 2)]
    for law in diagnosis.nearest:
        lines += ["", f"The nearest law to {law.effect}", *_wrapped(f"{in_words(law, diagnosis.model)}.", "  ", 2)]
    if diagnosis.location is not None and diagnosis.location.statement.strip():
        lines += ["", "Where", *_wrapped(full_stop(diagnosis.location.statement), "  ", 3)]
    if diagnosis.location is not None and diagnosis.location.depends_on is not None:
        said = f"{diagnosis.location.depends_on.sentence}."
        lines += ["", "On what the missing force depends, of its power", *_wrapped(said, "  ", 4)]
    if diagnosis.records:
        lines += ["", *_recordings(diagnosis)]
    bent = _bent(diagnosis)
    if bent:
        head = f"Parameters, fitted anew without what is missing, bent by more than {BENT:g} of their new errors"
        lines += ["", head, *bent]
    if diagnosis.experiment is not None and diagnosis.experiment.sentence.strip():
        lines += ["", "Next experiment", *_wrapped(full_stop(diagnosis.experiment.sentence), "  ", 4)]
    if diagnosis.chain:
        lines += ["", "The measuring chain, which is no physics of the rig"]
        for fact in diagnosis.chain[:_NOTES]:
            lines += _wrapped(f"- {full_stop(fact.sentence)}", "  ", 4)
        if len(diagnosis.chain) > _NOTES:
            lines.append(f"  - and {len(diagnosis.chain) - _NOTES} more on the page")
    last = _last(diagnosis)
    return "\n".join([*lines, *(["", "Take note", *last] if last else [])]) + "\n"


def _wrapped(text: str, indent: str, most: int) -> list[str]:
    """``text`` in at most so many lines, without characters that would steer a terminal."""
    return textwrap.wrap(
        plain_text(text),
        _WIDTH,
        initial_indent=indent,
        subsequent_indent=indent + ("  " if indent else ""),
        max_lines=most,
        placeholder=" …",
        break_on_hyphens=False,
    )


def _effect(effect: Effect, diagnosis: Diagnosis) -> list[str]:
    plan, strengths = diagnosis.experiment, diagnosis.of_machine(effect)
    lines = _wrapped(effect_in_words(effect.law), "  ", 2)
    lines += _wrapped(f"{PATHS.get(effect.path, effect.path)} (path: {effect.path})", "    ", 1)
    names = [] if is_curve(effect) else list(effect.parameters)[:_PARAMETERS]
    width = max((len(name) for name in names), default=0)
    for name in names:
        besides = f", or {_value(effect.parameters[name])} per unit mass" if name in strengths else ""
        lines.append(f"    {name:<{width}}  {plain_text(size_text(diagnosis, effect, name))}{besides}")
    if effect.indistinguishable_from:
        by = effect.separated_by
        if plan is not None and plan.sentence.strip():  # stands below
            by = by.replace(plan.sentence, "the next experiment, below.", 1)
        what = f"Not distinguished from {effects_in_words(effect.indistinguishable_from, 'or')}."
        lines += _wrapped(what + (f" What would tell: {full_stop(by)}" if by else ""), "    ", 3)
    return lines


def _value(parameter: Parameter) -> str:
    return plain_text(quantity_text(parameter))


def _recordings(diagnosis: Diagnosis) -> list[str]:
    """A line for each recording: the held-out ones first, then those that are farthest from their noise."""
    records = sorted(diagnosis.records, key=lambda r: (not r.holdout, -_rank(r)))
    shown = records[:_RECORDS]
    names = [plain_text(r.file) for r in shown]
    names = [name if len(name) <= _NAME else f"{name[: _NAME - 1]}…" for name in names]
    width = max(len("Recording"), *(len(name) for name in names)) + 2
    head = ("before", "after", "noise floor", "after / floor")
    lines = ["".join([f"{'Recording (NRMSE)':<{max(width, 19)}}", *(f"{word:>14}" for word in head)])]
    for name, r in zip(names, shown, strict=True):
        ratio = ratio_to_floor(r)
        cells = [number(r.nrmse_before), number(r.nrmse_after), number(r.noise_floor)]
        cells.append(times_text(ratio) if math.isfinite(ratio) else "unknown")
        held = "  held out" if r.holdout else ""
        lines.append(f"  {name:<{max(width, 19) - 2}}" + "".join(f"{cell:>14}" for cell in cells) + held)
    if len(records) > len(shown):
        lines.append(f"  and {len(records) - len(shown)} more")
    return [*lines, *_wrapped(fit_sentence(records, bool(diagnosis.effects)), "  ", 2)]


def _rank(record: RecordFit) -> float:
    ratio = ratio_to_floor(record)
    return ratio if math.isfinite(ratio) else math.inf


def _bent(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.effects:
        return []
    bent = sorted((s for s in shifts(diagnosis) if s.bent), key=lambda s: -abs(s.errors or 0.0))
    width = max((len(shift.name) for shift in bent), default=0)
    lines = []
    for shift in bent[:_BENT]:
        share = f", {shift.percent_text}" if shift.percent_text else ""
        lines.append(
            f"  {shift.name:<{width}}  {number(shift.before.value, 4)} → {_value(shift.after)}  "
            f"(by {shift.errors_text} new errors{share})"
        )
    return [*lines, *([f"  and {len(bent) - _BENT} more"] if len(bent) > _BENT else [])]


def _last(diagnosis: Diagnosis) -> list[str]:
    notes = list(remarks(diagnosis))
    lines = _wrapped(f"- Remains: {full_stop(diagnosis.remainder)}", "  ", 3) if diagnosis.remainder else []
    for note in notes[:_NOTES]:
        lines += _wrapped(f"- {note}", "  ", 2)
    return [*lines, *([f"  - and {len(notes) - _NOTES} more on the page"] if len(notes) > _NOTES else [])]

"""A diagnosis in words: what ``dashpot diagnose`` prints."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING

from ..export.render import plain_text
from ..model.display import full_stop, number, times_text, value_text
from .before_after import fit_sentence, ratio_to_floor
from .diagnosis_page import VERDICTS, next_step, remarks
from .effects import BENT, shifts

if TYPE_CHECKING:
    from ..diagnose.result import Diagnosis, Effect, RecordFit
    from ..model import Parameter

_WIDTH = 100
#: Longest lists; the page has all.
_RECORDS, _EFFECTS, _PARAMETERS, _BENT, _NOTES = 6, 2, 5, 5, 3
_NAME = 30


def describe(diagnosis: Diagnosis) -> str:
    """The diagnosis as text of some forty lines of at most a hundred columns; the page says it at length."""
    mark, _ = VERDICTS.get(diagnosis.verdict, ("", ""))
    lines = _wrapped(f"{mark} {full_stop(diagnosis.sentence)}", "", 4)
    lines += _wrapped(f"To do: {next_step(diagnosis)}", "", 3)
    if diagnosis.effects:
        lines += ["", "What is missing"]
        for effect in diagnosis.effects[:_EFFECTS]:
            lines += _effect(effect)
        if len(diagnosis.effects) > _EFFECTS:
            lines += _wrapped("and " + ", ".join(e.law for e in diagnosis.effects[_EFFECTS:]), "  ", 2)
    if diagnosis.location is not None and diagnosis.location.statement.strip():
        lines += ["", "Where", *_wrapped(full_stop(diagnosis.location.statement), "  ", 3)]
    if diagnosis.records:
        lines += ["", *_recordings(diagnosis)]
    bent = _bent(diagnosis)
    if bent:
        lines += ["", f"Old parameters bent by more than {BENT:g} standard errors", *bent]
    if diagnosis.experiment is not None and diagnosis.experiment.sentence.strip():
        lines += ["", "Next experiment", *_wrapped(full_stop(diagnosis.experiment.sentence), "  ", 3)]
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


def _effect(effect: Effect) -> list[str]:
    lines = [f"  {plain_text(effect.law)} ({plain_text(effect.path)})"]
    names = list(effect.parameters)[:_PARAMETERS]
    width = max((len(name) for name in names), default=0)
    lines += [f"    {name:<{width}}  {_value(effect.parameters[name])}" for name in names]
    if effect.indistinguishable_from:
        by = f"; it would take {effect.separated_by}" if effect.separated_by else ""
        lines += _wrapped(full_stop(f"Not told from {', '.join(effect.indistinguishable_from)}{by}"), "    ", 2)
    return lines


def _value(parameter: Parameter) -> str:
    value, error = value_text(parameter)
    unit = "" if parameter.unit == "1" else f" {plain_text(parameter.unit)}"
    return f"{value}{f' ± {error}' if error else ''}{unit}"


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
    found = sorted((one for one in shifts(diagnosis) if one.bent), key=lambda one: -abs(one.errors or 0.0))
    width = max((len(one.name) for one in found), default=0)
    lines = []
    for one in found[:_BENT]:
        share = f", {one.percent_text}" if one.percent_text else ""
        lines.append(
            f"  {one.name:<{width}}  {number(one.before.value, 4)} → {_value(one.after)}  "
            f"(by {one.errors_text} standard errors{share})"
        )
    return [*lines, *([f"  and {len(found) - _BENT} more"] if len(found) > _BENT else [])]


def _last(diagnosis: Diagnosis) -> list[str]:
    notes = list(remarks(diagnosis))
    lines = _wrapped(f"- Remains: {full_stop(diagnosis.remainder)}", "  ", 3) if diagnosis.remainder else []
    for note in notes[:_NOTES]:
        lines += _wrapped(f"- {note}", "  ", 2)
    return [*lines, *([f"  - and {len(notes) - _NOTES} more on the page"] if len(notes) > _NOTES else [])]

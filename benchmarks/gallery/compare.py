"""Two runs of the gallery beside each other, and a run against the bounds of its entries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .entry import Entry
from .outcome import Outcome

#: A verdict is worse where its rank falls: an answer, none, a refusal in words, none in time, a breakdown.
_RANK = {"missing-physics": 4, "consistent": 4, "unexplained": 3, "refused": 2, "timeout": 1, "fault": 0, "": 0}
#: Errors are told apart when they differ by this part: a run repeats itself better, but not on another machine.
_SAME = 0.02
#: ... and by this much of the motion, in per cent: less is nobody's concern.
_NEGLIGIBLE = 0.01


@dataclass(frozen=True)
class Change:
    """One entry in two runs: a row of the table, and what got worse, in words."""

    name: str
    row: tuple[str, ...]
    worse: tuple[str, ...]


HEAD = ("recording", "verdict", "named", "training %", "held out %", "seconds")


def compare(old: Mapping[str, Outcome], new: Mapping[str, Outcome]) -> list[Change]:
    """The entries of a new run, each beside the old one's; those that were not run before are told to be new."""
    return [_change(old.get(name), outcome) for name, outcome in new.items()]


def _change(old: Outcome | None, new: Outcome) -> Change:
    cells = [_cells(outcome) for outcome in ((new,) if old is None else (old, new))]
    row = tuple(values[0] if len(set(values)) == 1 else " -> ".join(values) for values in zip(*cells, strict=True))
    if old is None:
        return Change(new.name, (f"{new.name} (new)", *row), ())
    worse = []
    if _RANK[new.verdict] < _RANK[old.verdict]:
        worse.append(f"{old.verdict} became {new.verdict}")
    if old.right and not new.right:
        worse.append("what is documented is no longer said")
    for role, words in (("training", "in training"), ("holdout", "held out")):
        before, after = old.error(role), new.error(role)
        if before is not None and (after is None or after > max((1 + _SAME) * before, before + _NEGLIGIBLE)):
            worse.append(f"error {words} {percent(before)} -> {percent(after)} %")
    return Change(new.name, (new.name, *row), tuple(worse))


def _cells(outcome: Outcome) -> tuple[str, ...]:
    named = " + ".join(effect.effect for effect in outcome.effects) or "-"
    errors = (percent(outcome.error(role)) for role in ("training", "holdout"))
    return (outcome.verdict + (" (right)" if outcome.right else ""), named, *errors, f"{outcome.seconds:.0f}")


def percent(value: float | None) -> str:
    """Three digits, and a dash where nothing simulates."""
    return "-" if value is None else f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def text(changes: Sequence[Change]) -> str:
    """The comparison for a terminal: a table, then what got worse."""
    rows = [HEAD, *(change.row for change in changes)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    worse = [f"{change.name}: {'; '.join(change.worse)}" for change in changes if change.worse]
    return "\n".join([*lines, "", *(["Worse:", *worse] if worse else ["Nothing got worse."])])


def broken(entry: Entry, outcome: Outcome, quick: bool = False) -> list[str]:
    """The bounds of an entry that an outcome breaks, one sentence each; a lacking figure breaks its bound.

    Where a quick look gave the diagnosis less time than it needs, nothing is asked of its verdict and its figures.
    """
    unfinished = quick and outcome.verdict == "timeout"
    sentences = []
    if entry.bounds.verdicts and outcome.verdict not in entry.bounds.verdicts and not unfinished:
        sentences.append(f"{entry.name}: {outcome.verdict}, where {' or '.join(entry.bounds.verdicts)} is asked for")
    for role, words, bound in (
        ("training", "in training", entry.bounds.training),
        ("holdout", "held out", None if unfinished else entry.bounds.holdout),
    ):
        reached = outcome.error(role)
        if bound is not None and (reached is None or reached > bound):
            sentences.append(
                f"{entry.name}: error {words} {percent(reached)} %, at most {percent(bound)} % is asked for"
            )
    return sentences

"""Diagnoses held against the sealed truth: what was found, what was missed, what was imagined."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

from .answer import RigScore, read_answer, score_rig
from .dirty_score import dirty_score, dirty_targets

CLOSE = 1.03  # times the noise floor: as good as the truth itself
#: Edges of the calibration curve: probabilities that diagnoses give for what they name.
EDGES = (0.0, 0.5, 0.9, 0.95, 0.99, 0.999, 1.0)
FORMAT = "concealed-score/1"


def _share(flags: Iterable[bool]) -> float | None:
    some = list(flags)
    return sum(some) / len(some) if some else None


def _held_out(rigs: Sequence[RigScore]) -> dict[str, float | None]:
    before = [rig.before for rig in rigs if rig.before is not None]
    after = [rig.after for rig in rigs if rig.after is not None]
    return {
        "before": median(before) if before else None,
        "after": median(after) if after else None,
        "close": _share(value <= CLOSE for value in after),
    }


def row(name: str, rigs: Sequence[RigScore]) -> dict[str, Any]:
    """Count the rigs of one row of the scoreboard."""
    said = Counter(rig.answer.named[0] if rig.answer.named else rig.answer.verdict or "failed" for rig in rigs)
    return {
        "name": name,
        "rigs": len(rigs),
        "failed": sum(bool(rig.answer.problem) for rig in rigs),
        "strict": sum(rig.strict for rig in rigs),
        "alone": sum(rig.alone for rig in rigs),
        "twin": sum(rig.twin for rig in rigs),
        "group": sum(rig.group for rig in rigs),
        "missed": sum(not rig.group for rig in rigs if rig.kind == "single"),
        "more_named": sum(len(rig.answer.named) > 1 for rig in rigs if rig.kind == "single"),
        "false_alarms": sum(rig.false_alarm for rig in rigs),
        "unexplained": sum(rig.unexplained for rig in rigs),
        "both": sum(rig.found == 2 for rig in rigs),
        "one": sum(rig.found == 1 for rig in rigs if rig.kind == "two"),
        "held_out": _held_out(rigs),
        "said": dict(said.most_common()),
    }


def _target(words: str, value: float | None, limit: float, at_most: bool = False) -> list[dict[str, Any]]:
    """One line against the targets, or none where the suite has no such rigs."""
    if value is None:
        return []
    met = value <= limit if at_most else value >= limit
    return [{"target": words, "value": value, "limit": limit, "at_most": at_most, "met": met}]


def calibration(rigs: Sequence[RigScore]) -> list[dict[str, Any]]:
    """How often what is named with a stated probability is right; only rigs whose physics has a name count."""
    stated = [
        (chance, bool({name, *group} & set(rig.concealed)))
        for rig in rigs
        if rig.kind != "open"
        for name, group, chance in zip(rig.answer.named, rig.answer.groups, rig.answer.chances, strict=False)
    ]
    curve = []
    for low, high in pairwise(EDGES):
        right = [true for chance, true in stated if low <= chance < high or chance == high == 1.0]
        if right:
            curve.append({"above": low, "below": high, "named": len(right), "right": sum(right)})
    return curve


def _sure(curve: Sequence[dict[str, Any]]) -> float | None:
    """Share that is right of what was named with more than 95 %."""
    sure = [part for part in curve if part["above"] >= 0.95]
    named = sum(part["named"] for part in sure)
    return sum(part["right"] for part in sure) / named if named else None


def targets(rigs: Sequence[RigScore], scale: str) -> list[dict[str, Any]]:
    """Hold the suite against the targets; small rigs have one of their own."""
    singles = [rig for rig in rigs if rig.kind == "single"]
    nothing = [rig for rig in rigs if rig.kind == "none"]
    if scale == "small":
        rows = _target("small effects found, alone or in a group", _share(rig.group for rig in singles), 0.5)
    else:
        named = [rig.after is not None and rig.after <= CLOSE for rig in singles if rig.group]
        rows = [
            *_target("effect named first", _share(rig.strict for rig in singles), 0.95),
            *_target("effect named first and alone", _share(rig.alone for rig in singles), 0.92),
            *_target("effect in the group named", _share(rig.group for rig in singles), 0.98),
            *_target(f"held-out NRMSE within {CLOSE} noise floors, of those named", _share(named), 0.95),
            *_target("right, of what is named with more than 95 %", _sure(calibration(rigs)), 0.93),
        ]
    return [
        *rows,
        *_target("false alarms where nothing is missing", sum(rig.false_alarm for rig in nothing), 0, True)
        * bool(nothing),
        *_target("other physics left unexplained", _share(rig.unexplained for rig in rigs if rig.kind == "open"), 0.8),
    ]


def score(truth: dict[str, Any], results: Path) -> dict[str, Any]:
    """Score a suite: `truth` as unsealed, `results` the folder with rig_001/diagnosis.json and so on.

    Gives targets, one row for each effect (then none, open, two), and one entry for each rig; for dirty rigs also
    their own score as `dirty`, with their own targets. A diagnosis that is missing counts as a miss.
    """
    rigs = [
        score_rig(name, concealed, read_answer(results / name / "diagnosis.json"))
        for name, concealed in sorted(truth["rigs"].items())
    ]
    rows = []
    for name in sorted({rig.concealed[0] for rig in rigs if rig.kind == "single"}):
        rows.append(row(name, [rig for rig in rigs if rig.kind == "single" and rig.concealed[0] == name]))
    others = {"none": "nothing missing", "open": "physics of no list", "two": "two effects"}
    rows += [row(words, some) for kind, words in others.items() if (some := [rig for rig in rigs if rig.kind == kind])]
    singles = [rig for rig in rigs if rig.kind == "single"]
    dirty = dirty_score(rigs, truth["rigs"]) if truth.get("dirty") else None
    return {
        "format": FORMAT,
        "seed": truth["seed"],
        "scale": truth["scale"],
        "targets": dirty_targets(dirty["figures"]) if dirty else targets(rigs, truth["scale"]),
        "dirty": dirty,
        "calibration": calibration(rigs),
        "singles": row("one effect", singles) if singles else None,
        "rows": rows,
        "rigs": [asdict(rig) for rig in rigs],
        "recorded": [],
    }


def summary(board: dict[str, Any]) -> str:
    """The score in a few lines for a terminal."""
    lines = []
    for target in board["targets"]:
        counted = target["at_most"] and "error" not in target
        scale, unit = (1, "") if counted else (100, " %")
        error = f" ± {100 * target['error']:.0f}" if "error" in target else ""
        value, limit = f"{scale * target['value']:.0f}{error}{unit}", f"{scale * target['limit']:.0f}{unit}"
        asked = f"{'at most' if target['at_most'] else 'target'} {limit}"
        lines.append(f"{'met   ' if target['met'] else 'missed'} {target['target']}: {value} ({asked})")
    singles = board["singles"]
    if singles:
        lines.append(
            f"{singles['rigs']} rigs with one effect: {singles['strict']} named first ({singles['alone']} alone), "
            f"{singles['group']} in the group, {singles['twin']} named by a twin, {singles['failed']} failed; "
            f"a further effect is named beside it on {singles['more_named']}"
        )
    for part in board["calibration"] if not board["dirty"] else []:
        lines.append(
            f"named with {100 * part['above']:g} to {100 * part['below']:g} %: {part['right']} of {part['named']} right"
        )
    for group in board["rows"]:
        if group["name"] == "two effects":
            lines.append(f"{group['rigs']} rigs with two effects: both found in {group['both']}, one in {group['one']}")
    for part in board["dirty"]["reliability"] if board["dirty"] else []:
        lines.append(
            f"stated {100 * part['stated']:.1f} % ({100 * part['low']:.1f} to {100 * part['high']:.1f}): right in "
            f"{part['right']} of {part['of']}, {100 * part['share']:.0f} ± {100 * part['error']:.0f} %"
        )
    return "\n".join(lines)

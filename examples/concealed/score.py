"""Diagnoses held against the sealed truth: what was found, what was missed, what was imagined."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

CLOSE = 1.03  # times the noise floor: as good as the truth itself
#: Edges of the calibration curve: probabilities that diagnoses give for what they name.
EDGES = (0.0, 0.5, 0.9, 0.95, 0.99, 0.999, 1.0)
FORMAT = "concealed-score/1"


@dataclass(frozen=True)
class Answer:
    """What a diagnosis says: its effects in order, each with those it calls indistinguishable from it.

    `odds` are those stated with each effect. `held_out` has each record's name with its NRMSE before and after.
    `problem` says why there is no answer, if so.
    """

    verdict: str = ""
    named: tuple[str, ...] = ()
    groups: tuple[tuple[str, ...], ...] = ()
    odds: tuple[float, ...] = ()
    remainder: bool = False
    held_out: tuple[tuple[str, float, float], ...] = ()
    problem: str = ""


@dataclass(frozen=True)
class RigScore:
    """One rig: what was concealed, what was said, and how that counts.

    `strict`: the first effect named is the concealed one; `alone`: and no other is called indistinguishable; `group`:
    it is the first effect or in its group; `twin`: the first effect gives the very same equation. `found` counts the
    concealed effects that are in any group. `before` and `after`: worst held-out NRMSE over the truth's noise floor.
    """

    rig: str
    kind: str
    concealed: tuple[str, ...]
    variants: tuple[str, ...]
    answer: Answer
    strict: bool
    alone: bool
    group: bool
    twin: bool
    found: int
    false_alarm: bool
    unexplained: bool
    before: float | None
    after: float | None


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not value >= 0:
        raise ValueError(f"{value!r} is no positive number")
    return float(value)


def read_answer(path: Path) -> Answer:
    """Read a diagnosis.json; one that is missing or broken gives an answer with a `problem`, never an exception."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        effects = content["effects"]
        return Answer(
            verdict=str(content["verdict"]),
            named=tuple(str(effect["effect"]) for effect in effects),
            groups=tuple(tuple(map(str, effect.get("indistinguishable_from") or ())) for effect in effects),
            odds=tuple(_number(effect.get("odds", 0.0)) for effect in effects),
            remainder=content.get("remainder") is not None,
            held_out=tuple(
                (Path(str(row["file"])).name.split(".")[0], _number(row["nrmse_before"]), _number(row["nrmse_after"]))
                for row in content["fit"]["holdout"]
                if row["nrmse_before"] is not None and row["nrmse_after"] is not None
            ),
        )
    except OSError:
        return Answer(problem="no diagnosis.json")
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        return Answer(problem=f"diagnosis.json cannot be read: {type(problem).__name__}: {problem}")


def score_rig(rig: str, truth: dict[str, Any], answer: Answer) -> RigScore:
    """Hold one answer against the truth of its rig."""
    concealed = tuple(truth["effects"])
    first = answer.named[0] if answer.named else ""
    sets = [{name, *group} for name, group in zip(answer.named, answer.groups, strict=True)]
    strict = truth["kind"] == "single" and first == concealed[0]
    floors = {name: record["noise_floor"] for name, record in truth["recordings"].items()}
    ratios = [
        (before / floors[name], after / floors[name]) for name, before, after in answer.held_out if name in floors
    ]
    return RigScore(
        rig=rig,
        kind=truth["kind"],
        concealed=concealed,
        variants=tuple(truth["variants"]),
        answer=answer,
        strict=strict,
        alone=strict and len(sets[0]) == 1,
        group=truth["kind"] == "single" and bool(sets) and concealed[0] in sets[0],
        twin=first in truth.get("twins", ()),
        found=sum(any(name in names for names in sets) for name in concealed)
        if truth["kind"] in {"single", "two"}
        else 0,
        false_alarm=truth["kind"] == "none" and bool(answer.named),
        unexplained=answer.verdict == "unexplained" or answer.remainder or any(map(_learnt, answer.named)),
        before=max((before for before, _ in ratios), default=None),
        after=max((after for _, after in ratios), default=None),
    )


def _learnt(effect: str) -> bool:
    """Whether what is named has a shape and no cause: physics of no list is told as such."""
    return effect.startswith("free/")


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
        (odds / (1.0 + odds), bool({name, *group} & set(rig.concealed)))
        for rig in rigs
        if rig.kind != "open"
        for name, group, odds in zip(rig.answer.named, rig.answer.groups, rig.answer.odds, strict=False)
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

    Gives targets, one row for each effect (then none, open, two), and one entry for each rig. A diagnosis that is
    missing counts as a miss.
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
    return {
        "format": FORMAT,
        "seed": truth["seed"],
        "scale": truth["scale"],
        "targets": targets(rigs, truth["scale"]),
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
        value, limit = (
            f"{x:.0f}" if target["at_most"] else f"{100 * x:.0f} %" for x in (target["value"], target["limit"])
        )
        asked = f"{'at most' if target['at_most'] else 'target'} {limit}"
        lines.append(f"{'met   ' if target['met'] else 'missed'} {target['target']}: {value} ({asked})")
    singles = board["singles"]
    if singles:
        lines.append(
            f"{singles['rigs']} rigs with one effect: {singles['strict']} named first ({singles['alone']} alone), "
            f"{singles['group']} in the group, {singles['twin']} named by a twin, {singles['failed']} failed; "
            f"a further effect is named beside it on {singles['more_named']}"
        )
    for part in board["calibration"]:
        lines.append(
            f"named with {100 * part['above']:g} to {100 * part['below']:g} %: {part['right']} of {part['named']} right"
        )
    for group in board["rows"]:
        if group["name"] == "two effects":
            lines.append(f"{group['rigs']} rigs with two effects: both found in {group['both']}, one in {group['one']}")
    return "\n".join(lines)

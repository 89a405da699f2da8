"""What a diagnosis says of a rig, read from its file, and how that counts against what was concealed."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Answer:
    """What a diagnosis says: its effects in order, each with those it calls indistinguishable from it.

    `chances` are the probabilities stated with each effect. `held_out` has each record's name with its NRMSE before
    and after. `problem` says why there is no answer, if so.
    """

    verdict: str = ""
    named: tuple[str, ...] = ()
    groups: tuple[tuple[str, ...], ...] = ()
    chances: tuple[float, ...] = ()
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


def _chance(effect: dict[str, Any]) -> float:
    """The probability stated with an effect, or that of its odds."""
    odds = _number(effect.get("odds", 0.0))
    return min(_number(effect.get("probability", odds / (1.0 + odds) if odds < 1e300 else 1.0)), 1.0)


def read_answer(path: Path) -> Answer:
    """Read a diagnosis.json; one that is missing or broken gives an answer with a `problem`, never an exception."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        effects = content["effects"]
        return Answer(
            verdict=str(content["verdict"]),
            named=tuple(str(effect["effect"]) for effect in effects),
            groups=tuple(tuple(map(str, effect.get("indistinguishable_from") or ())) for effect in effects),
            chances=tuple(_chance(effect) for effect in effects),
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
        unexplained=(bool(answer.verdict) and answer.verdict != "consistent" and not answer.named)
        or answer.remainder
        or any(map(learnt, answer.named)),
        before=max((before for before, _ in ratios), default=None),
        after=max((after for _, after in ratios), default=None),
    )


def learnt(effect: str) -> bool:
    """Say whether what is named has a shape and no cause: physics of no list is told as such."""
    return effect.startswith("free/")

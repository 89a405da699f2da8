"""The score of dirty rigs: where no law is exact, are the names right, alone, and as probable as is said?

Every figure comes with its binomial error. A dirty rig's imperfections have laws of their own; naming one of these
beside the concealed effect, or where nothing is concealed, is no mistake.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import sqrt
from typing import Any

from .answer import RigScore, learnt

BINS = 5
SURE = 0.95
REACHED = 1.3  # times the exact law's held-out error
#: What is asked, as (words, limit, at most instead of at least), by the names under which figures are kept.
ASKED = {
    "first": ("effect named first", 0.80, False),
    "alone": ("nothing named that is not there", 0.70, False),
    "group": ("effect in the group named", 0.92, False),
    "false": ("a false name where there is dirt alone", 0.03, True),
    "sure": ("right, of what is named with more than 95 %", 0.93, False),
    "reliable": ("largest gap between stated and right, of five bins", 0.07, True),
    "reached": (f"held-out error within {REACHED} times the exact law's", 0.75, False),
}


def share(right: int, of: int) -> dict[str, Any]:
    """A share with its binomial standard error; half a rig more of either kind keeps that from vanishing."""
    middle = (right + 0.5) / (of + 1.0)
    return {
        "right": right,
        "of": of,
        "share": right / of if of else None,
        "error": sqrt(middle * (1 - middle) / (of + 1)),
    }


def _there(rig: RigScore, truth: Mapping[str, Any]) -> set[str]:
    return {*rig.concealed, *truth.get("twins", ()), *truth["dirt"]["own"]}


def _names(rig: RigScore) -> list[set[str]]:
    return [{name, *group} for name, group in zip(rig.answer.named, rig.answer.groups, strict=True)]


def false_names(rig: RigScore, truth: Mapping[str, Any]) -> list[str]:
    """What is named, in each group, and not there; a shape without a cause is no name."""
    there = _there(rig, truth)
    return sorted({name for names in _names(rig) for name in names if name not in there and not learnt(name)})


def reached(rig: RigScore, truth: Mapping[str, Any]) -> float | None:
    """Give the held-out error over the exact law's, of the recording where that is worse; None without an answer."""
    errors = {name: after for name, _, after in rig.answer.held_out}
    laws = {name: record["reachable"] for name, record in truth["recordings"].items() if "reachable" in record}
    ratios = [errors[name] / law for name, law in laws.items() if name in errors]
    return max(ratios) if ratios else None


def reliability(rigs: Sequence[tuple[RigScore, Mapping[str, Any]]]) -> list[dict[str, Any]]:
    """Five bins with as many names each, in the order of their stated probability: stated on average, right.

    A name is right where it, or one of its group, is there.
    """
    stated = sorted(
        (chance, bool(names & _there(rig, truth)))
        for rig, truth in rigs
        for names, chance in zip(_names(rig), rig.answer.chances, strict=True)
        if not all(learnt(name) for name in names)
    )
    edges = [len(stated) * i // BINS for i in range(BINS + 1)]
    return [
        share(sum(right for _, right in part), len(part))
        | {"stated": sum(chance for chance, _ in part) / len(part), "low": part[0][0], "high": part[-1][0]}
        for low, high in pairwise(edges)
        if (part := stated[low:high])
    ]


def _sure(rigs: Sequence[tuple[RigScore, Mapping[str, Any]]]) -> dict[str, Any]:
    flags = [
        bool(names & _there(rig, truth))
        for rig, truth in rigs
        for names, chance in zip(_names(rig), rig.answer.chances, strict=True)
        if chance > SURE and not all(learnt(name) for name in names)
    ]
    return share(sum(flags), len(flags))


def said_of(rig: RigScore) -> str:
    """What was said first of a rig: a name, or the verdict without one, or that it failed."""
    return rig.answer.named[0] if rig.answer.named else rig.answer.verdict or "failed"


def confusion(rigs: Sequence[RigScore]) -> dict[str, Any]:
    """What was said first, by what is concealed: `said` names the columns, `rows` count."""
    counts: dict[str, Counter[str]] = {}
    for rig in rigs:
        counts.setdefault(rig.concealed[0] if rig.concealed else "dirt alone", Counter())[said_of(rig)] += 1
    said = sorted({name for row in counts.values() for name in row}, key=lambda name: (name not in counts, name))
    return {"said": said, "rows": {name: [counts[name][column] for column in said] for name in sorted(counts)}}


def _figures(rigs: Sequence[tuple[RigScore, Mapping[str, Any]]]) -> dict[str, dict[str, Any]]:
    singles = [(rig, truth) for rig, truth in rigs if rig.kind == "single"]
    nothing = [(rig, truth) for rig, truth in rigs if rig.kind == "none"]
    ratios = [reached(rig, truth) for rig, truth in rigs]
    return {
        "first": share(sum(rig.strict for rig, _ in singles), len(singles)),
        "alone": share(sum(rig.strict and not false_names(rig, truth) for rig, truth in singles), len(singles)),
        "group": share(sum(rig.group for rig, _ in singles), len(singles)),
        "false": share(sum(bool(false_names(rig, truth)) for rig, truth in nothing), len(nothing)),
        "reached": share(sum(ratio is not None and ratio <= REACHED for ratio in ratios), len(ratios)),
    }


def dirty_score(rigs: Sequence[RigScore], truths: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Score dirty rigs: figures, reliability, confusion and one row for each experiment, as plain data."""
    pairs = [(rig, truths[rig.rig]) for rig in rigs]
    bins = reliability(pairs)
    figures = _figures(pairs) | {"sure": _sure(pairs)}
    if bins:
        worst = max(bins, key=lambda part: abs(part["share"] - part["stated"]))
        figures["reliable"] = {
            "right": worst["right"],
            "of": worst["of"],
            "share": abs(worst["share"] - worst["stated"]),
            "error": worst["error"],
        }
    kinds = sorted({(truth["experiment"], truth["quantity"]) for _, truth in pairs})
    experiments = {
        f"{experiment}, {quantity}": _figures(
            [(rig, truth) for rig, truth in pairs if (truth["experiment"], truth["quantity"]) == (experiment, quantity)]
        )
        for experiment, quantity in kinds
    }
    return {
        "figures": figures,
        "reliability": bins,
        "confusion": confusion(rigs),
        "experiments": experiments,
        "rigs": {
            rig.rig: {
                "experiment": f"{truth['experiment']}, {truth['quantity']}",
                "imperfections": [one["name"] for one in truth["dirt"]["imperfections"]],
                "left_over_noise": truth["dirt"]["left_over_noise"],
                "share": truth["dirt"]["share"],
                "false_names": false_names(rig, truth),
                "reached": reached(rig, truth),
            }
            for rig, truth in pairs
        },
    }


def dirty_targets(figures: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Hold the figures against what is asked, as lines of the scoreboard; nothing where no rig says anything."""
    return [
        line
        for key, (words, limit, at_most) in ASKED.items()
        if key in figures
        for line in target(words, figures[key], limit, at_most)
    ]


def target(words: str, one: Mapping[str, Any], limit: float, at_most: bool = False) -> list[dict[str, Any]]:
    """One line of the scoreboard, or none where nothing was counted."""
    if one["share"] is None:
        return []
    met = one["share"] <= limit if at_most else one["share"] >= limit
    line = {"target": words, "value": one["share"], "error": one["error"], "limit": limit}
    return [line | {"at_most": at_most, "met": met}]

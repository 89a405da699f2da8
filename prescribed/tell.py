"""What was found along prescribed motions, in words and as data: the form of any diagnosis."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np

from ..diagnose.limits import MATTERS
from ..diagnose.result import SURE
from ..diagnose.wording import effects_in_words, quantity
from ..identify.signals.odds import ABOVE_NOISE
from ..identify.signals.registry import shown
from ..model.fit_state import percent_words
from ..model.parameter import Parameter
from ..model.show import finite
from .element_fit import ElementFit, ElementFound, Record
from .search import Named
from .tell_ways import as_effects, few_values, said_of

_SLOW = shown(0.6, "of the mean speed", why="what is left at so low a speed is said to be where the motion turns")
_FAST = shown(1.4, "of the mean speed", why="the same at high speed")
_LOUD = shown(0.9, "of the samples", why="those that leave more are where the model fails")

Verdict = Literal["consistent", "missing-physics", "unexplained"]


def verdict_of(found: ElementFound) -> Verdict:
    """``missing-physics`` where a law was named; ``unexplained`` only where something large is left."""
    if found.after is not None:
        return "missing-physics"
    records = found.before.records
    noise = all(record.over_noise <= ABOVE_NOISE for record in records)
    return "consistent" if noise or all(record.nrmse**2 <= MATTERS for record in records) else "unexplained"


def sentence_of(found: ElementFound) -> str:
    """The verdict for a person: what is missing, how much it takes away, what remains."""
    verdict, worst = verdict_of(found), max(found.best.records, key=lambda record: record.nrmse)
    left = f"{worst.of_force} in {worst.file}, {worst.of_noise}"
    noise = all(record.over_noise <= ABOVE_NOISE for record in found.best.records)
    if verdict == "consistent":
        if noise:
            return "Nothing is missing: the members of Eq. 17 give every force to within its noise."
        return f"The members of Eq. 17 give every force but for {left}; no law that was tried tells more."
    if verdict == "unexplained":
        return f"Something is missing that no law of the library explains: there remains {left}."
    laws = [named.law.name for named in found.found.named]
    before = max(found.before.records, key=lambda record: record.nrmse)
    parts = [f"the force error falls from {_percent(before)} to {_percent(worst)} %"]
    if found.held_before:
        pairs = zip(found.held_before, found.held_after, strict=True)
        one, other = max(pairs, key=lambda pair: pair[0].nrmse)
        where = f"the last third of {one.file}" if found.in_pieces else one.file
        parts.append(f"in {where}, held out, from {_percent(one)} to {_percent(other)} %")
    remains = "what is left is noise" if noise else f"there remains {left}"
    figures = ", ".join(parts)
    causes = [*([effects_in_words(laws)] if laws else []), *said_of(found.found, found.best.element)]
    return f"Missing: {'; '.join(causes)}. {figures[0].upper()}{figures[1:]}; {remains}."


def _percent(record: Record) -> str:
    return percent_words(100 * record.nrmse)


def where_it_fails(fit: ElementFit) -> tuple[str, dict[str, Any]]:
    """Where the members leave most, as a sentence and as ranges: over displacement and speed."""
    place = int(np.argmax([record.nrmse for record in fit.records]))
    motion, force = fit.motions[place], fit.forces[place]
    left = np.where(motion.told, motion.force - force, 0.0)
    loud = np.abs(left) > np.quantile(np.abs(left[motion.told]), _LOUD)
    x, v = motion.displacement[loud], motion.velocity[loud]
    reach = float(np.max(np.abs(motion.velocity)))
    slow = float(np.mean(np.abs(v)) / max(float(np.mean(np.abs(motion.velocity[motion.told]))), np.finfo(float).tiny))
    unit = fit.element.unit
    size = quantity(float(np.sqrt(np.mean(left[loud] ** 2))), fit.element.force_unit)
    kind = "where the motion turns, at low speed" if slow < _SLOW else "at high speed" if slow > _FAST else ""
    ends = f"between {quantity(float(np.min(x)), unit)} and {quantity(float(np.max(x)), unit)}"
    said = f"Most is left in {fit.records[place].file}{f' {kind}' if kind else ''}: {size}, {ends}"
    ranges = {
        "displacement": [float(np.min(x)), float(np.max(x))],
        "velocity": [float(np.min(v)), float(np.max(v))],
        "amplitude": [float(np.min(np.abs(x - fit.element.origin))), float(np.max(np.abs(x - fit.element.origin)))],
        "frequency_hz": [motion.pace / (2 * math.pi)] * 2,
        "time_s": [motion.start, motion.start + motion.n * motion.dt],
        "recordings": [fit.records[place].file],
    }
    return f"{said} (the speed reaches {quantity(reach, f'{unit}/s')}).", ranges


def next_test(found: ElementFound) -> str:
    """Which test would tell more, in a sentence."""
    names = {name for named in found.found.named for name in (named.law.name, *named.rivals)}
    if (further := few_values(found.found, found.best)) is not None:
        return further
    paths = {named.law.path for named in found.found.named}
    reach = found.best.element.amplitude
    stroke = "" if reach is None else f" of ± {quantity(0.5 * reach.max, found.best.element.unit)}"
    if "memory" in paths or len(names) > 1:
        return (
            f"Prescribe the same stroke at a third and at three times the speed, and a smaller one{stroke}: what "
            "depends on the turning points stays, what depends on the speed moves."
        )
    return f"Prescribe another stroke{stroke} and another speed, and hold that recording out (--holdout)."


def as_json(found: ElementFound) -> dict[str, Any]:
    """As ``diagnosis.json`` has it."""
    before, after = found.before, found.after
    statement, ranges = where_it_fails(before)
    fits = [*zip(before.records, (after or before).records, strict=True)]
    held = [*zip(found.held_before, found.held_after, strict=True)]
    old, new = before.element.parameters(), found.best.element.parameters()
    return {
        "format": "dashpot-diagnosis/1",
        "verdict": verdict_of(found),
        "sentence": sentence_of(found),
        "effects": [
            *([_effect(named, found.best) for named in found.found.named] if after is not None else []),
            *as_effects(found.found, found.best),
        ],
        "location": {"path": "", "statement": statement, **ranges},
        "fit": {"train": [_fit(*pair) for pair in fits], "holdout": [_fit(*pair) for pair in held]},
        "parameter_shift": {
            name: {"before": p.value, "after": new[name].value, "std": finite(p.std)}
            for name, p in old.items()
            if name in new
            if p.std is not None or new[name].std is not None
        },
        "considered": [
            {
                "effect": " + ".join(other.names) or "the members alone",
                "holdout_nrmse": _held(other.held, found),
                "delta_bic": None,
                "why_not": why,
            }
            for other, why in found.found.tried
        ],
        "untried": list(found.found.untried),
        "next_experiment": next_test(found),
    }


def _held(left: tuple[np.ndarray, ...], found: ElementFound) -> float | None:
    """Root mean square of what is left of the held-out motions over that of the best's, in its NRMSE; None without."""
    best = found.found.best.held
    if not left or not found.held_after:
        return None
    size = math.sqrt(sum(float(np.sum(one**2)) for one in best)) or np.finfo(float).tiny
    value = math.sqrt(sum(float(np.sum(one**2)) for one in left)) / size
    return finite(value * max(record.nrmse for record in found.held_after))


def _effect(named: Named, fit: ElementFit) -> dict[str, Any]:
    own: dict[str, Parameter] = next(dict(t.parameters) for t in fit.element.terms if t.law.name == named.law.name)
    return {
        "effect": named.law.effect,
        "law": named.law.name,
        "path": named.law.path,
        "parameters": {n: {"value": p.value, "std": finite(p.std), "unit": p.unit} for n, p in own.items()},
        "indistinguishable_from": list(named.rivals),
        "separated_by": "",
        "odds": min(named.odds, SURE),
        "probability": min(named.odds, SURE) / (1.0 + min(named.odds, SURE)),
        "share": named.share,
    }


def _fit(before: Record, after: Record) -> dict[str, Any]:
    return {
        "file": before.file,
        "nrmse_before": before.nrmse,
        "nrmse_after": after.nrmse,
        "noise_floor": before.noise_floor,
    }

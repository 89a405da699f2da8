"""The verdict, and the sentence that says it to a person."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..files.spoken import spoken
from ..identify.signals.odds import ABOVE_NOISE
from ..identify.signals.registry import shown
from ..model.effect_words import effect_in_words
from ..model.fit_state import percent_words
from .limits import MATTERS
from .result import Effect, RecordFit, Verdict
from .search.residual_test import FAR_ABOVE_NOISE, Leftover
from .wording import effects_in_words, figure

_IN_WORDS = shown(5, "effects and rivals", why="more cannot be put into words in one sentence")


_UNFINISHED = "The time allowed ended before everything was tried, and what was not may say more: raise --seconds."


def verdict_of(
    mended: object, remainder: str | None, records: Sequence[RecordFit], *, untried: bool = False
) -> Verdict:
    """``missing-physics`` where the model was ``mended``; ``unexplained`` only where something large is left.

    Where more than noise is left and something was ``untried`` for want of time, nobody knows yet: ``unexplained``.

    Every recording's free simulation is judged: to its noise, whatever the colour of that, where nothing is left that
    moves with the rig, else to a hundredth of its power, which is enough for many uses.
    """
    if mended:
        return "missing-physics"
    noise = remainder is None and all(r.nrmse_before <= FAR_ABOVE_NOISE * r.noise_floor for r in records)
    small = bool(records) and all(r.nrmse_before**2 <= MATTERS for r in records)
    return "consistent" if noise or (small and not untried) else "unexplained"


def sentence_of(
    verdict: Verdict,
    effects: Sequence[Effect],
    remainder: str | None,
    records: Sequence[RecordFit],
    before: Sequence[Leftover],
    after: Sequence[Leftover],
    unnamed: Mapping[str, float | None] | None = None,
    *,
    untried: bool = False,
) -> str:
    """The verdict for a person: what is missing, how much of what was missing it takes away, what remains.

    Args:
        verdict: the verdict.
        effects: what was named.
        remainder: what is left beyond the noise, in words.
        records: every recording, simulated freely.
        before, after: what the family and the mended model leave in each stretch.
        unnamed: laws of the mended model that are not named, with the share of what is left without it that each takes.
        untried: whether the time allowed ended before everything was tried.
    """
    unfinished = f" {_UNFINISHED}" if untried and remainder is not None else ""
    if verdict == "consistent":
        return _consistent(records, remainder)
    if verdict == "unexplained" and unfinished:
        return f"Undecided: something is left, {remainder}, and nothing that was tried explains it.{unfinished}"
    if verdict == "unexplained":
        return f"Something is missing that no effect of the library explains: {remainder or _worst(records)}."
    parts = []
    share = explained_share(before, after)
    if share is not None and remainder is not None:
        takes = "it takes" if len(effects or unnamed or ()) == 1 else "they take"
        if effects and unnamed:
            takes = f"together with what is in the model and not named ({spoken(list(unnamed))}) {takes}"
        parts.append(f"{takes} {figure(100 * share, 2)} % of what the model lacked")
    parts += _held_out(records)
    if remainder is not None:
        parts.append(remainder)
    figures = "; ".join(parts)
    missing = f"Missing: {_named(effects)}." if effects else _untold(unnamed or {})
    return missing + (f" {figures[0].upper()}{figures[1:]}." if figures else "") + unfinished


def _consistent(records: Sequence[RecordFit], remainder: str | None) -> str:
    """That nothing is missing; with the recording that leaves most where that is more than its noise."""
    worst = max(records, key=_times_the_noise, default=None)
    if worst is None or (remainder is None and worst.nrmse_before <= ABOVE_NOISE * worst.noise_floor):
        return "Nothing is missing: the model reproduces every recording to within its noise."
    if remainder is not None:
        worst = max(records, key=lambda record: record.nrmse_before)
        left = worst.left_before
        return (
            f"The model reproduces every recording to {percent_words(100 * left.part)} % of its motion ({worst.file}, "
            f"{left.of_noise}); no effect that was tried tells more."
        )
    left = worst.left_before
    return (
        f"Nothing that moves with the rig is missing: what is left in {worst.file}, {left.of_noise} of its highest "
        f"frequencies and {left.of_motion}, is not seen to follow it."
    )


def _untold(laws: Mapping[str, float | None]) -> str:
    """That laws explain what is missing, none of which has a strength that is told from none."""
    if len(laws) == 1:
        return f"Something is missing that acts like {effect_in_words(*laws)}, whose strength is not told from none."
    shares = [
        effect_in_words(law) + ("" if share is None else f" with {figure(100 * share, 2)} % of what is left without it")
        for law, share in laws.items()
    ]
    return (
        f"Something is missing that these explain together, and which of them is there is not told: {spoken(shares)}."
    )


def _named(effects: Sequence[Effect]) -> str:
    """The effects in the words of the field, each with those that it cannot be distinguished from.

    Where many are named the rivals bear their names alone, so that the sentence can still be read.
    """
    items = []
    many = sum(1 + len(effect.indistinguishable_from) for effect in effects) > _IN_WORDS
    for effect in effects:
        rivals = effect.indistinguishable_from
        others = spoken(rivals, "or") if many else effects_in_words(rivals, "or")
        items.append(effect_in_words(effect.law) + (f", or else {others}" if rivals else ""))
    if not any(effect.indistinguishable_from for effect in effects):
        return spoken(items)
    return "; ".join([*items[:-1], f"and {items[-1]}"]) if len(items) > 1 else items[0]


def explained_share(before: Sequence[Leftover], after: Sequence[Leftover]) -> float | None:
    """Share of the power beyond the noise, in units of the noise of each stretch, that the effects take away."""
    excess = [sum(max(stretch.ratio**2 - 1.0, 0.0) for stretch in model) for model in (before, after)]
    if not math.isfinite(excess[0]) or not excess[0] > 0 or not math.isfinite(excess[1]):
        return None
    return max(0.0, 1.0 - excess[1] / excess[0])


def worst_of(records: Sequence[RecordFit]) -> RecordFit:
    """The recording that the family's free simulation is off by most, in times its noise; a held-out one if there is.

    What does not come to its end is farthest.
    """
    held = [record for record in records if record.holdout]
    return max(held or records, key=_times_the_noise)


def _times_the_noise(record: RecordFit) -> float:
    return record.left_before.times


def _held_out(records: Sequence[RecordFit]) -> list[str]:
    """The held-out recording that the family explained worst, before and after; where it rises, how many fall."""
    held = [r for r in records if r.holdout and math.isfinite(r.nrmse_after)]
    if not held:
        return []
    worst = worst_of(held)
    known = math.isfinite(worst.nrmse_before)
    before = percent_words(100 * worst.nrmse_before) if known else "where nothing simulates"
    way = "rises" if worst.nrmse_after > worst.nrmse_before else "falls"
    falls = sum(not r.nrmse_after > r.nrmse_before for r in held)
    others = f", and falls in {falls} of the {len(held) - 1} others" if way == "rises" and falls else ""
    return [
        f"the held-out error {way} from {before} to {worst.left_after.of_motion} in {worst.file} "
        f"(noise {percent_words(100 * worst.noise_floor)} %){others}"
    ]


def _worst(records: Sequence[RecordFit]) -> str:
    """The recording that the family's free simulation misses by most."""
    if not records:
        return "see the notes"
    worst = max(records, key=_times_the_noise)
    if not math.isfinite(worst.nrmse_before):
        return f"a free simulation of {worst.file} does not come to its end"
    return f"a free simulation of {worst.file} is off by {worst.left_before.of_motion}"

"""What the recordings say of weighed structures: odds, what is accepted, what cannot be told apart, and the names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ...identify.fit.mismatch import gain_of_mismatch
from ...identify.problem.data import Data
from ...identify.problem.structure import Fitted
from ...identify.signals.odds import ABOVE_NOISE, DECISIVE
from ...identify.signals.registry import budget
from ...model.law import Law
from ...model.library import KNOWN, find
from ...model.oscillator import Oscillator, Term
from ..limits import GROUP, LISTED, MATTERS
from .candidate import Candidate
from .chance import by_chance
from .residual_test import times_of_each

_BAGS = budget(100, "draws of the blocks", why="a probability of a half is then known to a twentieth")


def log_odds(candidate: Candidate, other: Candidate, parts: Sequence[Data]) -> float:
    """Logarithm of how many times more probable one structure is than another, given all recordings.

    That counts every sample as a witness of its own, which is right where what is left is noise. Where the better one
    leaves a mismatch, its samples repeat each other, and its witnesses count instead, the more of them the nearer it is
    to the noise, and never beyond what all samples say.
    """
    return float(_odds(candidate, other, parts, len(candidate.laws) - len(other.laws))[0])


def odds_in_bags(candidate: Candidate, other: Candidate, parts: Sequence[Data]) -> np.ndarray:
    """(1 + bags,) the same for a name, and what it would be in bags of the blocks; see ``gain_of_mismatch``.

    A search lets a law lead that takes more than one random force; a name must take more than as many as it has
    unknowns.
    """
    fits = candidate.fit, other.fit
    count, instead = (0 if fit is None else len(fit.free) + int(np.count_nonzero(fit.initial)) for fit in fits)
    return _odds(candidate, other, parts, count - instead, _BAGS)


def _odds(candidate: Candidate, other: Candidate, parts: Sequence[Data], more: int, bags: int = 0) -> np.ndarray:
    """The same, where as many random forces ``more`` (or less) as the other take their part by chance."""
    total = candidate.value - other.value
    share = mismatch_share(candidate if total >= 0 else other, parts)
    pairs = [(other.fit, candidate.fit), (other.held_out, candidate.held_out)]
    both = [pair for pair in pairs if pair[0] is not None and pair[1] is not None]
    if share <= 0.0 or not both or not all(fit.finite for pair in both for fit in pair if fit is not None):
        return np.full(1 + bags, total)
    before, after = ([r for pair in both if (fit := pair[i]) for r in fit.residuals] for i in (0, 1))
    segments = [segment for data in parts[: len(both)] for segment in data.segments]
    gain, worth = gain_of_mismatch(before, after, segments, bags)
    # what is not there takes its part too; before anything was measured each law was as likely as any other
    fewer = (other if more > 0 else candidate).fit
    if more and fewer is not None:
        gain += math.copysign(0.5 * worth, more) * math.log1p(-share * by_chance(fewer, parts[0], abs(more)))
    prior = _prior(len(candidate.laws) - len(other.laws))
    samples = sum(segment.n for segment in segments)
    gain *= 1.0 / (worth / samples + share)
    return np.clip(gain - share * prior, -abs(total), abs(total))


def needed_in_samples(fitted: Fitted, data: Data) -> float:
    """Log-likelihood, each sample a witness of its own, that a law must gain to be decisive by what is a witness.

    As ``log_odds`` has it, on the training recordings and but for chance: far from the noise nothing that gains less is
    accepted, and at the noise this is nothing.
    """
    ratio = max(times_of_each(fitted.residuals, fitted.model, data))
    share = _beyond_noise(ratio)
    if share <= 0.0 or not fitted.finite:
        return 0.0
    _, worth = gain_of_mismatch(fitted.residuals, fitted.residuals, data.segments)
    samples = sum(segment.n for segment in data.segments)
    return share * samples / max(worth, 1.0) * (DECISIVE + share * _prior(1))


def _prior(laws: int) -> float:
    """Logarithm of how many structures of so many laws there are to choose from, each as likely as another."""
    return laws * math.log(sum(not law.learnt for law in KNOWN.values()))


def _beyond_noise(ratio: float) -> float:
    """Part of the power that is no noise of what is left so many times the noise."""
    return 1.0 - (ABOVE_NOISE / ratio) ** 2 if ratio > ABOVE_NOISE else 0.0


def mismatch_share(candidate: Candidate, parts: Sequence[Data]) -> float:
    """Part of the power that a structure leaves which is no noise, as well as that is known; 0 where all may be."""
    return _beyond_noise(max(_times_the_noise(candidate, parts)))


def leaves_mismatch(candidate: Candidate, parts: Sequence[Data]) -> bool:
    """Whether what a structure leaves is more than the noise, as well as that is known."""
    return mismatch_share(candidate, parts) > 0.0


def _times_the_noise(candidate: Candidate, parts: Sequence[Data]) -> list[float]:
    fits = [fit for fit in (candidate.fit, candidate.held_out) if fit is not None]
    return [r for fit, data in zip(fits, parts, strict=True) for r in times_of_each(fit.residuals, fit.model, data)]


def accepted(candidate: Candidate, leader: Candidate, parts: Sequence[Data]) -> bool:
    """Whether a structure with further laws is decidedly better, on what was held out too, and by enough to matter."""
    if candidate.foretold <= leader.foretold:
        return False
    return matters(candidate, leader) and log_odds(candidate, leader, parts) > DECISIVE


def matters(candidate: Candidate, leader: Candidate) -> bool:
    """Whether it takes away at least a hundredth of the power in some segment: a tenth of its size."""
    pairs = zip(leader.residuals, candidate.residuals, strict=True)
    return any(np.mean(old**2) > (1.0 + MATTERS) * np.mean(new**2) for old, new in pairs)


def leading(leader: Candidate, arrived: Sequence[Candidate], parts: Sequence[Data]) -> Candidate:
    """What leads from here on: a shorter structure that comes as near, else the most probable that is accepted.

    Args:
        leader: so far.
        arrived: its neighbours, weighed by the same measure.
        parts: training recordings, and those held out where there are any.
    """
    fewer = [c for c in arrived if set(c.laws) < set(leader.laws)]
    shorter = [c for c in fewer if log_odds(leader, c, parts) < DECISIVE]  # by the odds that the longer needs to be led
    if shorter:
        return max(shorter, key=lambda c: c.value)
    # one as long, or shorter, has nothing to prove beyond being more probable
    as_long = [c for c in arrived if len(c.laws) <= len(leader.laws) and log_odds(c, leader, parts) > 0]
    as_long = [c for c in as_long if tells_as_well(c, leader)]
    further = [c for c in arrived if accepted(c, leader, parts)]
    return max([leader, *as_long, *further], key=lambda c: log_odds(c, leader, parts))


def tells_as_well(candidate: Candidate, leader: Candidate) -> bool:
    """Whether it tells what was held out not decisively worse or, where nothing was, foretells it no worse."""
    return candidate.foretold >= leader.foretold - (0.0 if candidate.held_out is None else DECISIVE)


def first_of_several(given: Candidate, candidates: Iterable[Candidate], parts: Sequence[Data]) -> Candidate | None:
    """The most probable of those for which the training is decisive, where each tells what was held out worse.

    Where several effects are missing, one of them alone may be bent to stand for the others where it was fitted, and
    tell the rest worse; a search goes on from there, and what it ends with has to tell the rest better than the family.

    Args:
        given: the family.
        candidates: all that were weighed or left.
        parts: training recordings, and those held out where there are any.
    """
    judged = [candidate for candidate in candidates if candidate.stage == "judged" and candidate.laws]
    named = [c for c in judged if matters(c, given) and log_odds(c, given, parts) > DECISIVE]
    return max(named, key=lambda c: log_odds(c, given, parts), default=None)


def why_not(candidate: Candidate, without: Candidate, best: Candidate, parts: Sequence[Data]) -> str:
    """Why a weighed structure was not taken, beside the one without its law and the best."""
    gain, held_out = candidate.evidence - without.evidence, candidate.foretold - without.foretold
    if candidate.value > without.value + DECISIVE and without.laws != best.laws:
        behind = best.value - candidate.value
        return f"{' + '.join(best.laws) or 'the given family'} is more probable: by {behind:.4g} in log-evidence"
    if held_out <= 0:
        where = "the held-out ones" if len(parts) > 1 else "stretches of them that are foretold from the others"
        return f"it gains {gain:.4g} in log-evidence on the training recordings and {held_out:.4g} on {where}"
    if not matters(candidate, without):
        return "it gains something, but less than a tenth of the noise in every recording"
    return f"its odds are not decisive: {log_odds(candidate, without, parts):.3g} in log-evidence"


def only_a_name(law: Law) -> bool:
    """Whether a law has the parameters of its twin, all of them."""
    return law.twin is not None and len(find(law.twin).parameters) == len(law.parameters)


def names_of(term: Term, model: Oscillator) -> tuple[str, ...]:
    """The laws whose name suits a term with its values, the plainest first: laws of one equation, or a case of it.

    Args:
        term: as fitted.
        model: of which it is one; the names of its other terms are taken.
    """
    law, values = find(term.effect), model.values()
    taken = {other.effect for other in model.terms} - {term.effect}
    alike = (other for other in KNOWN.values() if law.twin == other.name or other.twin == law.name)
    family = [law, *(other for other in alike if other.effect not in taken)]
    own = list(term.parameters.values())
    suiting = []
    for other in family:
        if any(parameter.value for parameter in own[len(other.parameters) :]):
            continue  # it lacks what this one has
        named = {p.name: q.value for p, q in zip(other.parameters, own, strict=False)}
        named |= {p.name: 0.0 for p in other.parameters[len(own) :]}
        if other.proper is None or other.proper(named, values):
            suiting.append(other)
    suiting.sort(key=lambda other: (other is not law, list(KNOWN).index(other.name)))
    return tuple(other.name for other in suiting) or (law.name,)


@dataclass(frozen=True)
class Standing:
    """How one law of the best structure stands beside what could be in its place.

    Attributes:
        odds: of its group against all other structures that were weighed, and causes that the library does not have.
        rivals: laws that cannot be told from it, the most probable first.
        first: the most probable of all; empty where that is none.
    """

    odds: float
    rivals: tuple[str, ...]
    first: str


def standing(law: str, best: Candidate, candidates: Sequence[Candidate], parts: Sequence[Data]) -> Standing:
    """Odds of one law of the best structure, and its group: the smallest set that holds the share ``GROUP``.

    Far from the noise that is the mean over bags, and a rival is also what left the race: there each sample counted,
    and what stays a thousand samples behind may be as probable by the witnesses. However much more probable than all
    that was weighed, what leaves a mismatch may there act like a cause that the library does not have.

    Args:
        law: of the best structure.
        best: the best structure.
        candidates: all that were entered.
        parts: training recordings and those held out.
    """
    rest = set(best.laws) - {law}
    odds = {law: np.zeros(1 + _BAGS)}
    for candidate in candidates:
        if candidate.fit is None or candidate.laws == best.laws or not rest <= set(candidate.laws):
            continue
        instead = [name for name in candidate.laws if name not in rest]
        if len(instead) > 1:
            continue
        name = instead[0] if instead else ""
        instead_of_it = -odds_in_bags(best, candidate, parts)
        if name not in odds or instead_of_it[0] > odds[name][0]:
            odds[name] = instead_of_it
    weights = np.exp(np.array(list(odds.values())) - np.max(list(odds.values()), axis=0))
    known = dict(zip(odds, np.mean(weights / np.sum(weights, axis=0), axis=1), strict=True))
    names = sorted(known, key=lambda name: -known[name])
    shares = np.array([known[name] for name in names])
    count = int(np.searchsorted(np.cumsum(shares), GROUP)) + 1
    group = [name for name in names[:count] if name]
    if law not in group:
        group.append(law)
    held = sum(share for name, share in zip(names, shares, strict=True) if name in group)
    weighed = held / max(1.0 - held, np.finfo(float).tiny)
    odds_on = weighed / (1.0 + weighed * mismatch_share(best, parts) / LISTED)
    return Standing(float(odds_on), tuple(name for name in group if name != law), names[0])

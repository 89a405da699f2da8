"""The plainest model that explains: members of Eq. 17 that the recordings do not tell from none are left at zero.

Each costs the others some of what is known of them. Whether it is there is a question of odds: the likelihood of its
estimate with the member at zero, over that with a value of the size at which it matters (Jeffreys 1961, chapter V).
What not knowing the answer does to the others is in their errors: the law of total variance over both models (Hoeting
et al. 1999, equation 3). Absence has to be decisive: what is left out by mistake bends the others.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ...errors import BadInput
from ...files.spoken import spoken
from ...model import Oscillator
from ...model.fit_state import LACKING
from ..problem.data import displacement_amplitude
from ..problem.structure import typical_sizes
from ..signals.odds import DECISIVE
from .likeliest_modes import MEMBERS
from .reported_result import Fit

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Absent:
    """Members that are likelier not there.

    Attributes:
        names: which.
        log_odds: of their absence.
        spread: (k, k) what that they may be there adds to the covariance of the other parameters.
    """

    names: tuple[str, ...]
    log_odds: float
    spread: np.ndarray


def likely_absent(names: Sequence[str], values: np.ndarray, covariance: np.ndarray, sizes: np.ndarray) -> Absent | None:
    """The members whose absence together is the likeliest, and decisively so; None where none are decisively absent.

    Args:
        names: of k free parameters.
        values: (k,) where they came to.
        covariance: (k, k) of these.
        sizes: (k,) at which each matters; a member that is there is of that size.
    """
    members = [i for i, name in enumerate(names) if name in MEMBERS and covariance[i, i] > 0]
    odds = {
        some: _log_odds(values[list(some)] / sizes[list(some)], _over(covariance, sizes, some, some))
        for count in range(1, len(members) + 1)
        for some in combinations(members, count)
    }
    gone = max(odds, key=lambda some: odds[some], default=())
    if not gone or not odds[gone] > DECISIVE:
        return None
    kept = [i for i in range(len(names)) if i not in gone]
    spread = np.zeros((len(kept),) * 2)
    odds[()] = 0.0
    total = sum(np.exp(odds[some] - odds[gone]) for some in odds if set(some) <= set(gone))
    for others in (some for some in odds if set(some) < set(gone)):  # these are not there, the rest of `gone` is
        there = tuple(i for i in gone if i not in others)
        mean, known = given_none(values, covariance, sizes, others)
        inverse = np.linalg.pinv(_over(known, sizes, there, there), hermitian=True)
        follows = known[np.ix_(kept, list(there))] / sizes[list(there)] @ inverse  # what each moves the others by
        of_size = np.linalg.inv(inverse + np.eye(len(there)))
        found = of_size @ inverse @ (mean[list(there)] / sizes[list(there)])
        likely = np.exp(odds[others] - odds[gone]) / total
        spread += likely * follows @ (of_size + np.outer(found, found)) @ follows.T
    return Absent(tuple(names[i] for i in gone), float(odds[gone]), spread)


def _log_odds(found: np.ndarray, spread: np.ndarray) -> float:
    """Of no member against members of about their sizes, from (k,) estimates and their (k, k) covariance in sizes."""
    sizes, along = np.linalg.eigh(spread)
    known = sizes > found.size * np.finfo(float).eps * sizes[-1]  # of what rounding hides, nothing is said
    parts, sizes = (along.T @ found)[known], sizes[known]
    return float(0.5 * (np.sum(np.log1p(1 / sizes)) - np.sum(parts**2 / (sizes * (1 + sizes)))))


def _over(covariance: np.ndarray, sizes: np.ndarray, some: Sequence[int], others: Sequence[int]) -> np.ndarray:
    return covariance[np.ix_(list(some), list(others))] / np.outer(sizes[list(some)], sizes[list(others)])


def given_none(
    values: np.ndarray, covariance: np.ndarray, sizes: np.ndarray, gone: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Estimates (k,) and their covariance where some of them are known to be zero."""
    if not gone:
        return values, covariance
    across = covariance[:, list(gone)] / sizes[list(gone)]
    moves = across @ np.linalg.pinv(_over(covariance, sizes, gone, gone), hermitian=True)
    return values - moves @ (values[list(gone)] / sizes[list(gone)]), covariance - moves @ across.T


def plainest(fit: Fit, again: Callable[[Oscillator, Sequence[str]], Fit]) -> Fit:
    """The fit without the members that are likelier not there, or the fit as it is.

    Where the fit leaves more than noise and does without them leave less, its search has ended in a false valley: then
    the members are asked for once more, from there.

    Args:
        fit: of a model with any members.
        again: fits a model from its values, with some names that keep theirs.
    """
    absent = _absent_from(fit)
    if absent is None:
        _log.info("every member stays: none is decisively absent")
        return fit
    _log.info("without %s: log-odds %.3g that none of it is there", ", ".join(absent.names), absent.log_odds)
    without = _without(fit, absent, again)
    lost = _left(fit) > LACKING
    if without is None or _left(without) > max(_left(fit), LACKING):
        return fit
    if lost:
        fuller = again(without.oscillator, ())
        absent = _absent_from(fuller)
        if absent is None or _left(without) > max(_left(fuller), LACKING):
            return fuller
        fit = fuller
        without = _without(fit, absent, again)
        if without is None:
            return fit
    _log.info("dropped: %s", ", ".join(absent.names))
    covariance = at_least(_given(fit, absent.names), without.covariance) + absent.spread
    errors = dict(zip(without.names, np.sqrt(np.diag(covariance)), strict=True))
    known = without.oscillator.parameters()
    wider = {n: replace(known[n], std=float(e)) for n, e in errors.items() if known[n].std is not None}
    return replace(
        without,
        oscillator=replace(without.oscillator.with_parameters(wider), hold=fit.oscillator.hold),
        covariance=covariance,
        notes=(*without.notes, _sentence(absent.names)),
    )


def _absent_from(fit: Fit) -> Absent | None:
    model, names = fit.oscillator, list(fit.names)
    values = np.array([model.parameters()[name].value for name in names])
    segments = [part.segment for part in fit.segments]
    everything = tuple(model.parameters())
    all_values = np.array(list(model.values().values()))
    sizes = typical_sizes(everything, all_values, displacement_amplitude(segments), segments[0].pace)
    return likely_absent(names, values, fit.covariance, sizes[[everything.index(name) for name in names]])


def _without(fit: Fit, absent: Absent, again: Callable[[Oscillator, Sequence[str]], Fit]) -> Fit | None:
    known = fit.oscillator.parameters()
    zero = {name: replace(known[name], value=0.0, std=None) for name in absent.names}
    try:
        return again(fit.oscillator.with_parameters(zero), absent.names)
    except BadInput:
        return None


def _given(fit: Fit, names: Sequence[str]) -> np.ndarray:
    """Covariance of the other parameters where those named are known: with all that the fit does not know beside them.

    What not knowing a hold adds is in it, and what predictions say otherwise.
    """
    gone = [fit.names.index(name) for name in names]
    kept = [i for i in range(len(fit.names)) if i not in gone]
    scale = np.sqrt(np.diag(fit.covariance))[gone]
    precision = np.linalg.pinv(fit.covariance[np.ix_(gone, gone)] / np.outer(scale, scale), hermitian=True)
    across = fit.covariance[np.ix_(kept, gone)] / scale
    return fit.covariance[np.ix_(kept, kept)] - across @ precision @ across.T


def at_least(covariance: np.ndarray, own: np.ndarray) -> np.ndarray:
    """A covariance whose variances are those of another where these are larger.

    What rounding does to a fit, which keeps step with the motion, may be more where fewer parameters take it.
    """
    least = np.sqrt(
        np.maximum(np.diag(own), np.diag(covariance)) / np.maximum(np.diag(covariance), np.finfo(float).tiny)
    )
    return covariance * np.outer(least, least)


def _sentence(names: Sequence[str]) -> str:
    are, them = ("are", "them") if names[1:] else ("is", "it")
    return f"{spoken(names)} {are} left at zero: the recordings do not tell {them} from none (--all keeps {them})"


def _left(fit: Fit) -> float:
    return max(part.over_noise for part in fit.segments)

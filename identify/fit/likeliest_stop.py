"""How many swings friction leaves of a decay: the fits of fewer and of more of them, and the errors of both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...errors import BadInput
from ...recording.recording import Recording
from ..signals.odds import SIGNIFICANT
from ..signals.registry import budget
from .likeliest_modes import odds
from .likelihood import maximum_likelihood
from .reported_result import Fit

_FAR = budget(12.0, "standard errors", why="of the friction: the next stops lie within, and what starts farther strays")


def likeliest_stop(fit: Fit, recordings: Sequence[Recording]) -> Fit:
    """The fit of decays, or that of another number of swings before friction stops them, where that is likelier.

    Each number of swings has a maximum of its own, and a search ends in the one next to its start. It begins again from
    either side, beyond what chance moves the friction by, the other parameters moved by what makes up for it. Of two
    maxima that are hardly told apart the errors hold both: they are those of a mixture of two normal distributions.

    Args:
        fit: as it would be the answer; returned as it is where it has no friction, or where a force holds the motion.
        recordings: that it was fitted to.
    """
    known = fit.oscillator.parameters()
    std = [known[name].std for name in fit.names]
    if "dry" not in fit.names or any(s is None or not np.isfinite(s) or s <= 0 for s in std):
        return fit
    if any(s.segment.force is not None for s in fit.segments):
        return fit
    place = fit.names.index("dry")
    swings = max(s.segment.n * s.segment.dt for s in fit.segments) * fit.oscillator.omega0.value / np.pi
    dry, error = fit.oscillator.dry.value, float(np.sqrt(fit.covariance[place, place]))
    # one swing more is a friction less by as many parts of it as there are swings
    if not _FAR * error * swings > dry > SIGNIFICANT * error:
        return fit
    along = fit.covariance[:, place] / np.sqrt(fit.covariance[place, place])
    fixed = [name for name in known if name not in fit.names]

    def from_there(errors: float) -> list[Fit]:
        steps = zip(fit.names, errors * along, strict=True)
        moved = {name: replace(known[name], value=known[name].value + float(by)) for name, by in steps}
        try:
            start = fit.oscillator.with_parameters(moved)
            return [maximum_likelihood(start, recordings, fixed, doubted=False, near=True)]
        except BadInput:
            return []

    found = [other for errors in (0.0, -_FAR / 2, _FAR / 2, -_FAR, _FAR) for other in from_there(errors)]
    if not found:
        return fit
    best = max(found, key=lambda other: odds(other, found[0]))
    if _apart(best, fit) and odds(best, found[0]) > 0.0:
        fit = maximum_likelihood(best.oscillator, recordings, fixed, near=True)
    rivals = [other for other in found if _apart(other, fit)]
    if not rivals:
        return fit
    return _with_rival(fit, max(rivals, key=lambda other: odds(other, best)), best)


def _apart(one: Fit, other: Fit) -> bool:
    """Whether two fits are of different stops: apart by more than the error of either in its own maximum."""
    mine, theirs = one.oscillator.dry, other.oscillator.dry
    return abs(mine.value - theirs.value) > SIGNIFICANT * min(mine.std or 0.0, theirs.std or 0.0)


def _with_rival(fit: Fit, rival: Fit, best: Fit) -> Fit:
    """The fit with the errors of a mixture: ``rival`` is that much less likely than ``best``."""
    from scipy.special import expit

    share = float(expit(odds(rival, best)))
    values, others = fit.oscillator.values(), rival.oscillator.values()
    off = np.array([others[name] - values[name] for name in fit.names])
    covariance = fit.covariance + share * (1.0 - share) * np.outer(off, off)
    known = fit.oscillator.parameters()
    errors = zip(fit.names, np.sqrt(np.diag(covariance)), strict=True)
    wider = {name: replace(known[name], std=float(error)) for name, error in errors}
    return replace(fit, oscillator=fit.oscillator.with_parameters(wider), covariance=covariance)

"""Whether the rig was changed between the training recordings and one held out, as the backbones of free motion say.

However its spring and friction run, a rig that is left to itself swings at one frequency for each amplitude; so the
backbones of two decays (FREEVIB, Feldman 1994) lie on one another, whatever the family of models lacks. Where they keep
apart throughout the amplitudes that both passed, no single model tells both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np

from ..errors import BadInput
from ..identify.faults.stranger_among import KEPT
from ..identify.signals.odds import BEYOND_ERRORS
from ..identify.signals.registry import numerics
from ..identify.start.start import Curve, hilbert_start
from ..recording.recording import Recording
from .limits import BOTH_FELL, ENDS_OF_BACKBONE
from .wording import figure

_LEVELS = numerics(32, "levels of amplitude", why="backbones are smooth: their comparison does not change with more")


def changed_rig(training: Sequence[Recording], holdout: Sequence[Recording]) -> str | None:
    """A sentence where a held-out decay swings at another frequency than each of the training at equal amplitudes.

    Args:
        training, holdout: recordings; those without free motion say nothing.
    """
    known = [(recording, curve) for recording in training for curve in _backbones(recording)]
    if _several([curve for _, curve in known]):
        return None
    for recording in holdout:
        backbones = _backbones(recording)
        if _several(backbones):
            continue
        for curve in backbones:
            both = [(other, levels, there) for other, there in known if (levels := _passed(curve, there)) is not None]
            if not both or not all(_apart(curve, there, levels) for _, levels, there in both):
                continue
            other, levels, there = both[0]
            middle = levels[levels.size // 2 :][:1]
            here, elsewhere = (figure(math.exp(_at(c, middle)[0][0]) / (2 * math.pi), 4) for c in (curve, there))
            return (
                f"{recording.name} swings at {here} Hz where {other.name} swings at {elsewhere} Hz, both at the same "
                "amplitude, and so apart at all that both passed: they are of two rigs, or the rig was changed "
                "between, and no model tells both"
            )
    return None


def _several(curves: Sequence[Curve]) -> bool:
    """Whether curves of one side keep apart themselves: then no amplitude has a frequency, whatever was changed."""
    pairs = ((one, other, _passed(one, other)) for one, other in combinations(curves, 2))
    return any(levels is not None and _apart(one, other, levels) for one, other, levels in pairs)


def _backbones(recording: Recording) -> list[Curve]:
    """Of each decay in a recording."""
    try:
        return [curve for curve in hilbert_start([recording]).curves if curve.method == "freevib"]
    except BadInput:  # it does not oscillate
        return []


def _passed(one: Curve, other: Curve) -> np.ndarray | None:
    """Levels (n,) of amplitude that both curves passed; None where that is too little to compare."""
    low = math.log(max(float(np.min(curve.amplitude)) for curve in (one, other)))
    high = math.log(min(float(np.max(curve.amplitude)) for curve in (one, other)))
    if high - low < math.log(BOTH_FELL):
        return None
    rim = ENDS_OF_BACKBONE * (high - low)
    return np.exp(np.linspace(low + rim, high - rim, _LEVELS))


def _apart(one: Curve, other: Curve, levels: np.ndarray) -> bool:
    """Whether one swings faster than the other by more than a lab cannot keep, at all levels where that can be seen.

    It can be seen beyond the curves' errors, which grow as the motion dies away: at half the levels or more.
    """
    (here, error), (there, error_there) = _at(one, levels), _at(other, levels)
    difference, errors = here - there, np.hypot(error, error_there)
    usual = float(np.median(difference[errors <= np.median(errors)]))
    seen = errors * BEYOND_ERRORS < abs(usual)
    return bool(2 * np.sum(seen) >= levels.size and np.all(np.sign(usual) * difference[seen] > KEPT))


def _at(curve: Curve, levels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Logarithm of the frequency in rad/s at levels (n,) of amplitude, and its standard error."""
    order = np.argsort(curve.amplitude)
    amplitude, error = np.log(curve.amplitude[order]), (curve.omega0_std / curve.omega0)[order]
    frequency, at = np.log(curve.omega0[order]), np.log(levels)
    return np.interp(at, amplitude, frequency), np.interp(at, amplitude, error)

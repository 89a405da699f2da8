"""The step of the converter that digitised a signal."""

from __future__ import annotations

import numpy as np

#: Values closer than this part of the range are one level, printed or converted differently.
_SAME = 1e-9
#: Levels lie on a lattice where each gap is a multiple of the smallest to within this part of it.
_OFF_LATTICE = 0.05
#: A signal of fewer levels switches between them of its own.
_FEWEST_LEVELS = 12
#: An encoder whose zero was set anew shows two lattices: this part of the steps at most leads from one to the other.
_ACROSS = 0.01


def converter_step(signal: np.ndarray) -> float:
    """Step of the levels that a signal (n,) takes, in its unit; 0 where its values lie on no lattice.

    A quantised signal errs by up to half a step: step/sqrt(12) in the mean over many levels (Widrow and Kollar 2008).
    """
    values = np.unique(signal)
    least = _SAME * float(values[-1] - values[0]) if values.size else 0.0
    gaps = _apart(values, least)
    if gaps.size < _FEWEST_LEVELS - 1:
        return 0.0
    return _spacing(gaps) or _step_from_sample_to_sample(signal, least)


def rounding_noise(signal: np.ndarray) -> float:
    """Standard deviation of what a signal (n,) errs by as its converter rounds it; 0 where none is told."""
    return converter_step(signal) / np.sqrt(12)


def _step_from_sample_to_sample(signal: np.ndarray, least: float) -> float:
    """Spacing of a lattice on which nearly all steps lie, where the values lie on two, one beside the other."""
    steps = np.abs(np.diff(signal))
    steps = np.where(steps > least, steps, 0.0)
    sizes, counts = np.unique(np.round(steps / least) * least, return_counts=True)
    often = sizes[counts > _ACROSS * steps.size]
    if often.size < 2 or not (spacing := _spacing(_apart(often, least))):
        return 0.0
    multiples = steps / spacing
    off = np.abs(multiples - np.round(multiples)) > _OFF_LATTICE
    return spacing if np.mean(off) <= _ACROSS else 0.0


def _apart(values: np.ndarray, least: float) -> np.ndarray:
    """The gaps between sorted values, but for those that are one level, printed or converted differently."""
    gaps = np.diff(values)
    return gaps[gaps > least]


def _spacing(gaps: np.ndarray) -> float:
    """Of which all gaps are multiples; 0 where there is no such, or no gap."""
    if not gaps.size:
        return 0.0
    multiples = gaps / np.min(gaps)
    if np.max(np.abs(multiples - np.round(multiples))) > _OFF_LATTICE:
        return 0.0
    return float(np.sum(gaps) / np.sum(np.round(multiples)))

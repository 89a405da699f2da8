"""The step of the converter that digitised a signal."""

from __future__ import annotations

import numpy as np

#: Values closer than this part of the range are one level, printed or converted differently.
_SAME = 1e-9
#: Levels lie on a lattice where each gap is a multiple of the smallest to within this part of it.
_OFF_LATTICE = 0.05
#: A signal of fewer levels switches between them of its own.
_FEWEST_LEVELS = 12


def converter_step(signal: np.ndarray) -> float:
    """Step of the levels that a signal (n,) takes, in its unit; 0 where its values lie on no lattice.

    A quantised signal errs by up to half a step: step/sqrt(12) in the mean over many levels (Widrow and Kollar 2008).
    """
    values = np.unique(signal)
    gaps = np.diff(values)
    gaps = gaps[gaps > _SAME * float(values[-1] - values[0])] if gaps.size else gaps
    if gaps.size < _FEWEST_LEVELS - 1:
        return 0.0
    multiples = gaps / np.min(gaps)
    if np.max(np.abs(multiples - np.round(multiples))) > _OFF_LATTICE:
        return 0.0
    return float(np.sum(gaps) / np.sum(np.round(multiples)))

"""Numbers that no sensor gives: beyond all measuring, or alone so far above all others that no converter shows both."""

from __future__ import annotations

import numpy as np

#: In whatever unit: squares and fourth powers of it are still numbers.
_LARGEST = 1e30
#: A converter of 24 bits tells so many levels apart; spikes of so few samples are no motion.
_LEVELS, _LONE = 2.0**24, 3


def impossible(signal: np.ndarray) -> tuple[int, str] | None:
    """Index of a value that cannot have been measured, and why in words; None where there is none.

    Args:
        signal: (n,), finite.
    """
    size = np.abs(signal)
    at = int(np.argmax(size))
    if size[at] > _LARGEST:
        return at, f"which no sensor gives (more than {_LARGEST:g})"
    if size.size > 10 * _LONE:
        others = float(np.partition(size, -1 - _LONE)[-1 - _LONE])
        if 0.0 < others * _LEVELS < size[at]:
            return at, f"{size[at] / others:.1g} times all but {_LONE} others, which no converter shows at once"
    return None

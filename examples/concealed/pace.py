"""How long the rest of a run takes, from what was done: with the error of that, never a figure without it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

FEWEST = 4  # done, before their spread says anything


def remaining(seconds: Sequence[float], left: int, jobs: int) -> str:
    """Say what is left, in words: `seconds` each that are done took, `left` are to do, `jobs` at a time.

    The range is that of the sum of so many more, two standard deviations, as far as those done show it.
    """
    if not left:
        return "none left"
    if len(seconds) < FEWEST:
        return f"{left} left"
    mean, spread = float(np.mean(seconds)), float(np.std(seconds, ddof=1))
    error = 2 * spread * np.sqrt(left + left**2 / len(seconds))
    low, high = (max(total, 0.0) / jobs / 60 for total in (mean * left - error, mean * left + error))
    return f"{left} left, about {mean * left / jobs / 60:.0f} min ({low:.0f} to {high:.0f})"

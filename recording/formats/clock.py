"""Times of day as loggers write them, with or without a date: 2021-05-07 11:02:42.10, 5/7/2021 11:02:42, 2:42:07 PM."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

_DAY = 86400.0
_STAMP = re.compile(
    r"(?:\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}[T\s]\s*)?(\d{1,2}):(\d{2}):(\d{2}(?:[.,]\d*)?)\s*([AaPp][Mm])?"
    r"\s*(?:Z|UTC|[+-]\d{2}:?\d{2})?"
)


def seconds_of(cells: Sequence[str]) -> np.ndarray | None:
    """(n,) seconds since the midnight before the first stamp; None where a cell is no time of day.

    The date is not read: writers differ in its order, and no step of a recorder is half a day long. Where the time
    goes back by more than that, it is the next day.
    """
    found = [_STAMP.fullmatch(cell.strip()) for cell in cells]
    times = []
    for match in found:
        if match is None:
            return None
        hours, minutes, seconds = int(match[1]), int(match[2]), float(match[3].replace(",", "."))
        if match[4]:
            hours = hours % 12 + (12 if match[4].lower() == "pm" else 0)
        if hours > 23 or minutes > 59 or seconds >= 61:
            return None
        times.append(3600.0 * hours + 60.0 * minutes + seconds)
    made = np.array(times)
    return made + _DAY * np.concatenate([[0], np.cumsum(np.diff(made) < -0.5 * _DAY)])

"""A sampling frequency as a person says it: 1000, "1000 Hz", "1 kHz"."""

from __future__ import annotations

import re
from typing import Any

from ..errors import BadInput
from ..files.arguments import number_of, shown

_HERTZ = {"": 1.0, "hz": 1.0, "khz": 1e3, "mhz": 1e6}
_SAID = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-z]*)\s*")


def frequency_of(given: Any, what: str = "fs") -> float:
    """Hz of a number, or of a text with Hz, kHz or MHz behind it or nothing; raises BadInput for anything else."""
    if not isinstance(given, str):
        return number_of(given, what)
    said = _SAID.fullmatch(given)
    factor = _HERTZ.get(said[2].lower()) if said else None
    if said is None or factor is None or said[2] in ("mHz", "mhz"):
        raise BadInput(f"{what} {shown(given)} is not understood; give a number of Hz, or a text such as '1 kHz'")
    return float(said[1]) * factor

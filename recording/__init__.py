"""Reading and checking measured signals."""

from __future__ import annotations

from .checks import Problem, check
from .given import Reading, recordings_of
from .read import from_data, read, read_records
from .recording import Recording, from_sep5

__all__ = [
    "Problem",
    "Reading",
    "Recording",
    "check",
    "from_data",
    "from_sep5",
    "read",
    "read_records",
    "recordings_of",
]

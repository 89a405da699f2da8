"""What every reader of a format returns: named columns whose numbers are read when they are asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Table:
    """The columns of one record of a file.

    `names` and `units` have one entry a column, "" where the file says nothing. `numbers(indices)` returns a float
    array (rows, len(indices)) and raises BadInput where a cell is no number. `fs` is the rate in Hz if the file's
    format states one; `record` is its name where the file holds several, and then a part of `where`; `notes` are
    sentences on what was left out, and `others` name, unit and samples of each channel of another length, which was.
    """

    where: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    numbers: Callable[[Sequence[int]], np.ndarray]
    fs: float | None = None
    record: str = ""
    notes: tuple[str, ...] = ()
    others: tuple[tuple[str, str, int], ...] = ()

    @property
    def has_header(self) -> bool:
        """Whether any column has a name."""
        return any(self.names)

    def label(self, index: int) -> str:
        """Return what a message calls this column: its name, or its number from 1."""
        return f"'{self.names[index]}'" if self.names[index] else f"number {index + 1}"

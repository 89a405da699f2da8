"""How long a diagnosis may take, and which part of that each step has."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field

from ..identify.signals.registry import budget, shown
from .case import Progress

_SEARCHING = budget(0.5, "part of the time", why="the rest fits finely, runs the FMU, rehearses experiments and draws")
_CHECKING = budget(
    0.65, "part of the time", why="after which rivals are fitted no farther and the hold is not asked anew"
)

SEARCHED = shown(0.65, "part of all", why="that is done once the search is: of ten diagnoses 52 to 83 % of their work")
REFITTED = shown(0.68, "part of all", why="that is done once rivals are fitted as finely")
DELIVERED = shown(0.71, "part of all", why="that is done once the standard errors are known")
TRIED = shown(0.74, "part of all", why="that is done once the FMU was run; rehearsed experiments take most of the rest")
#: The same where nothing was found to be missing: no rivals, no place, and no experiment that would tell them apart.
_OF_NOTHING = shown(
    {SEARCHED: 0.82, REFITTED: 0.88, DELIVERED: 0.93, TRIED: 0.98}, "part of all", why="that is done where nothing is"
)


def part_at(step: float, found: bool) -> float:
    """The part of all that is done at a step (``SEARCHED`` to ``TRIED``), for the laws that were ``found`` or none."""
    return step if found else _OF_NOTHING[step]


@dataclass(frozen=True)
class TimeAllowed:
    """What a diagnosis may take, from now on.

    Attributes:
        seconds: in all.
        begun: on the monotonic clock, s.
    """

    seconds: float = math.inf
    begun: float = field(default_factory=time.monotonic)

    @property
    def search_until(self) -> float:
        """Until when on the monotonic clock the library is searched, s."""
        return self.begun + _SEARCHING * self.seconds

    @property
    def searching(self) -> bool:
        """Whether the search has time left."""
        return time.monotonic() < self.search_until

    def forward(self, progress: Progress) -> Progress:
        """The same progress, which never goes back, and a search that goes on to its end has its part of the time.

        What a search has done of what it is at says nothing of what will be asked next: its time is what is known.
        """
        reached = 0.0

        def said(what: str, part: float) -> None:
            nonlocal reached
            timed = (time.monotonic() - self.begun) / (_SEARCHING * self.seconds)
            if self.seconds < math.inf and part < SEARCHED:
                part = min(timed, 1.0) * SEARCHED
            reached = max(reached, part)
            progress(what, reached)

        return said

    @property
    def checking(self) -> bool:
        """Whether there is time to ask of what was found what it could do without."""
        return time.monotonic() < self.begun + _CHECKING * self.seconds

"""How much work a command did: simulated over recorded samples, a figure that no load of the machine changes.

All runs of the compiled core in this process are counted, whichever thread they run in, so that of two commands at once
in one process each counts the other's too.
"""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """What was done for some recordings.

    Attributes:
        recorded: samples of the recordings.
        simulated: samples that the core has made.
        with_derivatives: those of them with derivatives that went along; a run with eight costs two to four plain ones.
        fits: searches that were begun.
        simulating, seconds: processor seconds in the core, and in all.
    """

    recorded: int
    simulated: int
    with_derivatives: int
    fits: int
    simulating: float
    seconds: float

    @property
    def times(self) -> float:
        """How many times the recordings were simulated."""
        return self.simulated / max(self.recorded, 1)

    def __str__(self) -> str:
        """As the last line of ``--verbose`` says it."""
        return (
            f"work: {self.times:.0f} times the recordings, {self.simulated / 1e6:.3g} M samples "
            f"({self.with_derivatives / max(self.recorded, 1):.0f} times with derivatives), {self.fits} fits, "
            f"{self.seconds:.1f} s of which {self.simulating:.1f} s simulating"
        )

    def as_json(self) -> dict[str, float]:
        """As ``diagnosis.json`` has it."""
        return {
            "times_the_recordings": self.times,
            "recorded_samples": self.recorded,
            "simulated_samples": self.simulated,
            "with_derivatives": self.with_derivatives,
            "fits": self.fits,
            "seconds_simulating": self.simulating,
            "seconds": self.seconds,
        }


class _Total:
    """What this process has done so far."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.simulated = self.with_derivatives = self.fits = 0
        self.simulating = 0.0

    def run(self, samples: int, derivatives: int, seconds: float) -> None:
        """Count a run of the core."""
        with self._lock:
            self.simulated += samples
            self.with_derivatives += samples if derivatives else 0
            self.simulating += seconds

    def fit(self) -> None:
        """Count a search."""
        with self._lock:
            self.fits += 1

    def now(self) -> tuple[int, int, int, float]:
        """All of it together, as it stands."""
        with self._lock:
            return self.simulated, self.with_derivatives, self.fits, self.simulating


TOTAL = _Total()


class Meter:
    """Counts from where it is made."""

    def __init__(self) -> None:
        self._began = (*TOTAL.now(), time.process_time())

    def read(self, recorded: int) -> Work:
        """What was done since, for recordings of so many samples."""
        now = (*TOTAL.now(), time.process_time())
        simulated, carried, fits, simulating, seconds = (b - a for a, b in zip(self._began, now, strict=True))
        return Work(recorded, int(simulated), int(carried), int(fits), float(simulating), float(seconds))

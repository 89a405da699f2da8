"""How long a work goes on, from the part of it that is done."""

from __future__ import annotations

from dataclasses import dataclass

#: A part that was reached after less says more of what a machine does first than of what it does at all.
_LEAST_PART, _LEAST_SECONDS = 0.05, 5.0


@dataclass(frozen=True)
class Reached:
    """A part of a work that was done when it had gone on for so many seconds."""

    part: float
    seconds: float

    def to_go(self, now: float) -> float | None:
        """Seconds to go after ``now`` seconds; None where too little is done to say.

        What is left runs as fast as what was done. A step that takes longer than that leaves half of what it would be
        if nothing had been done since: the time to go falls, and does not come to nothing before the work ends.
        """
        if self.part < _LEAST_PART or self.seconds < _LEAST_SECONDS:
            return None
        whole = 1.0 / self.part - 1.0
        return max(self.seconds * (1.0 + whole) - now, 0.5 * now * whole)


def in_words(seconds: float | None) -> str:
    """``about 40 s to go``, to one digit, for it is no surer than by a factor of two; empty where it is not known."""
    if seconds is None:
        return ""
    if seconds < 60.0:
        return f"about {max(1.0, float(f'{seconds:.1g}')):.0f} s to go"
    return f"about {float(f'{seconds / 60.0:.1g}'):.0f} min to go"

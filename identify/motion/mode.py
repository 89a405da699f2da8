"""One mode of a recording: what is listed of it, with errors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from .limits import SAME_MODE


@dataclass(frozen=True)
class Mode:
    """One mode of a recording.

    Attributes:
        frequency: Hz, undamped; of a spectral line where it rings the loudest.
        low, high: Hz, between which its frequency moves with its amplitude.
        share: of the motion's power.
        strongest: whether it moves most.
        damping_ratio: of its critical damping; None of a spectral line.
        errors: standard errors of frequency, damping ratio and share; None of a spectral line.
    """

    frequency: float
    low: float
    high: float
    share: float
    strongest: bool = False
    damping_ratio: float | None = None
    errors: tuple[float, float, float] | None = None

    def is_at(self, frequency: float) -> bool:
        """Whether a frequency in Hz is this mode's, within what it moves and a little."""
        return self.low / SAME_MODE <= frequency <= self.high * SAME_MODE

    def __str__(self) -> str:
        """As it is listed."""
        if self.damping_ratio is None or self.errors is None:
            share = float(f"{100 * self.share:.2g}")  # all of it is 100 %, not 1e+02 %
            return f"{self.frequency:.4g} Hz ({share:g} %)"
        frequency, ratio, share = self.errors
        return (
            f"{_known(self.frequency, frequency)} Hz (damping ratio {_known(self.damping_ratio, ratio)}, "
            f"{_known(100 * self.share, 100 * share)} % of the power)"
        )

    @staticmethod
    def of_json(numbers: Mapping[str, float]) -> Mode:
        """The mode of numbers as ``as_json`` gives them."""
        at, names = numbers["frequency_hz"], ("frequency_hz_std", "damping_ratio_std", "share_std")
        frequency, ratio, share = (numbers.get(name, 0.0) for name in names)
        errors = (frequency, ratio, share) if names[0] in numbers else None
        return Mode(at, at, at, numbers["share"], damping_ratio=numbers.get("damping_ratio"), errors=errors)

    def as_json(self) -> dict[str, float]:
        """Its numbers by name, those that are known."""
        numbers = {"frequency_hz": self.frequency, "share": self.share}
        if self.damping_ratio is not None and self.errors is not None:
            numbers |= {"damping_ratio": self.damping_ratio}
            numbers |= dict(zip(("frequency_hz_std", "damping_ratio_std", "share_std"), self.errors, strict=True))
        return numbers


def _known(value: float, error: float) -> str:
    """A value with as many decimals as its error has."""
    if not (math.isfinite(error) and error > 0):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{decimals}f} ± {error:.{decimals}f}"

"""What sentences are made of: numbers of few digits with a fitting unit, lists, effects in the words of the field."""

from __future__ import annotations

from collections.abc import Sequence

from ..files.spoken import spoken
from ..identify.signals.registry import shown
from ..model.effect_words import effect_in_words

_PREFIXES = shown(
    ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")),
    "prefixes of units",
    why="those that an engineer reads without thought",
)


def figure(value: float, digits: int = 3) -> str:
    """A value to so many digits, written out from a ten-thousandth on: ``270`` and not ``2.7e+02``."""
    return f"{float(f'{value:.{digits}g}'):.12g}"


def quantity(value: float, unit: str) -> str:
    """A value with its unit, in thousandths where that reads better: ``4.1 mm``."""
    if unit in ("m", "m/s", "N"):
        for size, prefix in _PREFIXES:
            if abs(value) >= size / 2:
                return f"{figure(value / size)} {prefix}{unit}"
    return f"{figure(value)} {unit}"


def effects_in_words(names: Sequence[str], last: str = "and") -> str:
    """Effects as an engineer says them, each with its law's name: ``a stop on one side (one-sided-stop)``."""
    return spoken([effect_in_words(name) for name in names], last)

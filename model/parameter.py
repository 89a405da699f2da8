"""One identified number: value, standard error, unit."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """A value with its standard error (None where it was given, not measured) and its unit."""

    value: float
    std: float | None = None
    unit: str = "1"

    def __str__(self) -> str:
        """Value ± error with as many digits as the error carries."""
        error = "" if self.std is None else f" ± {self.std:.2g}"
        return f"{self.value:.6g}{error} {self.unit}"

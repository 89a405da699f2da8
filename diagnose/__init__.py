"""Model against recordings: is there a mismatch, where, what physics, the mended model, the next experiment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .diagnosis import diagnose
    from .result import Diagnosis

__all__ = ["Diagnosis", "diagnose"]


def __getattr__(name: str) -> Any:
    """The face of the folder, loaded when first asked for (scipy and casadi are slow to import)."""
    if name == "diagnose":
        from .diagnosis import diagnose

        return diagnose
    if name == "Diagnosis":
        from .result import Diagnosis

        return Diagnosis
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

"""Recordings to model: free motion, start values, FREEVIB and FORCEVIB, maximum likelihood, uncertainty."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .hilbert.hilbert_result import HilbertAnalysis, hilbert_analysis
    from .identification import Identification, identify

__all__ = ["HilbertAnalysis", "Identification", "hilbert_analysis", "identify"]
_OF_HILBERT = ("HilbertAnalysis", "hilbert_analysis")


def __getattr__(name: str) -> Any:
    """The face of the folder, loaded when first asked for (scipy and casadi are slow to import)."""
    if name in __all__:
        from . import identification
        from .hilbert import hilbert_result

        return getattr(hilbert_result if name in _OF_HILBERT else identification, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

"""Model to FMU and CasADi functions; the proof that the artefact reproduces the recordings."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput

if TYPE_CHECKING:
    from ..model import Oscillator

__all__ = ["check_suffix", "export"]


def check_suffix(path: Path) -> None:
    """Make sure that the suffix says what to make. Raises BadInput where it does not."""
    if Path(path).suffix not in (".fmu", ".casadi"):
        raise BadInput(
            f"{path}: cannot tell what to make from the suffix {Path(path).suffix!r}; known are .fmu and .casadi"
        )


def export(oscillator: Oscillator, path: Path, *, backend: str = "native", step: float = 1e-3) -> tuple[Path, ...]:
    """Write the model in the form that the suffix of ``path`` names: ``.fmu`` or ``.casadi``.

    Args:
        oscillator: the model.
        path: where to; for ``.casadi`` further files are written beside it.
        backend: of an FMU: ``native`` (compiled) or ``python`` (PythonFMU; its host needs Python and casadi).
        step: sample time of the discrete CasADi step, s.

    Returns:
        The paths written.

    Raises:
        BadInput: for an unknown suffix, or where the file cannot be written.
        ToolchainMissing: for a native FMU without a C compiler.
    """
    path = Path(path)
    check_suffix(path)
    if path.suffix == ".fmu":
        from .fmu import export_fmu

        return (export_fmu(oscillator, path, backend=backend),)
    from .casadi_functions import export_casadi

    return export_casadi(oscillator, path, dt=step)

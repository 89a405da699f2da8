"""Model to FMU and CasADi functions; the proof that the artefact reproduces the recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput

if TYPE_CHECKING:
    from ..model import Oscillator
    from .platforms import Platform

__all__ = ["check_suffix", "export"]


def check_suffix(path: Path) -> None:
    """Make sure that the suffix says what to make. Raises BadInput where it does not."""
    if Path(path).suffix not in (".fmu", ".casadi"):
        raise BadInput(
            f"{path}: cannot tell what to make from the suffix {Path(path).suffix!r}; known are .fmu and .casadi"
        )


def export(
    oscillator: Oscillator,
    path: Path,
    *,
    backend: str | None = None,
    platforms: Sequence[Platform] | None = None,
    step: float = 1e-3,
    progress: Callable[[str], None] | None = None,
) -> tuple[Path, ...]:
    """Write the model in the form that the suffix of ``path`` names: ``.fmu`` or ``.casadi``.

    Args:
        oscillator: the model.
        path: where to; for ``.casadi`` further files are written beside it.
        backend: of an FMU: ``native`` (compiled) or ``python`` (PythonFMU; its host needs Python and casadi); left out,
            native wherever there is a compiler.
        platforms: what to compile an FMU for (``platforms.parse_platforms``); left out, all that can be built for here.
        step: sample time of the discrete CasADi step, s.
        progress: called with one line before what takes long, and with what an FMU runs on.

    Returns:
        The paths written.

    Raises:
        BadInput: for an unknown suffix, or where the file cannot be written.
        ToolchainMissing: where the compiler for a native FMU or one of the platforms is missing or fails.
    """
    path = Path(path)
    check_suffix(path)
    if path.suffix == ".fmu":
        from .fmu import export_fmu

        return (export_fmu(oscillator, path, backend=backend, platforms=platforms, progress=progress),)
    from .casadi_functions import export_casadi

    return export_casadi(oscillator, path, dt=step)

"""Model to FMU, SSP, plain C and CasADi functions; the proof that the artefact reproduces the recordings."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput

if TYPE_CHECKING:
    from ..model import Oscillator

__all__ = ["SUFFIXES", "check_suffix", "export"]

#: What a model can be made into.
SUFFIXES = (".fmu", ".casadi", ".c", ".ssp")


def check_suffix(path: Path) -> None:
    """Make sure that the suffix says what to make. Raises BadInput where it does not."""
    if Path(path).suffix not in SUFFIXES:
        known = f"{', '.join(SUFFIXES[:-1])} and {SUFFIXES[-1]}"
        raise BadInput(f"{path}: cannot tell what to make from the suffix {Path(path).suffix!r}; known are {known}")


def export(
    oscillator: Oscillator,
    path: Path,
    *,
    backend: str = "native",
    step: float = 1e-3,
    draws: int | None = None,
    seed: int = 0,
) -> tuple[Path, ...]:
    """Write the model in the form that the suffix of ``path`` names: ``.fmu``, ``.casadi``, ``.c`` or ``.ssp``.

    Args:
        oscillator: the model.
        path: where to; for ``.casadi`` and ``.c`` further files are written beside it.
        backend: of an FMU: ``native`` (compiled) or ``python`` (PythonFMU; its host needs Python and casadi).
        step: sample time of the discrete CasADi step, s.
        draws: of an SSP: sets of parameters drawn from the covariance; None: 20, or none without a covariance.
        seed: of the draws.

    Returns:
        The paths written.

    Raises:
        BadInput: for an unknown suffix, where the file cannot be written, or where nothing can be drawn.
        ToolchainMissing: for a native FMU without a C compiler.
    """
    path = Path(path)
    check_suffix(path)
    if path.suffix == ".fmu":
        from .fmu import export_fmu

        return (export_fmu(oscillator, path, backend=backend),)
    if path.suffix == ".ssp":
        from .ssp import export_ssp

        return (export_ssp(oscillator, path, draws=draws, seed=seed, backend=backend),)
    if path.suffix == ".c":
        from .plain_c import export_plain_c

        return export_plain_c(oscillator, path)
    from .casadi_functions import export_casadi

    return export_casadi(oscillator, path, dt=step)

"""Model to FMU, SSP, plain C and CasADi functions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..callable_module import callable_as_its_name
from ..errors import BadInput

if TYPE_CHECKING:
    from ..model import Oscillator
    from .platforms import Platform

__all__ = ["SUFFIXES", "check_suffix", "export", "files"]
callable_as_its_name(__name__)  # dashpot.export(...)

#: What a model can be made into.
SUFFIXES = (".fmu", ".casadi", ".c", ".ssp")


def check_suffix(path: Path) -> None:
    """Make sure that the suffix says what to make. Raises BadInput where it does not."""
    if Path(path).suffix not in SUFFIXES:
        known = f"{', '.join(SUFFIXES[:-1])} and {SUFFIXES[-1]}"
        raise BadInput(f"{path}: cannot tell what to make from the suffix {Path(path).suffix!r}; known are {known}")


def files(path: Path) -> tuple[Path, ...]:
    """All files that ``export`` writes for ``path``: itself, and what goes beside it.

    Raises:
        BadInput: for an unknown suffix, or where one of them that is not plainly meant to be replaced is there and was
            not made by dashpot: a file beside ``path``, or a C source.
    """
    from ..writing import check_ours

    path = Path(path)
    check_suffix(path)
    if path.suffix == ".c":
        both = path, path.with_suffix(".h")
        for place in both:
            check_ours(place, b"made by dashpot")
        return both
    if path.suffix == ".casadi":
        from .casadi_functions import DESCRIPTION, FUNCTIONS
        from .step_c import HEADER, SOURCE

        marks = {DESCRIPTION: b'"dashpot-casadi/', SOURCE: b"made by dashpot", HEADER: b"made by dashpot"}
        beside = []
        for end in (*FUNCTIONS[1:], SOURCE, HEADER, DESCRIPTION):
            beside.append(path.with_name(f"{path.name.removesuffix('.casadi')}.{end}"))
            check_ours(beside[-1], marks.get(end, b"jhpnnagiieah"))  # that is CasADi's own
        return path, *beside
    return (path,)


def export(
    oscillator: Oscillator,
    path: Path,
    *,
    version: int = 2,
    backend: str | None = None,
    platforms: Sequence[Platform] | None = None,
    step: float = 1e-3,
    draws: int | None = None,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> tuple[Path, ...]:
    """Write the model in the form that the suffix of ``path`` names: ``.fmu``, ``.casadi``, ``.c`` or ``.ssp``.

    Args:
        oscillator: the model.
        path: where to; for ``.casadi`` and ``.c`` further files are written beside it.
        version: of FMI, 2 or 3.
        backend: of an FMU: ``native`` (compiled) or ``python`` (PythonFMU; its host needs Python and casadi); left out,
            native wherever there is a compiler.
        platforms: what to compile an FMU for (``platforms.parse_platforms``); left out, all that can be built for here.
        step: sample time of the discrete CasADi step, s.
        draws: of an SSP: sets of parameters drawn from the covariance; None: 20, or none without a covariance.
        seed: of the draws.
        progress: called with one line before what takes long, and with what an FMU runs on.

    Returns:
        The paths written.

    Raises:
        BadInput: for an unknown suffix, where the file cannot be written, or where nothing can be drawn.
        ToolchainMissing: where the compiler for a native FMU or one of the platforms is missing or fails.
    """
    path = Path(path)
    files(path)
    how: dict[str, Any] = {"backend": backend, "platforms": platforms, "progress": progress}
    if path.suffix == ".fmu":
        from .fmu import export_fmu

        return (export_fmu(oscillator, path, version=version, **how),)
    if path.suffix == ".ssp":
        from .ssp import export_ssp

        if version != 2:
            raise BadInput(f"{path}: SSP 1.0 is for FMUs of FMI 2; leave out --fmi {version}")
        return (export_ssp(oscillator, path, draws=draws, seed=seed, **how),)
    if path.suffix == ".c":
        from .plain_c import export_plain_c

        return export_plain_c(oscillator, path)
    from .casadi_functions import export_casadi

    return export_casadi(oscillator, path, dt=step)

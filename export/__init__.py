"""Model to FMU, SSP, plain C, CasADi functions, and joints of other programs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput

if TYPE_CHECKING:
    from ..model import Oscillator
    from ..model.element import Element
    from .facts import Facts
    from .platforms import Platform

__all__ = ["ELEMENT_SUFFIXES", "SUFFIXES", "check_suffix", "element_files", "export", "export_element", "files"]
#: What a model can be made into: program text, and the last three for MuJoCo, URDF and HydroDyn.
PROGRAMS = (".py", ".mo", ".m")
SUFFIXES = (".fmu", ".casadi", ".c", *PROGRAMS, ".ssp", ".mjcf", ".urdf", ".hydrodyn")


def check_suffix(path: Path, form: str | None = None) -> str:
    """The suffix that says what to make: ``form`` (``mujoco``, ``urdf``, ``hydrodyn``) in place of the name's own.

    Raises BadInput where neither says it.
    """
    from .joint_files import SUFFIX_OF

    if form is not None:
        if form not in SUFFIX_OF:
            raise BadInput(f"{path}: cannot make {form!r} of a model; known are {', '.join(SUFFIX_OF)}")
        return SUFFIX_OF[form]
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        known = f"{', '.join(SUFFIXES[:-1])} and {SUFFIXES[-1]}"
        raise BadInput(
            f"{path}: cannot tell what to make from the suffix {suffix!r}; known are {known}, and with "
            f"--as {', '.join(SUFFIX_OF)} any other"
        )
    return suffix


def files(path: Path, form: str | None = None) -> tuple[Path, ...]:
    """All files that ``export`` writes for ``path``: itself, and what goes beside it.

    Raises:
        BadInput: for an unknown suffix, or where one of them that is not plainly meant to be replaced is there and was
            not made by dashpot: a file beside ``path``, a C source, or a model of another program.
    """
    from ..files.writing import check_ours

    path = Path(path)
    suffix = check_suffix(path, form)
    if suffix in (".mjcf", ".urdf", ".hydrodyn", *PROGRAMS):
        check_ours(path, b"made by dashpot")
    if suffix == ".c":
        return _c_files(path)
    if suffix == ".casadi":
        from .casadi_functions import DESCRIPTION, FUNCTIONS
        from .step_c import HEADER, SOURCE

        marks = {DESCRIPTION: b'"dashpot-casadi/', SOURCE: b"made by dashpot", HEADER: b"made by dashpot"}
        beside = []
        for end in (*FUNCTIONS[1:], SOURCE, HEADER, DESCRIPTION):
            beside.append(path.with_name(f"{path.name.removesuffix('.casadi')}.{end}"))
            check_ours(beside[-1], marks.get(end, b"jhpnnagiieah"))  # that is CasADi's own
        return path, *beside
    return (path,)


def _c_files(path: Path) -> tuple[Path, Path]:
    """Source and header of plain C; raises BadInput where one of them is there and was not made by dashpot."""
    from ..files.writing import check_ours

    both = path, path.with_suffix(".h")
    for place in both:
        check_ours(place, b"made by dashpot")
    return both


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
    form: str | None = None,
    dof: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[Path, ...]:
    """Write the model in the form that the suffix of ``path`` names, one of SUFFIXES, or that ``form`` does.

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
        form: ``mujoco``, ``urdf`` or ``hydrodyn``, whatever the file's name is; what these cannot express is said.
        dof: for HydroDyn, the platform's motion that the model is of, ``surge`` to ``yaw``.
        progress: called with one line before what takes long, and with what an FMU runs on.

    Returns:
        The paths written.

    Raises:
        BadInput: for an unknown suffix, where the file cannot be written, or where nothing can be drawn.
        ToolchainMissing: where the compiler for a native FMU or one of the platforms is missing or fails.
    """
    path = Path(path)
    files(path, form)
    suffix = check_suffix(path, form)
    how: dict[str, Any] = {"backend": backend, "platforms": platforms, "progress": progress}
    if suffix == ".fmu":
        from .fmu import export_fmu

        return (export_fmu(oscillator, path, version=version, **how),)
    if suffix == ".ssp":
        from .ssp import export_ssp

        if version != 2:
            raise BadInput(f"{path}: SSP 1.0 is for FMUs of FMI 2; leave out --fmi {version}")
        return (export_ssp(oscillator, path, draws=draws, seed=seed, **how),)
    if suffix == ".c":
        from .plain_c import export_plain_c

        return export_plain_c(oscillator, path)
    if suffix in PROGRAMS:
        from .facts import Facts

        return (_program_exports()[suffix](Facts(oscillator), path),)
    if suffix != ".casadi":
        from .joint_files import export_joint

        return (export_joint(oscillator, path, suffix, dof=dof, progress=progress),)
    from .casadi_functions import export_casadi

    return export_casadi(oscillator, path, dt=step)


def _program_exports() -> dict[str, Callable[[Facts, Path], Path]]:
    """What writes the model as program text, by suffix."""
    from .matlab import export_matlab
    from .modelica import export_modelica
    from .python_source import export_python

    return {".py": export_python, ".mo": export_modelica, ".m": export_matlab}


#: What an element can be made into.
ELEMENT_SUFFIXES = (".fmu", ".casadi", ".c")


def element_files(path: Path) -> tuple[Path, ...]:
    """All files that ``export_element`` writes for ``path``; raises BadInput for another suffix."""
    from ..files.writing import check_ours

    path = Path(path)
    if path.suffix not in ELEMENT_SUFFIXES:
        known = f"{', '.join(ELEMENT_SUFFIXES[:-1])} and {ELEMENT_SUFFIXES[-1]}"
        raise BadInput(f"{path}: a force law by itself is exported as {known}; end the name in one of them")
    if path.suffix == ".fmu":
        return (path,)
    if path.suffix == ".c":
        return _c_files(path)
    stem = path.name.removesuffix(".casadi")
    beside = [path.with_name(f"{stem}.{end}") for end in ("smooth.casadi", "casadi.json")]
    check_ours(beside[0], b"jhpnnagiieah")
    check_ours(beside[1], b'"dashpot-element-casadi/')
    return (path, *beside)


def export_element(
    element: Element,
    path: Path,
    *,
    version: int = 2,
    platforms: Sequence[Platform] | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[Path, ...]:
    """Write an element as an FMU, CasADi functions or plain C, by the suffix; returns the paths written.

    ``version`` is that of FMI, 2 or 3; for ``platforms`` and ``progress`` see ``export``.

    Raises:
        BadInput: for another suffix, or where the file cannot be written.
        ToolchainMissing: where the compiler for an FMU is missing or fails.
    """
    element_files(path)
    if Path(path).suffix == ".fmu":
        from .element_fmu import export_element_fmu

        return (export_element_fmu(element, path, version=version, platforms=platforms, progress=progress),)
    if Path(path).suffix == ".c":
        from .element_c import export_element_c

        return export_element_c(element, Path(path))
    from .element_casadi import export_element_casadi

    return export_element_casadi(element, Path(path))

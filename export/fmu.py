"""An oscillator as an FMU (FMI 2.0, co-simulation) that needs nothing but the machine it runs on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..model.equations import equations
from ..simulate.core import template
from ..simulate.law_source import law_source
from .archive import write_archive
from .backend import choose_backend
from .binaries import binaries, chosen, inside, remark
from .description import Description, describe_fmu, model_description
from .documentation import documentation, guid_of
from .platforms import Platform

if TYPE_CHECKING:
    from ..model import Oscillator

#: Texts that are the same for every model, in the order in which they are included behind the law.
_C_FILES = ("engine.c", "instance.c", "fmi2.c", "fmi2_cosimulation.c", "fmi2_state.c", "fmi2_modelexchange.c")
_HEADERS = ("engine.h", "fmi2_types.h")
_MAIN = "all.c"
_HOLD = (
    "The input F is held over a communication step; give its slope with fmi2SetRealInputDerivatives before each step "
    "and it runs in a straight line instead, which is far more exact, or with derivatives up to the third as a cubic. "
    "Events (sticking, break-away, sign changes) are located, so results do not depend on the communication step."
)


def export_fmu(
    oscillator: Oscillator,
    path: str | Path,
    *,
    backend: str | None = None,
    platforms: Sequence[Platform] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write an FMU for FMI 2.0 co-simulation; the same model gives the same bytes.

    Args:
        oscillator: the model.
        path: where to write it.
        backend: ``native`` compiles the model; ``python`` makes an FMU that needs Python with casadi where it runs, and
            no compiler here; left out, it is ``native`` wherever there is a compiler.
        platforms: what to compile it for; left out, for all that can be built for here.
        progress: called with one line before what takes long, and with what the FMU runs on.

    Returns:
        The path written.

    Raises:
        BadInput: where the backend is unknown, a value of the model is not finite, or the path cannot be written.
        ToolchainMissing: where the compiler for ``native`` or for one of the platforms is missing or fails.
    """
    if choose_backend(backend, platforms, progress) == "python":
        from .python_fmu import python_entries

        return write_archive(Path(path), python_entries(oscillator))
    return write_archive(Path(path), _native_entries(oscillator, chosen(platforms), progress))


def fmu_sources(oscillator: Oscillator, description: Description | None = None) -> tuple[dict[str, str], str]:
    """The C texts of the FMU by file name, and the GUID that ties them to their modelDescription.xml."""
    description = description or describe_fmu(oscillator)
    sources = {name: template(name) for name in (*_C_FILES, *_HEADERS)}
    sources["law.c"] = law_source(equations(oscillator))
    sources[_MAIN] = "".join(f'#include "{name}"\n' for name in ("law.c", *_C_FILES))
    guid = guid_of([_variables_header(description, ""), model_description(description, ""), *sorted(sources.values())])
    sources["variables.h"] = _variables_header(description, guid)
    return sources, guid


def _native_entries(
    oscillator: Oscillator, platforms: Sequence[Platform], progress: Callable[[str], None] | None
) -> dict[str, bytes]:
    description = describe_fmu(oscillator)
    sources, guid = fmu_sources(oscillator, description)
    entries = {f"sources/{name}": text.encode() for name, text in sources.items()}
    entries["modelDescription.xml"] = model_description(description, guid, source_files=(_MAIN,)).encode()
    page = documentation(oscillator, description, f"{_HOLD} {inside(platforms)}")
    entries["documentation/index.html"] = page.encode()
    entries |= binaries(sources, _MAIN, description.identifier, platforms, progress=progress)
    if progress is not None:
        progress(remark(platforms))
    return entries


def _variables_header(description: Description, guid: str) -> str:
    """The C table of the variables. Numbers only: no text of a model reaches it."""
    kinds = {
        "input": "DP_INPUT",
        "output": "DP_OUTPUT",
        "parameter": "DP_PARAMETER",
        "initial": "DP_INITIAL",
        "longest-step": "DP_LONGEST_STEP",
    }
    rows = [f"    {{{kinds[v.role]}, {v.index}, {v.start_text or '0.0'}}},\n" for v in description.variables]
    follows = ", ".join("-1" if leader is None else str(leader) for leader in description.follows)
    return (
        "/* Generated: the variables by value reference. */\n"
        f'#define DP_GUID "{guid}"\n'
        f"#define DP_NV {len(rows)}\n"
        f"#define DP_FORCE {description.reference('F')}\n"
        f"static const dp_variable dp_variables[DP_NV] = {{\n{''.join(rows)}}};\n"
        "/* For each state the one that it is counted from at the start, or -1. */\n"
        f"static const int dp_follows[DP_NZ] = {{{follows}}};\n"
    )

"""An oscillator as an FMU (FMI 2.0, co-simulation) that needs nothing but the machine it runs on."""

from __future__ import annotations

import platform
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import BadInput
from ..model.equations import equations
from ..simulate.compiler import shared_library
from ..simulate.core import template
from ..simulate.law_source import law_source
from .archive import write_archive
from .contents import further_contents
from .description import Description, describe_fmu, model_description
from .documentation import documentation, guid_of

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


def export_fmu(oscillator: Oscillator, path: str | Path, *, backend: str = "native") -> Path:
    """Write an FMU for FMI 2.0 co-simulation; the same model gives the same bytes.

    Args:
        oscillator: the model.
        path: where to write it.
        backend: ``native`` compiles the model for this machine's platform; ``python`` makes an FMU that needs Python
            with casadi where it runs, and no compiler here.

    Returns:
        The path written.

    Raises:
        BadInput: where the backend is unknown, a value of the model is not finite, or the path cannot be written.
        ToolchainMissing: where ``native`` finds no C compiler.
    """
    if backend not in ("native", "python"):
        raise BadInput(f"unknown FMU backend {backend!r}; use 'native' or 'python'")
    if backend == "python":
        from .python_fmu import python_entries

        return write_archive(Path(path), python_entries(oscillator))
    return write_archive(Path(path), _native_entries(oscillator))


def fmu_sources(oscillator: Oscillator, description: Description | None = None) -> tuple[dict[str, str], str]:
    """The C texts of the FMU by file name, and the GUID that ties them to their modelDescription.xml."""
    description = description or describe_fmu(oscillator)
    sources = {name: template(name) for name in (*_C_FILES, *_HEADERS)}
    sources["law.c"] = law_source(equations(oscillator))
    sources[_MAIN] = "".join(f'#include "{name}"\n' for name in ("law.c", *_C_FILES))
    guid = guid_of([_variables_header(description, ""), model_description(description, ""), *sorted(sources.values())])
    sources["variables.h"] = _variables_header(description, guid)
    return sources, guid


def platform_folder() -> tuple[str, str]:
    """FMI 2.0's name for this machine's platform, and the suffix of a shared library on it."""
    system = platform.system()
    name = {"Windows": "win", "Darwin": "darwin"}.get(system, "linux")
    suffix = {"Windows": ".dll", "Darwin": ".dylib"}.get(system, ".so")
    return f"{name}{64 if sys.maxsize > 2**32 else 32}", suffix


def _native_entries(oscillator: Oscillator) -> dict[str, bytes]:
    description = describe_fmu(oscillator)
    sources, guid = fmu_sources(oscillator, description)
    folder, suffix = platform_folder()
    entries = {f"sources/{name}": text.encode() for name, text in sources.items()}
    entries["modelDescription.xml"] = model_description(description, guid, source_files=(_MAIN,)).encode()
    entries["documentation/index.html"] = documentation(oscillator, description, _HOLD).encode()
    entries[f"binaries/{folder}/{description.identifier}{suffix}"] = shared_library(sources, _MAIN).read_bytes()
    return entries | further_contents(oscillator)


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

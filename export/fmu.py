"""An oscillator as an FMU (FMI 2.0 or 3.0, co-simulation and model exchange) that needs nothing where it runs."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .. import engine
from ..errors import BadInput
from ..simulate.law_source import law_source
from ..simulate.zig import MORE
from .archive import write_archive
from .binaries import binaries, can_build, chosen, inside, remark
from .contents import further_contents
from .description import Description, Variable, describe_fmu
from .documentation import documentation, guid_of
from .facts import Facts
from .model_description import build_description, model_description
from .platforms import Platform

if TYPE_CHECKING:
    from ..model import Oscillator
    from ..model.equations import Equations

#: What is compiled, and includes the rest.
MAIN = "all.c"
#: Each role's name in C.
_KINDS = {
    "input": "DP_INPUT",
    "slope": "DP_SLOPE",
    "output": "DP_OUTPUT",
    "power": "DP_POWER",
    "swing": "DP_SWING",
    "outside": "DP_OUTSIDE",
    "outside-given": "DP_OUTSIDE",
    "state": "DP_STATE",
    "derivative": "DP_DERIVATIVE",
    "indicator": "DP_INDICATOR",
    "time": "DP_TIME",
    "parameter": "DP_PARAMETER",
    "initial": "DP_INITIAL",
    "longest-step": "DP_LONGEST_STEP",
    "smoothing": "DP_SMOOTHING",
    "extrapolation": "DP_EXTRAPOLATION",
    "physical": "DP_PHYSICAL",
    "motion": "DP_MOTION",
    "channel": "DP_PARAMETER",
}
_HOLD = {
    2: "The input F is held over a communication step; give its slope with fmi2SetRealInputDerivatives before each "
    "step and it runs in a straight line instead, which is far more exact, or with derivatives up to the third as a "
    "cubic.",
    3: "The input F is held over a communication step; set the input F_rate, its slope, before each step and it runs "
    "in a straight line instead, which is far more exact.",
}
_EVENTS = (
    "Events (sticking, break-away, sign changes) are located, so results do not depend on the communication step. In "
    "model exchange they have event indicators; for importers that locate no events, the parameter smoothing chooses a "
    "smooth law."
)


def export_fmu(
    oscillator: Oscillator,
    path: str | Path,
    *,
    version: int = 2,
    backend: str | None = None,
    platforms: Sequence[Platform] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write an FMU; the same model gives the same bytes.

    Args:
        oscillator: the model.
        path: where to write it.
        version: of FMI, 2 or 3.
        backend: ``native`` compiles the model, for co-simulation and model exchange; ``python`` makes an FMU for
            co-simulation by FMI 2.0 that needs Python with casadi where it runs, and no compiler here; left out, it is
            ``native`` wherever there is a compiler.
        platforms: what to compile it for; left out, for all that can be built for here.
        progress: called with one line before what takes long, and with what the FMU runs on.

    Returns:
        The path written.

    Raises:
        BadInput: where the backend is unknown, a value of the model is not finite, or the path cannot be written.
        ToolchainMissing: where the compiler for ``native`` or for one of the platforms is missing or fails.
    """
    _, entries = fmu_entries(
        Facts(oscillator), version=version, backend=backend, platforms=platforms, progress=progress
    )
    return write_archive(Path(path), entries)


def fmu_entries(
    facts: Facts,
    *,
    version: int = 2,
    backend: str | None = None,
    platforms: Sequence[Platform] | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[Description, dict[str, bytes]]:
    """The model's variables as its FMU has them, and the contents of that by their names; as ``export_fmu``."""
    check_version(version)
    if choose_backend(backend, platforms, progress) == "python":
        if version != 2:
            raise BadInput(
                "an FMU in Python is for FMI 2 alone; leave out --fmi 3, or take the native back-end, which needs a C "
                "compiler"
            )
        from .python_fmu import python_entries

        description = describe_fmu(facts, continuous=False)
        return description, python_entries(facts, description)
    targets = chosen(platforms)
    description = describe_fmu(facts, version=version)
    return description, _native_entries(facts, description, version, targets, progress)


def check_version(version: int) -> None:
    """Raises BadInput where there is no such version of FMI here."""
    if version not in engine.FMU:
        raise BadInput(f"there is no FMI {version} here; use 2 or 3")


def fmu_sources(
    facts: Facts, description: Description | None = None, *, version: int = 2
) -> tuple[dict[str, str], str]:
    """The C texts of the FMU by file name, and the GUID that ties them to their modelDescription.xml."""
    description = description or describe_fmu(facts, version=version)
    return sources_of(facts.loaded, description, version)


def sources_of(eq: Equations, description: Description, version: int = 2) -> tuple[dict[str, str], str]:
    """The same from equations and the variables of them."""
    sources = engine.fmu_texts(version)
    sources["law.c"] = law_source(eq, exported=True)
    sources[MAIN] = engine.included("law.c", *engine.FMU[version])
    text = model_description(description, "", version=version)
    guid = guid_of([_variables_header(description, ""), text, *sorted(sources.values())])
    sources["variables.h"] = _variables_header(description, guid)
    return sources, guid


def _native_entries(
    facts: Facts,
    description: Description,
    version: int,
    platforms: Sequence[Platform],
    progress: Callable[[str], None] | None,
) -> dict[str, bytes]:
    sources, guid = fmu_sources(facts, description, version=version)
    entries = {f"sources/{name}": text.encode() for name, text in sources.items()}
    entries["sources/buildDescription.xml"] = build_description(description.identifier, (MAIN,)).encode()
    text = model_description(description, guid, version=version, source_files=(MAIN,))
    entries["modelDescription.xml"] = text.encode()
    page = documentation(facts, description, f"{_HOLD[version]} {_EVENTS} {inside(platforms)}")
    entries["documentation/index.html"] = page.encode()
    entries |= binaries(sources, MAIN, description.identifier, platforms, version=version, progress=progress)
    if progress is not None:
        progress(remark(platforms))
    return entries | further_contents(facts, description, version)


def _variables_header(description: Description, guid: str) -> str:
    """The C table of the variables, the motion's sizes, the state of the fit.

    Of a model's own texts the names of laws alone reach it, made fit for a string of C and for a log.
    """
    rows = [
        f'    {{{_KINDS[v.role]}, {v.index}, {v.start_text or "0.0"}, {_bounds(v)}, "{_in_a_message(v.name)}"}},\n'
        for v in description.variables
    ]
    follows = ", ".join("-1" if leader is None else str(leader) for leader in description.follows)
    covered = "".join(
        f"    {{{description.reference(c.name)}, {c.low!r}, {c.high!r}, {c.least!r}, {c.most!r}, "
        f'"{_in_a_message(c.unit)}"}},\n'
        for c in description.covered
    )
    return (
        "/* Generated: the variables by value reference, and the sizes of the motion. */\n"
        f'#define DP_GUID "{guid}"\n'
        "/* For the log, which importers may format again: no per cent sign. */\n"
        f'#define DP_STATE_OF_FIT "{description.state.replace("%", "per cent")}"\n'
        f"#define DP_NV {len(rows)}\n"
        f"#define DP_GIVEN {description.given}\n"
        f"#define DP_FORCE {description.place('input')}\n"
        f"#define DP_FORCE_RATE {_place(description, 'slope')}\n"
        f"#define DP_SMOOTHING_AT {_place(description, 'smoothing')}\n"
        f"#define DP_EXTRAPOLATION_AT {_place(description, 'extrapolation')}\n"
        f"#define DP_NCOVERED {len(description.covered)}\n"
        f"static const dp_variable dp_variables[DP_NV] = {{\n{''.join(rows)}}};\n"
        f"static const dp_covered_range dp_covered[DP_NCOVERED + 1] = {{\n{covered}    {{0}}}};\n"
        "/* For each state the one that it is counted from at the start, or -1; its typical size. */\n"
        f"static const int dp_follows[DP_NZ] = {{{follows}}};\n"
        f"static const double dp_nominal[DP_NZ] = {{{', '.join(map(repr, description.nominals))}}};\n"
        "/* What each surface goes through. */\n"
        f"static const double dp_range[DP_NS + 1] = {{{', '.join(map(repr, (*description.ranges, 1.0)))}}};\n"
    )


def _in_a_message(name: str) -> str:
    """The name of a variable as it can stand in a C string and in a log that importers format again."""
    return re.sub(r"[^A-Za-z0-9_.()/ -]", "_", name)


def _place(description: Description, role: str) -> int:
    """Value reference of the variable in a role; -1 where there is none."""
    place = description.place(role)
    return -1 if place is None else place


def _bounds(variable: Variable) -> str:
    low, high = variable.min, variable.max
    return f"{'-HUGE_VAL' if low is None else repr(low)}, {'HUGE_VAL' if high is None else repr(high)}"


# How the model inside an FMU runs: as a binary, or in Python where no compiler is.

BACKENDS = ("native", "python")


def choose_backend(
    backend: str | None, platforms: Sequence[Platform] | None = None, progress: Callable[[str], None] | None = None
) -> str:
    """The back-end to use: the one asked for, else ``native``, or ``python`` where no C compiler is.

    Args:
        backend: ``native``, ``python``, or None for whatever is possible here.
        platforms: what binaries are asked for by name; then it is ``native``.
        progress: called with a sentence where it has to be ``python``; left out, it is a Python warning.

    Raises:
        BadInput: where there is no such back-end, or platforms are named for Python.
    """
    if backend not in (None, *BACKENDS):
        raise BadInput(f"unknown FMU backend {backend!r}; use 'native' or 'python'")
    if backend == "python" and platforms:
        raise BadInput("an FMU in Python has no binaries of its own to choose platforms for; leave the platforms out")
    if backend is not None or platforms or can_build():
        return backend or "native"
    (progress or warnings.warn)(
        "no C compiler was found, so the FMU runs its model in Python: wherever it is used it needs Python with the "
        "package casadi, it is about a hundred times slower, and it is for FMI 2.0 co-simulation only; "
        f"for a compiled one: {MORE}"
    )
    return "python"

"""The C of the product, with nothing in it to be filled in, and what is included in which order."""

from __future__ import annotations

from functools import cache
from importlib import resources

#: The event-exact engine, behind the generated law: ``engine.c`` includes the other three.
ENGINE = ("engine.h", "flow.c", "events.c", "engine.c")
#: Before and behind the engine where derivatives go along.
CARRIED = ("carried.h", "carried.c")
#: Behind the engine: a whole recording in one call, for fits and simulations.
RECORD = "record.c"
#: One law along a motion that is given.
ALONG = "along.c"
#: What zig's C library lacks for Windows.
WINDOWS_RUNTIME = "windows_runtime.c"

_COMPONENT = ("component.c", "component_running.c", "component_state.c")
#: What the main file of an FMU includes behind ``law.c``, in this order, by version of FMI.
FMU = {
    2: ("engine.c", "instance.c", "fmi2_types.h", *_COMPONENT, "fmi2.c"),
    3: ("engine.c", "instance.c", "fmi3_types.h", *_COMPONENT, "fmi3.c", "fmi3_absent.c"),
}
#: ... and what those include themselves.
_WITHIN_FMU = (*ENGINE[:-1], "continuous.c")


@cache
def text(name: str) -> str:
    """One of the C texts, by file name."""
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")


def engine_texts() -> dict[str, str]:
    """The texts of the engine by file name."""
    return {name: text(name) for name in ENGINE}


def fmu_texts(version: int) -> dict[str, str]:
    """The texts of an FMU by file name, but for the generated ones."""
    return {name: text(name) for name in (*_WITHIN_FMU, *FMU[version])}


def included(*names: str) -> str:
    """A main file that includes others, in this order."""
    return "".join(f'#include "{name}"\n' for name in names)

"""The text of modelDescription.xml, for both versions of FMI, and of buildDescription.xml."""

from __future__ import annotations

import math

from .. import __version__
from .description import Description, Variable
from .render import render

#: Units that a user would rather read: FMI's factors from the unit of the model, and the name.
_DISPLAY: dict[str, tuple[tuple[str, float], ...]] = {
    "m": (("mm", 1e3), ("um", 1e6)),
    "m/s": (("mm/s", 1e3),),
    "rad": (("deg", 180.0 / math.pi),),
    "rad/s": (("Hz", 0.5 / math.pi), ("deg/s", 180.0 / math.pi)),
    "s": (("ms", 1e3),),
    "kg": (("g", 1e3),),
    "N": (("mN", 1e3), ("kN", 1e-3)),
    "J": (("mJ", 1e3),),
    "W": (("mW", 1e3),),
}


def model_description(
    description: Description,
    guid: str,
    *,
    version: int = 2,
    source_files: tuple[str, ...] = (),
    tool: str = "",
    python: bool = False,
) -> str:
    """Text of modelDescription.xml: co-simulation and model exchange.

    Args:
        description: the variables.
        guid: what ties this text to the binary.
        version: of FMI, 2 (2.0.5) or 3 (3.0.2).
        source_files: what to compile below ``sources``.
        tool: further words on what made the FMU.
        python: whether the binary is PythonFMU's, which is for co-simulation and cannot interpolate inputs.
    """
    place = {variable.name: i for i, variable in enumerate(description.variables)}
    first = 1 if version == 2 else 0  # FMI 2 counts variables from one, FMI 3 takes the value reference

    def places(names: tuple[str, ...]) -> str:
        return " ".join(str(place[name] + first) for name in sorted(set(names) & set(place), key=place.__getitem__))

    def entries(*roles: str) -> list[tuple[int, str, str]]:
        chosen = [v for v in description.variables if v.role in roles]
        return [(place[v.name] + first, places(v.knowns), places(v.initial_knowns)) for v in chosen]

    outputs = ("output", "power", "swing", "outside", "outside-given")
    states = {v.derivative_of for v in description.variables if v.derivative_of}
    return render(
        f"fmi{version}_description.xml.j2",
        description=description,
        place=place,
        states=states,
        shown={v.name: _shown(v) for v in description.variables},
        guid=guid,
        tool=f"dashpot {__version__}" + (f" with {tool}" if tool else ""),
        units=description.units(),
        display={name: _DISPLAY.get(name, ()) for name in description.units()},
        outputs=entries(*outputs),
        derivatives=entries("derivative"),
        indicators=entries("indicator"),
        initial=entries(*outputs, "physical", "state", "derivative"),
        events=len(description.ranges),
        source_files=source_files,
        python=python,
        exchange=not python,
    )


def build_description(identifier: str, source_files: tuple[str, ...]) -> str:
    """Text of sources/buildDescription.xml (FMI 3.0.2, section 2.5.2): C99, no library but the mathematical one."""
    return render("build_description.xml.j2", identifier=identifier, source_files=source_files)


def _shown(variable: Variable) -> str | None:
    """The unit in which a user would rather read a variable; an angular velocity is no frequency."""
    names = [name for name, _ in _DISPLAY.get(variable.unit, ())]
    if variable.role != "parameter" and "deg/s" in names:
        return "deg/s"
    return names[0] if names else None

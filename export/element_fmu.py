"""An element as an FMU for co-simulation: motion in, force out.

The same engine runs as in an oscillator's FMU, with the acceleration of the motion in the place of the force. The
importer puts displacement and velocity where they are before each step; within it they go on by the acceleration, so
that turning points and stops are located as everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from .. import __version__
from ..errors import BadInput
from ..model import units
from ..model.element import Element
from ..model.element_file import dumps
from ..model.equations import ORIGIN, Equations, equations
from ..simulate.core import longest_step
from .archive import write_archive
from .binaries import binaries, chosen, remark
from .description import Description, Variable, identifier_of
from .fmu import MAIN, choose_backend, sources_of
from .model_description import build_description, model_description
from .platforms import Platform
from .render import plain_text, render

#: Longest internal step, s, where the laws have no rates along a motion of the recorded size.
_STILL = 1e-3


def export_element_fmu(
    element: Element,
    path: str | Path,
    *,
    platforms: Sequence[Platform] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write an element as an FMU of FMI 2.0; the same element gives the same bytes.

    Args:
        element: with its values.
        path: where to write it.
        platforms: what to compile it for; left out, for all that can be built for here.
        progress: called with one line before what takes long, and with what the FMU runs on.

    Returns:
        The path written.

    Raises:
        BadInput: where a value is not finite, or the path cannot be written.
        ToolchainMissing: where there is no compiler, or it fails.
    """
    if choose_backend(None, platforms, progress) == "python":
        raise BadInput("the FMU of a force law by itself needs a C compiler; dashpot doctor says how to get one")
    targets, eq = chosen(platforms), equations(element)
    description = describe_element(element, eq)
    sources, guid = sources_of(eq, description)
    entries = {f"sources/{name}": text.encode() for name, text in sources.items()}
    entries["sources/buildDescription.xml"] = build_description(description.identifier, (MAIN,)).encode()
    entries["modelDescription.xml"] = model_description(description, guid, source_files=(MAIN,)).encode()
    entries["documentation/index.html"] = _documentation(description).encode()
    entries["resources/element.yaml"] = dumps(element).encode()
    entries |= binaries(sources, MAIN, description.identifier, targets, version=2, progress=progress)
    if progress is not None:
        progress(remark(targets))
    return write_archive(Path(path), entries)


def describe_element(element: Element, eq: Equations) -> Description:
    """Table of the FMU's variables; raises BadInput where a value is not a finite number."""
    length = element.unit
    speed, acceleration = (units.compose(template, length) for template in ("X/s", "X/s2"))
    inputs = ("displacement", "velocity", "acceleration")
    variables = [
        Variable("acceleration", "input", 0, acceleration, "acceleration of the motion that is given", 0.0),
        Variable("displacement", "motion", 0, length, "displacement of the motion that is given, as recorded", 0.0),
        Variable("velocity", "motion", 1, speed, "velocity of the motion that is given", 0.0),
        Variable("F", "output", 0, element.force_unit, "force that the motion takes, positive along it", None, inputs),
    ]
    energy, power = element.energy_units
    variables += [
        Variable("energy", "power", 0, energy, "kinetic and stored energy", None, inputs),
        Variable("dissipated_power", "power", 1, power, "power that is taken from the motion for good", None, inputs),
    ]
    words, bounds = element.descriptions(), element.bounds()
    for i, (name, parameter) in enumerate(element.parameters().items()):
        if not math.isfinite(parameter.value):
            raise BadInput(f"parameter {name!r} is {parameter.value}; an FMU needs a finite number")
        low, high = bounds[name]
        least = low if math.isfinite(low) and low <= parameter.value else None
        most = high if math.isfinite(high) and parameter.value <= high else None
        text, unit = words[name], parameter.unit
        variables.append(Variable(name, "parameter", i, unit, text, parameter.value, min=least, max=most))
    text = "displacement, as recorded, from which the laws count it"
    variables.append(Variable(ORIGIN, "parameter", eq.parameter_names.index(ORIGIN), length, text, element.origin))
    for i, (name, state) in enumerate(zip(eq.state_names[2:], eq.inner, strict=True), start=2):
        law, _, own = name.rpartition(".")
        unit = units.compose(state.unit, length, element.force_unit)
        variables.append(Variable(f"{name}0", "initial", i, unit, f"{law}: start value of its {own}", 0.0))
    step = max_step(element)
    text = "longest internal step: a part of the fastest motion that was recorded, or of what is faster within"
    variables.append(Variable("max_step", "longest-step", 0, "s", text, step, min=0.0))
    pace = pace_of(element)
    stop = 10.0 ** math.ceil(math.log10(20.0 * 2.0 * math.pi / pace))
    return Description(
        plain_text(element.name) or "element",
        identifier_of(element.name),
        plain_text(element.equation()),
        tuple(variables),
        stop,
        2.0 * math.pi / pace / 100.0,
        eq.follows,
        (1.0,) * len(eq.kinds),
        (1.0,) * len(eq.state_names),
        exchange=False,
    )


def pace_of(element: Element) -> float:
    """Angular frequency, rad/s, of the fastest motion that was recorded: its speed over its amplitude."""
    if element.amplitude is None or element.speed is None or not element.amplitude.max > 0.0:
        return 2.0 * math.pi
    return max(element.speed.max / element.amplitude.max, 1e-9)


def max_step(element: Element) -> float:
    """Longest internal step, s."""
    values = [*element.values().values(), element.origin]
    reach = 1.0 if element.amplitude is None else element.amplitude.max
    try:
        return longest_step(element, values, reach, pace_of(element))
    except BadInput:
        return _STILL


def _documentation(description: Description) -> str:
    rows = [(v.name, v.unit, v.causality, v.start_text or "", v.description) for v in description.variables]
    return render(
        "element_documentation.html.j2",
        description=description,
        variables=rows,
        footer=f"Made by dashpot {__version__}.",
    )

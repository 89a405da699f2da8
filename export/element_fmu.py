"""An element as an FMU (FMI 2.0 or 3.0, co-simulation and model exchange): motion in, force out.

The same engine runs as in an oscillator's FMU, with the acceleration of the motion in the place of the force. In
co-simulation the importer puts displacement and velocity where they are before each step; within it they go on by the
acceleration, so that turning points and stops are located as everywhere. In model exchange they are inputs at any time,
and only the inner states of the laws are integrated.
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
from ..model.fit_state import state_of_fit
from .archive import write_archive
from .binaries import binaries, chosen, remark
from .description import (
    Covered,
    Description,
    Knowns,
    Variable,
    holding,
    identifier_of,
    inner_starts,
    integrated,
    smoothing_variable,
)
from .element_motion import channel_words, max_step, motion_size, pace_of, state_units
from .experiment import experiment
from .fmu import MAIN, check_version, choose_backend, sources_of
from .model_description import build_description, model_description
from .platforms import Platform
from .render import plain_text, render

#: What the origin is.
ORIGIN_WORDS = "displacement, as recorded, from which the laws count it"


def export_element_fmu(
    element: Element,
    path: str | Path,
    *,
    version: int = 2,
    platforms: Sequence[Platform] | None = None,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write an element as an FMU; the same element gives the same bytes.

    Args:
        element: with its values.
        path: where to write it.
        version: of FMI, 2 or 3.
        platforms: what to compile it for; left out, for all that can be built for here.
        progress: called with one line before what takes long, and with what the FMU runs on.

    Returns:
        The path written.

    Raises:
        BadInput: where a value is not finite, or the path cannot be written.
        ToolchainMissing: where there is no compiler, or it fails.
    """
    check_version(version)
    if choose_backend(None, platforms, progress) == "python":
        raise BadInput("the FMU of a force law by itself needs a C compiler; dashpot doctor says how to get one")
    targets, eq = chosen(platforms), equations(element)
    description = describe_element(element, eq, version=version)
    sources, guid = sources_of(eq, description, version)
    text = model_description(description, guid, version=version, source_files=(MAIN,))
    entries = {f"sources/{name}": text.encode() for name, text in sources.items()}
    entries["sources/buildDescription.xml"] = build_description(description.identifier, (MAIN,)).encode()
    entries["modelDescription.xml"] = text.encode()
    entries["documentation/index.html"] = _documentation(description, version).encode()
    entries["resources/element.yaml"] = dumps(element).encode()
    entries |= binaries(sources, MAIN, description.identifier, targets, version=version, progress=progress)
    if progress is not None:
        progress(remark(targets))
    return write_archive(Path(path), entries)


def describe_element(element: Element, eq: Equations, *, version: int = 2) -> Description:
    """Table of the FMU's variables; raises BadInput where a value is not a finite number.

    FMI 3 has no call for the slope of an input, so that there it is an input of its own, ``acceleration_rate``.
    """
    length, size, state_unit = element.unit, motion_size(element, eq), state_units(element, eq)
    acceleration, jerk = (units.compose(template, length) for template in ("X/s2", "X/s3"))
    channels = channel_words(element)
    known = Knowns(eq, "acceleration", ("displacement", "velocity"), tuple(channels))
    energy, power = element.energy_units
    taken = "power that is taken from the motion for good"
    variables = [
        Variable("acceleration", "input", 0, acceleration, "acceleration of the motion that is given", 0.0),
        Variable("displacement", "motion", 0, length, "displacement of the motion that is given, as recorded", 0.0),
        Variable("velocity", "motion", 1, state_unit[1], "velocity of the motion that is given", 0.0),
        Variable(
            "F",
            "output",
            0,
            element.force_unit,
            "force that the motion takes, positive along it",
            None,
            *known.of(eq.y[0]),
        ),
        Variable("energy", "power", 0, energy, "kinetic and stored energy", None, *known.of(eq.energy)),
        Variable("dissipated_power", "power", 1, power, taken, None, *known.of(eq.dissipated)),
    ]
    covered = _covered(element)
    if covered:
        names, spans = tuple(one.name for one in covered), ", ".join(map(str, covered))
        text = f"1 where the motion or a channel is above what the element was identified in, -1 below it ({spans})"
        variables.append(Variable("outside_range", "outside-given", 0, "1", text, None, names, names))
    words, bounds = element.descriptions(), element.bounds()
    for i, (name, parameter) in enumerate(element.parameters().items()):
        if not math.isfinite(parameter.value):
            raise BadInput(f"parameter {name!r} is {parameter.value}; an FMU needs a finite number")
        low, high = holding(bounds[name], parameter.value)
        text, unit = words[name], parameter.unit
        variables.append(Variable(name, "parameter", i, unit, text, parameter.value, min=low, max=high))
    place = eq.parameter_names.index(ORIGIN)
    variables.append(Variable(ORIGIN, "parameter", place, length, ORIGIN_WORDS, element.origin))
    for i, (name, (one, text)) in enumerate(channels.items(), start=place + 1):
        variables.append(Variable(name, "channel", i, one.unit, text, one.reference))
    variables += inner_starts(eq, state_unit, ("displacement", "velocity"))
    text = "longest internal step: a part of the fastest motion that was recorded, or of what is faster within"
    variables += [
        Variable("max_step", "longest-step", 0, "s", text, max_step(element), min=0.0),
        smoothing_variable(),
        *integrated(eq, known, size, state_unit, given=2, indicators=version == 3),
    ]
    if version == 3:
        text = "slope of the acceleration over the coming communication steps"
        variables += [
            Variable("time", "time", 0, "s", "time"),
            Variable("acceleration_rate", "slope", 0, jerk, text, 0.0),
        ]
    return Description(
        plain_text(element.name) or "element",
        identifier_of(element.name),
        plain_text(element.equation()),
        tuple(variables),
        experiment(pace_of(element)),
        eq.follows,
        size.ranges,
        size.nominals,
        covered,
        state_of_fit(element) or "",
    )


def _covered(element: Element) -> tuple[Covered, ...]:
    """What the recordings covered: of the displacement to both sides, of the velocity, of channels."""
    covered = []
    if (reach := element.amplitude) is not None:
        ends = element.origin - reach.max, element.origin + reach.max
        covered.append(Covered.of_span("displacement", element.unit, *ends))
    if (speed := element.speed) is not None:
        covered.append(Covered.of_span("velocity", units.compose("X/s", element.unit), -speed.max, speed.max))
    for name, (one, _) in channel_words(element).items():
        covered.append(Covered.of_span(name, one.unit, one.low, one.high))
    return tuple(covered)


def _documentation(description: Description, version: int) -> str:
    rows = [(v.name, v.unit, v.causality, v.start_text or "", v.description) for v in description.variables]
    return render(
        "element_documentation.html.j2",
        description=description,
        variables=rows,
        slope={2: "fmi2SetRealInputDerivatives", 3: "the input acceleration_rate"}[version],
        footer=f"Made by dashpot {__version__}.",
    )

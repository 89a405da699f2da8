"""An element as two files of plain C, motion in, force out: as an oscillator's, with a function that moves it."""

from __future__ import annotations

from pathlib import Path

from ..model import units
from ..model.element import Element
from ..model.equations import ORIGIN, equations
from ..model.parameter import Parameter
from .element_fmu import ORIGIN_WORDS, describe_element
from .element_motion import channel_words, state_units, values_of
from .plain_c import c_texts, c_words, noted, origin_of, valid_for, write_c


def export_element_c(element: Element, path: Path) -> tuple[Path, Path]:
    """Write an element as C source and header; for arguments and errors see ``plain_c.export_plain_c``."""
    return write_c(path, lambda header: element_c(element, header))


def element_c(element: Element, header: str) -> tuple[str, str]:
    """Text of the C source and of its header, which the source includes by the name ``header``.

    Raises BadInput where a value of the element is not finite.
    """
    eq = equations(element)
    description, given = describe_element(element, eq), state_units(element, eq)
    acceleration = units.compose("X/s2", element.unit)
    outputs = [
        ("F", element.force_unit, "force that the motion takes, positive along it"),
        ("displacement", given[0], "displacement, as given"),
        ("velocity", given[1], "velocity, as given"),
        ("acceleration", acceleration, "acceleration, as given"),
    ]
    about = [
        f"Motion in, force out: displacement in {given[0]}, velocity in {given[1]}, acceleration in {acceleration}, "
        f"time in s, force in {element.force_unit}. What it is fastened to feels the opposite force.",
        f"{valid_for({'amplitude': element.amplitude, 'speed': element.speed})}.",
        *origin_of(element.identified),
        *noted(description),
    ]
    parameters = element.parameters() | {ORIGIN: Parameter(element.origin, None, element.unit)}
    said = element.descriptions() | {ORIGIN: ORIGIN_WORDS}
    for name, (one, text) in channel_words(element).items():
        parameters[name], said[name] = Parameter(one.reference, None, one.unit), text
    words = c_words(description, eq, about, parameters, said, outputs, given)
    kind = {"thing": "force law by itself", "driven": "acceleration", "given": True}
    return c_texts(header, description, eq, values_of(element), words | kind)

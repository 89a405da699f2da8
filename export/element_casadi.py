"""An element as a CasADi function: motion in, force out, for controller design.

``OUT.casadi``        F, zdot = f(z, x, v, a, p): the force and the rates of the laws' inner states, signs as they are
``OUT.smooth.casadi`` the same with every sign replaced by tanh(surface / width)
``OUT.casadi.json``   names, units, values with errors, widths

``z`` has no rows where no law has a memory. An element of ``p`` that is inf takes the identified value: give
``casadi.inf`` for all of it. Inner states begin at zero, or at what ``follows`` says. Where strengths depend on
channels the functions have one input more, ``c``, behind ``p``: the channels, each the reference value where it is inf
or left out.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from ..files.writing import together, write
from ..model.element import Element
from ..model.equations import Equations, equations, signed
from ..model.fit_state import state_of_fit
from ..simulate.casadi_step import with_defaults
from .casadi_functions import serialised
from .element_motion import motion_size, state_units, values_of


def export_element_casadi(element: Element, path: Path) -> tuple[Path, ...]:
    """Write the functions and their description beside one another; returns the paths written."""
    stem, eq = path.name.removesuffix(".casadi"), equations(element)
    widths = np.array([surface.width for surface in motion_size(element, eq).surfaces])
    made = {"casadi": force_function(element), "smooth.casadi": force_function(element, widths)}
    written = []
    with together():
        for suffix, function in made.items():
            target = path.with_name(f"{stem}.{suffix}")
            write(target, serialised(function))
            written.append(target)
        target = path.with_name(f"{stem}.casadi.json")
        write(target, json.dumps(describe(element, eq, widths), indent=2, ensure_ascii=False) + "\n")
    return (*written, target)


def force_function(element: Element, widths: np.ndarray | None = None) -> Any:
    """casadi.Function (z, x, v, a, p) -> (F, zdot); with ``widths`` (surfaces,) its signs are smooth.

    With channels it has the input ``c`` too, in which these stand in the order of ``Element.channels``.
    """
    import casadi as ca

    eq = equations(element)
    references = [one.reference for one in element.channels.values()]
    identified = values_of(element)[: eq.p.numel() - len(references)]
    inner, given = ca.SX.sym("z", eq.z.numel() - 2), ca.SX.sym("c", len(references))
    x, v, a, p = ca.SX.sym("x"), ca.SX.sym("v"), ca.SX.sym("a"), ca.SX.sym("p", len(identified))
    both = ca.vertcat(eq.y[0], eq.zdot[2:])
    plain = signed(eq, both, None if widths is None or not len(widths) else ca.DM(widths))
    there = ca.Function("there", [eq.z, eq.t, eq.u, eq.p], [plain])
    channels = ca.if_else(given < ca.inf, given, ca.DM(references)) if references else given
    result = there(ca.vertcat(x, v, inner), 0.0, a, ca.vertcat(with_defaults(p, identified), channels))
    inputs, names, options = [inner, x, v, a, p], ["z", "x", "v", "a", "p"], {}
    if references:
        inputs, names = [*inputs, given], [*names, "c"]
        options = {"default_in": [0.0, 0.0, 0.0, 0.0, 0.0, math.inf]}
    return ca.Function("force", inputs, [result[0], result[1:]], names, ["F", "zdot"], options)


def describe(element: Element, eq: Equations, widths: np.ndarray) -> dict[str, Any]:
    """Names and units of everything that goes into and comes out of the functions."""
    words = element.descriptions()
    parameters = [
        {"name": name, "value": p.value, "std": p.std, "unit": p.unit, "description": words[name]}
        for name, p in element.parameters().items()
    ]
    origin = {"name": "origin", "value": element.origin, "std": None, "unit": element.unit, "description": "of x"}
    return {
        "format": "dashpot-element-casadi/1",
        "name": element.name,
        "equation": element.equation(),
        "call": f"F, zdot = f(z, x, v, a, p{', c' if element.channels else ''})",
        "motion": {"x": element.unit, "v": f"{element.unit}/s", "a": f"{element.unit}/s2"},
        "force": element.force_unit,
        "z": [
            {"name": name, "unit": unit}
            for name, unit in zip(eq.state_names[2:], state_units(element, eq)[2:], strict=True)
        ],
        "parameters": [*parameters, origin],
        "c": [
            {"name": name, "unit": one.unit, "reference": one.reference, "min": one.low, "max": one.high}
            for name, one in element.channels.items()
        ],
        "valid": {
            name: {"min": covered.min, "max": covered.max, "unit": covered.unit}
            for name, covered in (("amplitude", element.amplitude), ("speed", element.speed))
            if covered is not None
        },
        "state_of_fit": state_of_fit(element),
        "recordings": [dict(recording) for recording in element.identified.recordings],
        "widths": [float(width) for width in widths],
    }

"""What an importer reads in modelDescription.xml, for hosts that have no reader of their own: FMI 2.0 and 3.0."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import dataclass
from pathlib import Path

CO_SIMULATION, MODEL_EXCHANGE = "CoSimulation", "ModelExchange"
#: Name of the further input that takes the slope of the force where the interface has no call for it.
SLOPE = "F_rate"


@dataclass(frozen=True)
class Described:
    """An FMU as far as a host needs it.

    Attributes:
        version: 2 or 3.
        identifiers: interface (``CoSimulation``, ``ModelExchange``) to the name of its library.
        token: GUID of FMI 2.0, instantiation token of FMI 3.0.
        references: variable name to value reference.
        values: start value of each variable that has one.
        inputs, outputs: names in their order.
        states: names of the continuous states, in the order in which the calls of model exchange hold them.
        starts: start values of the states, in the same order.
        tunable: parameters that may change in a run.
        bounds: lower and upper bound of each variable, infinite where it has none.
        indicators: how many event indicators there are.
        interpolates: whether FMI 2.0 co-simulation takes derivatives of its inputs.
    """

    version: int
    identifiers: dict[str, str]
    token: str
    references: dict[str, int]
    values: dict[str, float]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: tuple[str, ...]
    starts: tuple[str, ...]
    tunable: tuple[str, ...]
    bounds: dict[str, tuple[float, float]]
    indicators: int
    interpolates: bool


def describe(fmu: Path) -> Described:
    """Read the description of an FMU."""
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    version = int(root.attrib["fmiVersion"].split(".")[0])
    variables = [element for element in root.findall("ModelVariables/*") if element.get("name")]
    names = [variable.attrib["name"] for variable in variables]
    references = {name: int(v.attrib["valueReference"]) for name, v in zip(names, variables, strict=True)}
    bearers = [variable.find("Real") if version == 2 else variable for variable in variables]
    structure = root.find("ModelStructure")
    if version == 2:
        unknowns = [int(u.attrib["index"]) - 1 for u in structure.findall("Derivatives/Unknown")]
        states = tuple(names[int(variables[i].find("Real").attrib["derivative"]) - 1] for i in unknowns)
        indicators = int(root.get("numberOfEventIndicators", "0"))
    else:
        by_reference = {reference: i for i, reference in enumerate(references.values())}
        elements = structure.findall("ContinuousStateDerivative")
        unknowns = [by_reference[int(u.attrib["valueReference"])] for u in elements]
        states = tuple(names[by_reference[int(variables[i].attrib["derivative"])]] for i in unknowns)
        indicators = len(structure.findall("EventIndicator"))
    interfaces = {name: root.find(name) for name in (CO_SIMULATION, MODEL_EXCHANGE)}
    slave = interfaces[CO_SIMULATION]
    return Described(
        version,
        {name: element.attrib["modelIdentifier"] for name, element in interfaces.items() if element is not None},
        root.attrib["guid" if version == 2 else "instantiationToken"],
        references,
        {n: float(v.attrib["start"]) for n, v in zip(names, bearers, strict=True) if v.get("start")},
        tuple(n for n, v in zip(names, variables, strict=True) if v.get("causality") == "input"),
        tuple(n for n, v in zip(names, variables, strict=True) if v.get("causality") == "output"),
        states,
        tuple({"displacement": "x0", "velocity": "v0"}.get(name, f"{name}0") for name in states),
        tuple(
            n
            for n, v in zip(names, variables, strict=True)
            if v.get("variability") == "tunable" and v.get("causality") == "parameter"
        ),
        {
            name: (float(v.get("min", "-inf")), float(v.get("max", "inf")))
            for name, v in zip(names, bearers, strict=True)
        },
        indicators,
        slave is not None and slave.get("canInterpolateInputs") == "true",
    )

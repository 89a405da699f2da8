"""The Python back-end: an FMU that PythonFMU builds, its description completed so that validators find no problem.

It needs no compiler here, but Python with casadi where it runs. The equations are the serialised event-exact step;
no text of a model becomes program text.
"""

from __future__ import annotations

import hashlib
import json
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path

from ..files.writing import fill
from ..model import units
from ..model.equations import Equations
from ..model.law import Expression
from ..model.physical import physical
from ..simulate.casadi_step import exact_output, exact_step
from ..templates import template
from .casadi_functions import serialised
from .contents import further_contents
from .description import Description, Variable
from .documentation import documentation, guid_of
from .facts import Facts
from .model_description import model_description

_HOLD = (
    "This FMU needs Python with the package casadi on the machine where it runs. "
    "The input F is held over a communication step; set the input F_rate, its slope, before each step and it runs in a "
    "straight line instead, which is far more exact. "
    "Events (sticking, break-away, sign changes) are located, so results do not depend on the communication step."
)


def python_entries(facts: Facts, description: Description) -> dict[str, bytes]:
    """Contents of the FMU by their names in the archive; its description has what co-simulation needs alone.

    Raises:
        BadInput: where a value of the model is not finite.
    """
    import pythonfmu

    description, longest = _with_slope(description), facts.max_step
    text = template("slave.py.txt")
    # Python keeps modules by name: slaves of different versions in one process must not share one.
    module = f"dashpot_slave_{hashlib.sha256(text.encode()).hexdigest()[:12]}"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        script = folder / f"{module}.py"
        fill(script, text)
        resources = [folder / "step.casadi", folder / "output.casadi", folder / "model.json"]
        fill(resources[0], serialised(exact_step(facts.oscillator, longest, longest, payload=True)))
        fill(resources[1], serialised(output_function(facts.loaded)))
        fill(resources[2], _model_json(description))
        built = folder / "built.fmu"
        with _imports_undone(module):
            pythonfmu.FmuBuilder.build_FMU(script, built, project_files=resources)
        with zipfile.ZipFile(built) as archive:
            entries = {info.filename: archive.read(info) for info in archive.infolist() if not info.is_dir()}
    entries.pop("modelDescription.xml")
    # the GUID stands for everything that computes, in an order that does not depend on the file system
    parts = [model_description(description, "", python=True)]
    parts += [f"{name} {hashlib.sha256(entries[name]).hexdigest()}" for name in sorted(entries)]
    tool = f"PythonFMU {pythonfmu.__version__}"
    entries["modelDescription.xml"] = model_description(description, guid_of(parts), tool=tool, python=True).encode()
    entries["documentation/index.html"] = documentation(facts, description, _HOLD).encode()
    return entries | further_contents(facts, description)


def output_function(eq: Equations) -> Expression:
    """``y = output(z, u, p, t)``: response as recorded, displacement, velocity, acceleration; power; machine."""
    import casadi as ca

    y = exact_output(eq, eq.z, eq.u, eq.p, eq.t, ca.vertcat(eq.y, eq.energy, eq.dissipated, physical(eq)))
    return ca.Function("output", [eq.z, eq.u, eq.p, eq.t], [y], ["z", "u", "p", "t"], ["y"])


def _with_slope(description: Description) -> Description:
    """PythonFMU cannot take input derivatives, so the slope of the force is an input of its own, behind all others."""
    unit = units.compose("X/s", description.variables[description.reference("F")].unit)
    slope = Variable("F_rate", "slope", 0, unit, "slope of F over the coming steps", 0.0)
    return replace(description, variables=(*description.variables, slope))


def _model_json(description: Description) -> str:
    keys = ("name", "role", "index", "start", "min", "max")
    computed = sorted(
        (v for v in description.variables if v.causality in ("output", "calculatedParameter")),
        key=lambda v: v.role == "physical",
    )
    outputs = [v.name for v in computed]
    variables = [
        {key: asdict(v)[key] for key in keys}
        | {"causality": v.causality, "variability": v.variability, "initial": v.initial}
        | ({"role": "output", "index": outputs.index(v.name)} if v.name in outputs else {})
        for v in description.variables
    ]
    model = {
        "identifier": description.identifier,
        "variables": variables,
        "follows": description.follows,
        "state_of_fit": description.state,
    }
    return json.dumps(model, indent=1) + "\n"


@contextmanager
def _imports_undone(module: str) -> Iterator[None]:
    """PythonFMU imports the slave to look at it; afterwards this process is as it was."""
    path = list(sys.path)
    try:
        yield
    finally:
        sys.path[:] = path
        sys.modules.pop(module, None)

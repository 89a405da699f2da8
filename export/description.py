"""The variables of an FMU: one table, from which modelDescription.xml, the C table and the Python slave are made."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .. import __version__
from ..errors import BadInput
from ..model import units
from ..model.equations import Equations, equations, signed
from ..simulate.core import internal_step
from .render import plain_text, render
from .smoothing import amplitude_of

if TYPE_CHECKING:
    from ..model import Oscillator

#: What the description of a start value ends with that each run has for itself: a phase.
OWN = ", another in each run"
#: Longest internal step, s, of a model that neither swings nor decays.
_STILL_STEP = 1e-3
#: Names that are a word of C or a device of Windows, so that no file or function can bear them.
_TAKEN = re.compile(
    "auto|break|case|char|const|continue|default|do|double|else|enum|extern|float|for|goto|if|inline|int|long|register|"
    "restrict|return|short|signed|sizeof|static|struct|switch|typedef|union|unsigned|void|volatile|while|"
    "aux|con|nul|prn|com[0-9]|lpt[0-9]",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class Variable:
    """One real variable.

    Attributes:
        name: as in the model file.
        role: ``input``, ``slope``, ``output``, ``parameter``, ``initial`` or ``longest-step``.
        index: within the role: which output, parameter or initial state.
        unit: in the notation of the model file.
        description: for an engineer.
        start: initial value; None for outputs.
        initial_knowns: names that an output depends on at the start; those of them that are inputs it
            depends on directly at every later time too.
    """

    name: str
    role: str
    index: int
    unit: str
    description: str
    start: float | None = None
    initial_knowns: tuple[str, ...] = ()

    @property
    def causality(self) -> str:
        """FMI's word for the role."""
        return {"input": "input", "slope": "input", "output": "output"}.get(self.role, "parameter")

    @property
    def variability(self) -> str:
        """FMI's word for when the value may change."""
        return {"parameter": "tunable", "initial": "fixed", "longest-step": "fixed"}.get(self.role, "continuous")

    @property
    def initial(self) -> str | None:
        """FMI's word for how the value starts; None for inputs, where FMI 2.0 forbids it."""
        return {"input": None, "output": "calculated"}.get(self.causality, "exact")

    @property
    def start_text(self) -> str | None:
        """The start value with as many digits as it takes to come back to the last bit."""
        return None if self.start is None else repr(float(self.start))


@dataclass(frozen=True)
class Description:
    """What an importer needs to know; the value reference of a variable is its place in ``variables``.

    ``follows`` holds for each state the index of the one that its start value is counted from, or None.
    """

    name: str
    identifier: str
    equation: str
    variables: tuple[Variable, ...]
    stop_time: float
    step_size: float
    follows: tuple[int | None, ...] = (None, None)

    def reference(self, name: str) -> int:
        """Value reference of the variable of that name."""
        return next(i for i, variable in enumerate(self.variables) if variable.name == name)

    def units(self) -> dict[str, dict[str, int] | None]:
        """SI base exponents of every unit used; None where a unit (counts, say) has none that are known."""
        names = dict.fromkeys(variable.unit for variable in self.variables)
        return {name: units.base_exponents(name) if _is_si(name) else None for name in names}


def describe_fmu(oscillator: Oscillator) -> Description:
    """Table of the FMU's variables.

    Raises:
        BadInput: where a value is not a finite number or a unit cannot be read.
    """
    eq = equations(oscillator)
    length = oscillator.response.displacement_unit
    speed, acceleration = (units.compose(template, length) for template in ("X/s", "X/s2"))
    response = oscillator.response
    outputs = {
        "x": (response.unit, f"response as recorded: {response.quantity}"),
        "displacement": (length, "displacement"),
        "velocity": (speed, "velocity"),
        "acceleration": (acceleration, "acceleration"),
    }
    force = Variable("F", "input", 0, oscillator.force_unit, "excitation force, positive along x", 0.0)
    if oscillator.mass is None:
        text = "excitation force per unit mass, positive along x (the mass was not identified)"
        force = replace(force, unit=acceleration, description=text)
    knowns = _dependencies(eq)
    descriptions = oscillator.descriptions()
    variables = [force]
    variables += [Variable(n, "output", i, *outputs[n], None, knowns[n]) for i, n in enumerate(eq.output_names)]
    for i, (name, parameter) in enumerate(oscillator.parameters().items()):
        if not math.isfinite(parameter.value):
            raise BadInput(
                f"parameter {name!r} is {parameter.value}; an FMU needs a finite number, so identify it first"
            )
        variables.append(Variable(name, "parameter", i, parameter.unit, descriptions[name], parameter.value))
    variables += [
        Variable("x0", "initial", 0, length, "displacement at the start", 0.0),
        Variable("v0", "initial", 1, speed, "velocity at the start", 0.0),
        *_inner_starts(oscillator, eq),
        Variable(
            "max_step",
            "longest-step",
            0,
            "s",
            "longest internal step: a seventy-fifth of the fastest period of the identified model; "
            "shorten it when changed parameters make the motion faster",
            _longest_step(oscillator),
        ),
    ]
    stop = _stop_time(oscillator.omega0.value)
    name = plain_text(oscillator.name) or "oscillator"
    equation = plain_text(oscillator.equation())
    identifier = identifier_of(oscillator.name)
    return Description(name, identifier, equation, tuple(variables), stop, stop / 1e4, eq.follows)


def _inner_starts(oscillator: Oscillator, eq: Equations) -> list[Variable]:
    """Start values of the laws' inner states, each from what it follows or from zero."""
    response = oscillator.response
    found = []
    for i, (name, state) in enumerate(zip(eq.state_names[2:], eq.inner, strict=True), start=2):
        law, _, own = name.rpartition(".")
        leader = eq.follows[i]
        beyond = "" if leader is None else f", beyond {('x0', 'v0')[leader]}"
        unit = units.compose(state.unit, response.displacement_unit, oscillator.force_unit, response.unit)
        text = f"{law}: start value of its {own}{beyond}{OWN if state.free else ''}"
        found.append(Variable(f"{name}0", "initial", i, unit, text, 0.0))
    return found


def identifier_of(name: str) -> str:
    """A C identifier made from a model's name, fit to be the name of a file on every system."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", name)[:60].strip("_") or "oscillator"
    if plain[0].isdigit():
        plain = f"model_{plain}"
    return f"{plain}_model" if _TAKEN.fullmatch(plain) else plain


def model_description(
    description: Description, guid: str, *, source_files: tuple[str, ...] = (), tool: str = "", python: bool = False
) -> str:
    """Text of modelDescription.xml (FMI 2.0, co-simulation).

    Args:
        description: the variables.
        guid: what ties this text to the binary.
        source_files: what to compile below ``sources``.
        tool: further words on what made the FMU.
        python: whether the binary is PythonFMU's, which cannot interpolate inputs.
    """
    index = {variable.name: i + 1 for i, variable in enumerate(description.variables)}
    inputs = {variable.name for variable in description.variables if variable.causality == "input"}

    def places(names: tuple[str, ...], wanted: set[str]) -> str:
        return " ".join(str(index[name]) for name in sorted(names, key=index.__getitem__) if name in wanted)

    outputs = [variable for variable in description.variables if variable.causality == "output"]
    structure = [
        (index[v.name], places(v.initial_knowns, inputs), places(v.initial_knowns, set(index))) for v in outputs
    ]
    return render(
        "modelDescription.xml.j2",
        description=description,
        guid=guid,
        tool=f"dashpot {__version__}" + (f" with {tool}" if tool else ""),
        units=description.units(),
        structure=structure,
        source_files=source_files,
        python=python,
    )


def _is_si(unit: str) -> bool:
    return all(symbol in units.SYMBOLS for symbol in units.factors(unit))


def _dependencies(eq: Equations) -> dict[str, tuple[str, ...]]:
    """For each output the names of inputs, parameters and initial values that it is a function of at the start."""
    import casadi as ca

    y = signed(eq, eq.y)
    symbols = {"F": eq.u, **{name: eq.p[i] for i, name in enumerate(eq.parameter_names)}}
    for i, name in enumerate(("x0", "v0", *(f"{name}0" for name in eq.state_names[2:]))):
        riders = [eq.z[k] for k, leader in enumerate(eq.follows) if leader == i]
        symbols[name] = ca.vertcat(eq.z[i], *riders)
    return {
        output: tuple(name for name, symbol in symbols.items() if ca.depends_on(y[i], symbol))
        for i, output in enumerate(eq.output_names)
    }


def _longest_step(oscillator: Oscillator) -> float:
    try:
        return internal_step(oscillator, oscillator.values(), amplitude_of(oscillator))
    except BadInput:  # no spring and no damper: any step will do
        return _STILL_STEP


def _stop_time(omega0: float) -> float:
    """A hundred periods, rounded up to a power of ten: the default experiment."""
    periods = 100.0 * 2.0 * math.pi / omega0 if omega0 > 0.0 else 10.0
    return 10.0 ** math.ceil(math.log10(periods))

"""The variables of an FMU: one table, from which modelDescription.xml, the C table and the Python slave are made."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..errors import BadInput
from ..model import units
from ..model.covered import CLEARLY
from ..model.equations import PAYLOAD, Equations, SurfaceKind, signed
from ..model.fit_state import state_of_fit
from ..model.law import Expression
from ..model.oscillator import HOLDS
from ..model.physical import QUANTITIES, physical
from .experiment import Experiment, experiment
from .facts import Facts
from .render import plain_text
from .smoothing import MotionSize

if TYPE_CHECKING:
    from ..model import Oscillator
    from ..model.oscillator import Range
#: What the description of a start value ends with that each run has for itself: a phase.
OWN = ", another in each run"
#: Names that are a word of C or a device of Windows, so that no file or function can bear them.
_TAKEN = re.compile(
    "auto|break|case|char|const|continue|default|do|double|else|enum|extern|float|for|goto|if|inline|int|long|register|"
    "restrict|return|short|signed|sizeof|static|struct|switch|typedef|union|unsigned|void|volatile|while|"
    "aux|con|nul|prn|com[0-9]|lpt[0-9]",
    re.IGNORECASE,
)


#: FMI's words for each role: causality and variability.
_WORDS = {
    "input": ("input", "continuous"),
    "slope": ("input", "continuous"),
    "output": ("output", "continuous"),
    "power": ("output", "continuous"),
    "swing": ("output", "discrete"),
    "outside": ("output", "discrete"),
    "outside-given": ("output", "continuous"),
    "state": ("local", "continuous"),
    "derivative": ("local", "continuous"),
    "indicator": ("local", "continuous"),
    "time": ("independent", "continuous"),
    "parameter": ("parameter", "tunable"),
    "initial": ("parameter", "fixed"),
    "longest-step": ("parameter", "fixed"),
    "smoothing": ("parameter", "tunable"),
    "extrapolation": ("parameter", "fixed"),
    "physical": ("calculatedParameter", "tunable"),
    "motion": ("input", "continuous"),
    "channel": ("input", "continuous"),
}


@dataclass(frozen=True)
class Variable:
    """One real variable.

    Attributes:
        name: as in the model file.
        role: what it is to the model: a key of ``_WORDS``.
        index: within the role: which output, parameter, state.
        unit: in the notation of the model file.
        description: for an engineer.
        start: initial value; None for what is computed.
        knowns: names of inputs, states and time that it is computed from.
        initial_knowns: names of inputs, parameters and start values that it depends on at the start.
        derivative_of: name of the state whose derivative it is.
        nominal: typical size of a state.
        min, max: bounds; None for none.
    """

    name: str
    role: str
    index: int
    unit: str
    description: str
    start: float | None = None
    knowns: tuple[str, ...] = ()
    initial_knowns: tuple[str, ...] = ()
    derivative_of: str | None = None
    nominal: float | None = None
    min: float | None = None
    max: float | None = None

    @property
    def causality(self) -> str:
        """FMI's word for the role."""
        return _WORDS[self.role][0]

    @property
    def variability(self) -> str:
        """FMI's word for when the value may change."""
        return _WORDS[self.role][1]

    @property
    def initial(self) -> str | None:
        """FMI's word for how the value starts; None where FMI forbids it."""
        return {"input": None, "independent": None, "parameter": "exact"}.get(self.causality, "calculated")

    @property
    def start_text(self) -> str | None:
        """The start value with as many digits as it takes to come back to the last bit."""
        return None if self.start is None else repr(float(self.start))

    @property
    def nominal_text(self) -> str | None:
        """The nominal value likewise."""
        return None if self.nominal is None else repr(float(self.nominal))


@dataclass(frozen=True)
class Covered:
    """What the recordings covered of a variable, and from where on a value is clearly outside."""

    name: str
    unit: str
    low: float
    high: float
    least: float
    most: float

    def __str__(self) -> str:
        return f"{self.name} {self.low:.4g} to {self.high:.4g} {self.unit}"

    @classmethod
    def of_amplitude(cls, covered: Range) -> Covered:
        """Of an oscillator's amplitude, which has its slack as a part of each end."""
        return cls("amplitude", covered.unit, covered.min, covered.max, covered.min / CLEARLY, covered.max * CLEARLY)

    @classmethod
    def of_span(cls, name: str, unit: str, low: float, high: float) -> Covered:
        """Of a variable that goes both ways."""
        slack = (CLEARLY - 1.0) * 0.5 * (high - low)
        return cls(name, unit, low, high, low - slack, high + slack)


@dataclass(frozen=True)
class Description:
    """What an importer needs to know; the value reference of a variable is its place in ``variables``.

    Attributes:
        name, identifier, equation: of the model.
        state: what must be known of its fit; empty: nothing. See ``state_of_fit``.
        variables: all of them.
        experiment: what an importer runs that is told nothing.
        follows: for each state the index of the one that its start value is counted from, or None.
        ranges: of each switching surface the size that it goes through, in its unit.
        nominals: typical size of each state.
        covered: what the recordings covered of variables; ``outside_range`` says that one has left it.
    """

    name: str
    identifier: str
    equation: str
    variables: tuple[Variable, ...]
    experiment: Experiment
    follows: tuple[int | None, ...] = (None, None)
    ranges: tuple[float, ...] = ()
    nominals: tuple[float, ...] = (1.0, 1.0)
    covered: tuple[Covered, ...] = ()
    state: str = ""

    @property
    def words(self) -> str:
        """The equation, and what must be known of the fit."""
        return f"{self.equation}. Take note: {self.state}." if self.state else self.equation

    def reference(self, name: str) -> int:
        """Value reference of the variable of that name."""
        return next(i for i, variable in enumerate(self.variables) if variable.name == name)

    def place(self, role: str) -> int | None:
        """Value reference of the first variable in that role."""
        return next((i for i, variable in enumerate(self.variables) if variable.role == role), None)

    @property
    def given(self) -> int:
        """How many of the first states are inputs, of a motion that is given."""
        return sum(variable.role == "motion" for variable in self.variables)

    def units(self) -> dict[str, dict[str, int] | None]:
        """SI base exponents of every unit used; None where a unit (counts, say) has none that are known."""
        names = dict.fromkeys(variable.unit for variable in self.variables)
        return {name: units.base_exponents(name) if _is_si(name) else None for name in names}


def describe_fmu(facts: Facts, *, version: int = 2, continuous: bool = True, payload: bool = True) -> Description:
    """Table of the FMU's variables.

    Args:
        facts: of the model.
        version: of FMI: 3 has no call for the slope of an input, so that it is an input of its own, ``F_rate``, and
            wants time and event indicators among the variables.
        continuous: with what model exchange needs: states and derivatives.
        payload: of an FMU: with what a load and the machine's own quantities need, and its default experiment.

    Raises:
        BadInput: where a value is not a finite number or a unit cannot be read.
    """
    oscillator, eq, size = facts.oscillator, facts.loaded if payload else facts.equations, facts.size
    length = oscillator.response.displacement_unit
    speed, acceleration = (units.compose(template, length) for template in ("X/s", "X/s2"))
    force = Variable("F", "input", 0, oscillator.force_unit, oscillator.input_words, 0.0)
    if oscillator.mass is None:
        force = replace(force, unit=acceleration)
    elif oscillator.hold != "smooth":
        force = replace(force, description=f"{force.description}; {HOLDS[oscillator.hold]} in the recordings")
    descriptions, bounds = oscillator.descriptions(), oscillator.bounds()
    known, state_units = Knowns(eq), [length, speed, *_inner_units(oscillator, eq)]
    if eq.payload:
        over = oscillator.over_what_drives
        descriptions["mass"] = f"moving mass of the recordings{over}, by which all forces scale; a load is {PAYLOAD}"
    variables = [force, *_outputs(oscillator, eq, known, size if continuous else None)]
    for i, (name, parameter) in enumerate(oscillator.parameters().items()):
        if not math.isfinite(parameter.value):
            raise BadInput(
                f"parameter {name!r} is {parameter.value}; an FMU needs a finite number, so identify it first"
            )
        low, high = holding(bounds[name], parameter.value)
        variables.append(
            Variable(name, "parameter", i, parameter.unit, descriptions[name], parameter.value, min=low, max=high)
        )
    variables += [
        *_machine(oscillator, eq, known),
        Variable("x0", "initial", 0, length, "displacement at the start", 0.0),
        Variable("v0", "initial", 1, speed, "velocity at the start", 0.0),
        *inner_starts(eq, state_units, ("x0", "v0")),
        Variable(
            "max_step",
            "longest-step",
            0,
            "s",
            "longest internal step: a seventy-fifth of the fastest period of the identified model; "
            "shorten it when changed parameters make the motion faster",
            facts.max_step,
            min=0.0,
        ),
    ]
    if continuous:
        text = (
            "co-simulation without a slope of F: 0 holds F over a step, 1 goes on in a straight line from the last two "
            "values that were set"
        )
        variables += [
            smoothing_variable(),
            Variable("extrapolation", "extrapolation", 0, "1", text, 0.0, min=0.0, max=1.0),
            *integrated(eq, known, size, state_units, indicators=version == 3),
        ]
    if version == 3:
        rate = units.compose("X/s", force.unit)
        variables += [
            Variable("time", "time", 0, "s", "time"),
            Variable("F_rate", "slope", 0, rate, "slope of F over the coming communication steps", 0.0),
        ]
    covered = oscillator.amplitude
    return Description(
        plain_text(oscillator.name) or "oscillator",
        identifier_of(oscillator.name),
        plain_text(oscillator.equation()),
        tuple(variables),
        experiment(facts.natural[0] if payload else oscillator.omega0.value),
        eq.follows,
        size.ranges,
        size.nominals,
        (Covered.of_amplitude(covered),) if covered is not None else (),
        state_of_fit(oscillator) or "",
    )


def holding(bounds: tuple[float, float], value: float) -> tuple[float | None, float | None]:
    """Bounds that are finite, but for those that the value itself breaks: a fit may find what no machine has."""
    low, high = bounds
    return (
        low if math.isfinite(low) and low <= value else None,
        high if math.isfinite(high) and value <= high else None,
    )


def _machine(oscillator: Oscillator, eq: Equations, known: Knowns) -> list[Variable]:
    """The payload, and the machine in kg, N/m and N; nothing where the mass is not known."""
    if oscillator.mass is None or not eq.payload:
        return []
    mass, length = oscillator.mass, oscillator.response.displacement_unit
    text = "mass carried beyond that of the recordings; springs, dampers and friction stay what they are"
    place = eq.parameter_names.index(PAYLOAD)
    variables = [
        Variable(PAYLOAD, "parameter", place, mass.unit, text, 0.0, min=-mass.value if mass.value > 0 else None)
    ]
    expressions = physical(eq)
    for i, (name, unit, words) in enumerate(QUANTITIES):
        composed = unit if unit == "Hz" else units.compose(unit, length, oscillator.force_unit)
        variables.append(Variable(name, "physical", i, composed, words, None, (), known.of(expressions[i])[1]))
    return variables


def _outputs(oscillator: Oscillator, eq: Equations, known: Knowns, size: MotionSize | None) -> list[Variable]:
    """What the FMU gives: the response as recorded first, energy and power, the amplitude and whether it is covered."""
    response = oscillator.response
    length = response.displacement_unit
    speed, acceleration = (units.compose(template, length) for template in ("X/s", "X/s2"))
    outputs = {
        "x": (response.unit, f"response as recorded: {response.quantity}"),
        "displacement": (length, "displacement"),
        "velocity": (speed, "velocity"),
        "acceleration": (acceleration, "acceleration"),
    }
    nominals = {} if size is None else {"displacement": size.nominals[0], "velocity": size.nominals[1]}
    variables = [
        Variable(name, "output", i, *outputs[name], None, *known.of(eq.y[i]), nominal=nominals.get(name))
        for i, name in enumerate(eq.output_names)
    ]
    energy, power = oscillator.energy_units
    per_mass = "" if oscillator.mass is not None else " per unit mass"
    variables += [
        Variable("energy", "power", 0, energy, f"kinetic and stored energy{per_mass}", None, *known.of(eq.energy)),
        Variable(
            "dissipated_power",
            "power",
            1,
            power,
            f"power{per_mass} that friction and dampers take from the motion",
            None,
            *known.of(eq.dissipated),
        ),
    ]
    if size is None:
        return variables
    covered = oscillator.amplitude
    stated = "no range is stated" if covered is None else f"{covered.min:.4g} to {covered.max:.4g} {covered.unit}"
    return [
        *variables,
        Variable("amplitude", "swing", 0, length, "amplitude: half the way between the latest two turning points"),
        Variable(
            "outside_range",
            "outside",
            0,
            "1",
            f"1 where the amplitude is above what the model was identified in, -1 below it, else 0 ({stated})",
        ),
    ]


def smoothing_variable() -> Variable:
    """The choice of a smooth law, for importers that locate no events."""
    text = (
        "model exchange only: 0 changes signs at located events; above 0, for importers that locate none, they are "
        "tanh over this part of the motion (1e-3, say), and nothing sticks"
    )
    return Variable("smoothing", "smoothing", 0, "1", text, 0.0, min=0.0)


def integrated(
    eq: Equations, known: Knowns, size: MotionSize, state_units: Sequence[str], *, given: int = 0, indicators: bool
) -> list[Variable]:
    """What an importer's integrator needs: inner states, derivatives and event indicators.

    Args:
        eq: the equations.
        known: what their expressions depend on.
        size: of the motion.
        state_units: of each state.
        given: how many of the first states are inputs, which have no derivatives.
        indicators: whether event indicators are among the variables.
    """
    variables, names = [], eq.state_names
    for i, name in enumerate(names[2:], start=2):
        law, _, own = name.rpartition(".")
        text, starts = f"{law}: inner state {own}", known.of(eq.z[i])[1]
        variables.append(Variable(name, "state", i, state_units[i], text, None, (), starts, nominal=size.nominals[i]))
    for i, name in enumerate(names[given:], start=given):
        text, rate = f"rate of {name}", units.compose("X/s", state_units[i])
        variables.append(
            Variable(f"der({name})", "derivative", i, rate, text, None, *known.of(eq.zdot[i]), derivative_of=name)
        )
    if indicators:
        for i, surface in enumerate(size.surfaces):
            text = f"falls to zero where the sign of {plain_text(surface.text)} changes, or the motion breaks away"
            variables.append(Variable(f"event({i + 1})", "indicator", i, "1", text, None, *known.of_event(eq, i)))
    return variables


def _inner_units(oscillator: Oscillator, eq: Equations) -> list[str]:
    response = oscillator.response
    length = response.displacement_unit
    return [units.compose(state.unit, length, oscillator.force_unit, response.unit) for state in eq.inner]


def inner_starts(eq: Equations, state_units: Sequence[str], leaders: tuple[str, str]) -> list[Variable]:
    """Start values of the laws' inner states, each from what it follows or from zero.

    ``leaders`` are the names of displacement and velocity at the start, ``state_units`` the units of all states.
    """
    variables = []
    for i, (name, state) in enumerate(zip(eq.state_names[2:], eq.inner, strict=True), start=2):
        law, _, own = name.rpartition(".")
        leader = eq.follows[i]
        beyond = "" if leader is None else f", beyond {leaders[leader]}"
        text = f"{law}: start value of its {own}{beyond}{OWN if state.free else ''}"
        variables.append(Variable(f"{name}0", "initial", i, state_units[i], text, 0.0))
    return variables


def identifier_of(name: str) -> str:
    """A C identifier made from a model's name, fit to be the name of a file on every system."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", name)[:60].strip("_") or "oscillator"
    if plain[0].isdigit():
        plain = f"model_{plain}"
    return f"{plain}_model" if _TAKEN.fullmatch(plain) else plain


def _is_si(unit: str) -> bool:
    return all(symbol in units.SYMBOLS for symbol in units.factors(unit))


# Which inputs, states and start values an expression of the model depends on: FMI's dependencies.


class Knowns:
    """Names of what expressions of the equations ``eq`` depend on.

    ``driven`` is the name of the input, ``first`` are those of displacement and velocity at the start, and ``beside``
    those of further inputs that the equations have among their parameters, last and in their order.
    """

    def __init__(
        self, eq: Equations, driven: str = "F", first: tuple[str, str] = ("x0", "v0"), beside: Sequence[str] = ()
    ) -> None:
        import casadi as ca

        self._eq = eq
        states = {name: eq.z[i] for i, name in enumerate(eq.state_names)}
        count = len(eq.parameter_names)
        further = {name: eq.p[count - len(beside) + i] for i, name in enumerate(beside)}
        self._knowns = {driven: eq.u, **further, **states, "time": eq.t}
        starts = {}
        for i, name in enumerate((*first, *(f"{name}0" for name in eq.state_names[2:]))):
            riders = [eq.z[k] for k, leader in enumerate(eq.follows) if leader == i]
            starts[name] = ca.vertcat(eq.z[i], *riders)
        own = enumerate(eq.parameter_names[: count - len(beside)])
        parameters = {name: eq.p[i] for i, name in own} | further
        self._initial = {driven: eq.u, **parameters, **starts, "time": eq.t}

    def of(self, expression: Expression) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of the inputs and states it is computed from; of inputs, parameters and start values at the start."""
        import casadi as ca

        written = signed(self._eq, expression)
        switched = bool(self._eq.kinds) and ca.depends_on(expression, self._eq.s)
        return (
            tuple(name for name, symbol in self._knowns.items() if ca.depends_on(written, symbol)),
            (
                *(name for name, symbol in self._initial.items() if ca.depends_on(written, symbol)),
                *(["smoothing"] if switched else []),
            ),
        )

    def of_event(self, eq: Equations, surface: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The same for an event indicator; at rest that of the velocity is how far the forces are from moving it."""
        import casadi as ca

        if eq.kinds[surface] is not SurfaceKind.VELOCITY:
            return self.of(eq.surfaces[surface])
        return self.of(ca.vertcat(eq.surfaces[surface], eq.zdot[1]))

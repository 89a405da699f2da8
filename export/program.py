"""What an export as program text states, in any language: names, values, words, and the functions to write out."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import __version__
from ..errors import BadInput
from ..model.equations import Equations, signed
from ..simulate.casadi_step import exact_field, exact_output
from ..templates import template
from .casadi_functions import depends_on_time
from .description import Description, describe_fmu
from .facts import Facts
from .plain_c import about, comment, state_words, symbols, units_of_states, value_words
from .smoothing import Surface, surfaces

#: Names that no parameter or state may have, in none of the languages: their own words, and those of the templates.
_RESERVED = frozenset(
    [
        "and",
        "as",
        "break",
        "case",
        "catch",
        "class",
        "continue",
        "def",
        "del",
        "der",
        "each",
        "else",
        "elseif",
        "elsewhen",
        "end",
        "equation",
        "except",
        "false",
        "final",
        "flow",
        "for",
        "from",
        "function",
        "global",
        "if",
        "import",
        "in",
        "initial",
        "input",
        "is",
        "lambda",
        "loop",
        "model",
        "nonlocal",
        "not",
        "or",
        "otherwise",
        "output",
        "parameter",
        "parfor",
        "pass",
        "persistent",
        "pre",
        "public",
        "raise",
        "record",
        "replaceable",
        "return",
        "then",
        "time",
        "true",
        "try",
        "type",
        "when",
        "while",
        "with",
        "within",
        "yield",
        "F",
        "p",
        "q",
        "t",
        "u",
        "x",
        "y",
        "xp",
        "zero",
        "mode",
        "side",
        "hold",
        "step",
        "push",
        "seated",
        "abs",
        "acceleration",
        "choose",
        "error",
        "exp",
        "inf",
        "max",
        "min",
        "pi",
        "sign",
        "sin",
    ]
)
_WIDTH = 100


@dataclass(frozen=True)
class Entry:
    """A parameter, state, input or output: its name in the model and in the program, its unit, and words on it."""

    name: str
    symbol: str
    unit: str
    words: str
    value: float = 0.0
    least: float | None = None
    most: float | None = None


@dataclass(frozen=True)
class Program:
    """A model as the exports write it.

    Attributes:
        eq: the equations.
        description: the table of variables, of which units and words are.
        parameters, states, outputs: in the order of ``eq``; a state's ``value`` is its nominal size.
        force: the input.
        surfaces: where signs change, with the widths of their smooth form.
        follows: for each state the place of the one whose start value its own is counted from, or None.
        equation, about: lines of ASCII for a comment.
    """

    name: str
    software: str
    eq: Equations
    description: Description
    parameters: tuple[Entry, ...]
    states: tuple[Entry, ...]
    outputs: tuple[Entry, ...]
    force: Entry
    surfaces: tuple[Surface, ...]
    equation: tuple[str, ...]
    about: tuple[str, ...]
    longest: float

    @property
    def follows(self) -> tuple[int | None, ...]:
        """For each state the place of the one whose start value its own is counted from, or None."""
        return self.eq.follows

    @property
    def timed(self) -> bool:
        """Whether a law depends on the time itself."""
        return depends_on_time(self.eq)

    @property
    def inputs(self) -> list[list[str]]:
        """Names of the elements of what the functions take: states, force, parameters, time."""
        return [[state.symbol for state in self.states], ["F"], [p.symbol for p in self.parameters], ["t"]]


def program(facts: Facts) -> Program:
    """The model as program text needs it.

    Raises:
        BadInput: where a value is not finite, or the model's motion is too fast to be followed.
    """
    oscillator, eq = facts.oscillator, facts.equations
    description = describe_fmu(facts)
    variables = {variable.name: variable for variable in description.variables}
    names = [*eq.state_names, *eq.parameter_names]
    known = dict(zip(names, _names(names), strict=True))
    words, values = oscillator.descriptions(), oscillator.parameters()
    parameters = tuple(
        Entry(
            name,
            known[name],
            p.unit,
            f"{value_words(p)} {p.unit}: {comment(words[name])}",
            p.value,
            variables[name].min,
            variables[name].max,
        )
        for name, p in values.items()
    )
    starts = {v.index: v for v in description.variables if v.role == "initial"}
    states = tuple(
        Entry(name, known[name], starts[i].unit, text, size)
        for i, (name, text, size) in enumerate(
            zip(eq.state_names, state_words(units_of_states(description), eq), description.nominals, strict=True)
        )
    )
    outputs = tuple(
        Entry(v.name, v.name, v.unit, comment(v.description)) for v in description.variables if v.role == "output"
    )
    force = description.variables[description.reference("F")]
    lines = [comment(line) for line in description.equation.split("; ")]
    return Program(
        comment(description.name),
        f"dashpot {__version__}",
        eq,
        description,
        parameters,
        states,
        outputs,
        Entry("F", "F", force.unit, comment(force.description)),
        tuple(surfaces(oscillator, eq, facts.sample)),
        tuple(piece for line in lines for piece in textwrap.wrap(line, _WIDTH, subsequent_indent="    ")),
        tuple(
            piece
            for text in about(oscillator, description)
            for piece in textwrap.wrap(comment(text).replace('"', "'"), _WIDTH)
        ),
        facts.max_step,
    )


def _names(names: list[str]) -> list[str]:
    """A name of every language for each name, no two alike."""
    plain = [f"_{name}" if name[:1].isdigit() else name for name in names]
    made = symbols([f"{name}_" if name in _RESERVED else name for name in plain])
    return [f"a_{name}" if re.fullmatch(r"[a-z]\d+|_.*", name) else name for name in made]


def functions(of: Program) -> dict[str, Any]:
    """casadi.Functions of states, force, parameters and time: ``exact`` and ``smooth`` rates, and ``output``."""
    import casadi as ca

    eq = of.eq
    z, u, p, t = ca.SX.sym("z", eq.z.numel()), ca.SX.sym("u"), ca.SX.sym("p", eq.p.numel()), ca.SX.sym("t")
    widths = ca.DM([surface.width for surface in of.surfaces]) if of.surfaces else None
    plain = ca.Function("plain", [eq.z, eq.u, eq.p, eq.t], [signed(eq, eq.zdot, widths)])
    made = {
        "exact": exact_field(eq, z, u, p, t),
        "smooth": plain(z, u, p, t),
        "output": exact_output(eq, z, u, p, t),
    }
    return {name: ca.Function(name, [z, u, p, t], [ca.densify(value)]) for name, value in made.items()}


def filled(file: str, /, **values: Any) -> str:
    """The template of that name with values as they are, for a text that is neither XML nor HTML."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    return environment.from_string(template(file)).render(**values)


def named_after_file(path: Path, language: str) -> str:
    """The name that a file gives to what is in it; raises BadInput where it is no name of the language."""
    stem = path.stem
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,62}", stem) or stem in _RESERVED:
        raise BadInput(
            f"{path}: {language} takes the name of what is in it from the file, and {stem!r} is none; begin it with a "
            "letter and go on with letters, digits and _, such as rig_2"
        )
    return stem

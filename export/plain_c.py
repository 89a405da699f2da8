"""An oscillator as two files of plain C, for a host of one's own or a microcontroller: ``OUT.c`` and ``OUT.h``.

The source is one translation unit: the generated law, the engine, and a few functions named after the model. All else
in it is static, so that several models go into one program.
"""

from __future__ import annotations

import re
import textwrap
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__, engine
from ..errors import BadInput
from ..files.writing import together, write
from ..model import units
from ..model.equations import Equations
from ..model.physical import in_machine_units
from ..model.show import value_and_error
from ..simulate.law_source import law_source
from ..templates import template
from .description import Description, describe_fmu
from .facts import Facts

if TYPE_CHECKING:
    from ..model import Oscillator, Parameter, Provenance, Range

#: Internal steps in one call; the engine counts them in an int, which on a small machine ends at 32767.
_MOST_STEPS = 30000
_WIDTH = 108
_PLAIN = str.maketrans(
    {"⁰": "^0", "¹": "^1", "²": "^2", "³": "^3", "⁴": "^4", "⁵": "^5", "±": "+/-", "·": ".", "–": "-", "−": "-"}
)


class Program(str):
    """C text of ours, which stands as it is."""


def export_plain_c(oscillator: Oscillator, path: str | Path) -> tuple[Path, Path]:
    """Write the model as C source and header; the same model gives the same bytes.

    Args:
        oscillator: the model.
        path: ``OUT.c``; the header goes beside it under the same name.

    Returns:
        The paths of source and header.

    Raises:
        BadInput: where a value of the model is not finite, the name cannot stand in an ``#include``, or the path
            cannot be written.
    """
    return write_c(path, lambda header: plain_c(Facts(oscillator), header))


def write_c(path: str | Path, made: Callable[[str], tuple[str, str]]) -> tuple[Path, Path]:
    """Write source and header, whose texts are ``made`` for the name of the header; as ``export_plain_c``."""
    source = Path(path)
    header = source.with_suffix(".h")
    if not header.name.isprintable() or any(mark in header.name for mark in ('"', "\\", "??")):
        raise BadInput(f"{source}: this name cannot stand in an #include of C; choose letters, digits and hyphens")
    with together():
        for target, text in zip((source, header), made(header.name), strict=True):
            write(target, text)
    return source, header


def plain_c(facts: Facts, header: str) -> tuple[str, str]:
    """Text of the C source and of its header, which the source includes by the name ``header``.

    Raises BadInput where a value of the model is not finite.
    """
    oscillator, eq, description = facts.oscillator, facts.equations, describe_fmu(facts, payload=False)
    words = _words(oscillator, description, eq)
    return c_texts(header, description, eq, list(facts.values.values()), words)


def c_texts(
    header: str, description: Description, eq: Equations, numbers: Sequence[float], words: Mapping[str, Any]
) -> tuple[str, str]:
    """Text of the C source and of its header.

    Args:
        header: the name by which the source includes it.
        description: the variables.
        eq: the equations.
        numbers: values of their parameters.
        words: everything that a person reads: see ``c_words``.
    """
    prefix = prefix_of(description.identifier)
    values: dict[str, Any] = {
        "id": prefix,
        "header": header,
        "most_steps": _MOST_STEPS,
        "values": [repr(float(value)) for value in numbers],
        "longest": description.variables[description.reference("max_step")].start_text,
        "follows": ", ".join("-1" if leader is None else str(leader) for leader in eq.follows),
        **words,
    }
    struct, declarations = _engine_header()
    sizes = {"DP_NZ": eq.z.numel(), "DP_NP": eq.p.numel(), "DP_NS": len(eq.kinds)}
    declared = render_c("plain.h.j2", {**values, "members": Program(_sized(struct, sizes))})
    sources = engine.engine_texts() | {"engine.h": ""}
    parts = [
        f"/* {comment(description.name)}: one {words['thing']} in plain C, made by dashpot {__version__}. */\n"
        f'#include "{header}"\n',
        own(law_source(eq)),
        f"typedef {prefix}_model dp_engine;\n\n{own(declarations)}",
        _amalgamated(sources, "engine.c"),
        render_c("plain.c.j2", values),
    ]
    return "\n".join(parts), declared


def _amalgamated(sources: dict[str, str], name: str) -> str:
    """A text with the texts in place of the lines that include them."""
    return re.sub(r'^#include "(.+)"\n', lambda m: _amalgamated(sources, m.group(1)), sources[name], flags=re.MULTILINE)


def prefix_of(identifier: str) -> str:
    """What the names of a model begin with: its identifier, kept apart from the engine's own ``dp_``."""
    return f"model_{identifier}" if identifier.lower().startswith("dp") else identifier


def own(text: str) -> str:
    """C text with every function that is declared or defined in it made the file's own (static)."""
    return re.sub(r"^(?=(?:void|int|double|casadi_real|casadi_int) \w+\()", "static ", text, flags=re.MULTILINE)


def _engine_header() -> tuple[str, str]:
    """Members of the engine's struct, and what else ``engine.h`` declares."""
    text = re.sub(
        r"^#(ifndef|define) DASHPOT_ENGINE_H\n", "", engine.text("engine.h"), flags=re.MULTILINE
    ).removesuffix("#endif\n")
    before, members, after = re.split(r"typedef struct \{\n(.*?)\n\} dp_engine;\n", text, flags=re.DOTALL)
    return members, before + after


def _sized(struct: str, numbers: dict[str, int]) -> str:
    """The members with numbers for the sizes of their arrays, which the header cannot know by name."""

    def size(match: re.Match[str]) -> str:
        return f"[{numbers[match.group(1)] + (1 if match.group(2) else 0)}]"

    return re.sub(r"; +/\*", "; /*", re.sub(r"\[(DP_N\w)( \+ 1)?\]", size, struct))


def _words(oscillator: Oscillator, description: Description, eq: Equations) -> dict[str, Any]:
    """Everything in the header that a person reads."""
    outputs = [(v.name, v.unit, v.description) for v in description.variables if v.role == "output"]
    lines, words = about(oscillator, description), oscillator.descriptions()
    for name, p in in_machine_units(oscillator).items():
        words[name] += f"; times the mass {value_words(p)} {p.unit}"
    return {
        **c_words(description, eq, lines, oscillator.parameters(), words, outputs, units_of_states(description)),
        "thing": "oscillator",
        "driven": "force",
        "given": False,
    }


def c_words(
    description: Description,
    eq: Equations,
    about: Sequence[str],
    parameters: Mapping[str, Parameter],
    words: Mapping[str, str],
    outputs: Sequence[tuple[str, str, str]],
    state_units: Sequence[str],
) -> dict[str, Any]:
    """What a person reads in the header of any model.

    Args:
        description: the variables.
        eq: the equations.
        about: what must be known of units and validity, one text a line or more.
        parameters: by their names, ``words`` on each.
        words: what each is.
        outputs: name, unit and meaning of each.
        state_units: of each state.
    """
    lines = [comment(line) for line in description.equation.split("; ")]
    return {
        "name": description.name,
        "software": f"dashpot {__version__}",
        "equation": [piece for line in lines for piece in textwrap.wrap(line, _WIDTH, subsequent_indent="    ")],
        "about": [piece for text in about for piece in textwrap.wrap(comment(text), _WIDTH)],
        "parameters": [
            (symbol, f"{value_words(parameters[name])} {parameters[name].unit}: {words[name]}")
            for symbol, name in zip(symbols(list(parameters)), parameters, strict=True)
        ],
        "states": list(zip(symbols(list(eq.state_names)), state_words(state_units, eq), strict=True)),
        "outputs": [
            (symbol, f"{unit}: {text}")
            for symbol, (_, unit, text) in zip(symbols([name for name, _, _ in outputs]), outputs, strict=True)
        ],
    }


def units_of_states(description: Description) -> list[str]:
    """Unit of each state, by its start value."""
    unit = {v.index: v.unit for v in description.variables if v.role == "initial"}
    return [unit[i] for i in range(len(unit))]


def state_words(unit: Sequence[str], eq: Equations) -> list[str]:
    """Unit of each state, and what its start value is where that is not the state itself."""
    comments = []
    for i, leader in enumerate(eq.follows):
        counted = "" if leader is None else f"; its start value is counted from the {eq.state_names[leader]}"
        comments.append(f"{unit[i]}{counted}{'; another in each run' if eq.free[i] else ''}")
    return comments


def symbols(names: list[str]) -> list[str]:
    """A C name for each name, no two alike."""
    symbols: list[str] = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9]+", "_", name)
        twins = sum(re.fullmatch(rf"{plain}(__\d+)?", other) is not None for other in symbols)
        symbols.append(f"{plain}__{twins + 1}" if twins else plain)
    return symbols


def about(o: Oscillator, description: Description) -> list[str]:
    """What a user must know of units and validity, one text a line or more."""
    force = description.variables[description.reference("F")]
    length = o.response.displacement_unit
    inside = (
        "The mass is not known: the input is a force per unit mass, as are all others."
        if o.mass is None
        else "Forces inside the bracket are per unit mass."
    )
    unit = f"x, the displacement, in {length}; time in s; input F in {force.unit}: {force.description}."
    valid, origin = valid_for({"amplitude": o.amplitude, "frequency": o.frequency}), origin_of(o.identified)
    speed, acceleration = units.compose("X/s", length), units.compose("X/s2", length)
    rates = f"Velocity in {speed}, acceleration in {acceleration}. {valid}."
    return [f"{inside} {unit}", rates, *origin, *noted(description)]


def noted(description: Description) -> list[str]:
    """What must be known of the fit, in a sentence; none where there is nothing."""
    return [f"Take note: {description.state}."] if description.state else []


def valid_for(covered: Mapping[str, Range | None]) -> str:
    """What the recordings covered, in words."""
    ranges = [f"{name} {r.min:.4g} to {r.max:.4g} {r.unit}" for name, r in covered.items() if r is not None]
    return f"Valid for {' and '.join(ranges)}, which the recordings covered" if ranges else "Validity: not stated"


def origin_of(identified: Provenance) -> list[str]:
    """What it was identified from, in a sentence; none where nobody says."""
    files = [str(r.get("file", "?")) for r in identified.recordings]
    how = " ".join(part for part in ("by", identified.method, identified.software) if part)
    return [f"Identified from {', '.join(files)}{'' if how == 'by' else ' ' + how}."] if files else []


def value_words(parameter: Parameter) -> str:
    """The value of a parameter with its standard error where it has one."""
    value, error = value_and_error(parameter)
    return f"{value} +/- {error}" if error else value


def comment(text: str) -> str:
    """``text`` fit to stand in a comment of C: one line of ASCII that neither ends the comment nor begins another."""
    plain = unicodedata.normalize("NFKD", text.translate(_PLAIN))
    plain = "".join(c for c in plain if not unicodedata.combining(c))
    plain = " ".join(re.sub(r"[^\x21-\x7e]", lambda m: " " if m.group().isspace() else "_", plain).split())
    plain = re.sub(r"(?<=\*)(?=/)|(?<=/)(?=\*)", " ", plain.replace("\\", "/"))
    return re.sub(r"\?(?=\?)", "? ", plain)  # three-character names for characters of old begin with two of them


def render_c(name: str, values: dict[str, Any]) -> str:
    """The template filled in; every value is made fit for a comment, which changes no identifier and no number."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        finalize=lambda value: value if isinstance(value, Program) else comment(str(value)),
    )
    return environment.from_string(template(name)).render(**values)

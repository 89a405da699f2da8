"""The model file, ``dashpot-model/1``: an oscillator as YAML that a person can read and a program can trust.

A model file is data. No tag and no alias of it is obeyed, every text of it is length-limited and printable, and every
problem is reported at once with its line and path.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.reading import content_of
from ..files.writing import write
from .laws import BASE
from .library import find
from .limits import LONGEST_NAME
from .oscillator import Band, Oscillator, Provenance, Range, Response, Term
from .parameter import Parameter

if TYPE_CHECKING:
    from .schema import IdentifiedForm, ModelForm, ParameterForm, RangeForm

#: Enough for as many characters as a model file may have.
_MOST_BYTES = 4_000_000
_PLAIN = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9_./()+ -]*[A-Za-z0-9_./()+-])?")


def load(path: str | os.PathLike[str]) -> Oscillator:
    """Read a model file.

    Raises:
        BadInput: the file cannot be read, or is not a model file; the text has one line a problem, in the form
            ``file: line N: $.path: what is wrong and what to do``.
    """
    return loads(text_at(path), os.fspath(path))


def text_at(path: str | os.PathLike[str]) -> str:
    """The text of a model file; raises BadInput where that is none."""
    where = os.fspath(path)
    try:
        return content_of(path, _MOST_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadInput(f"{where}: is not UTF-8 text, so not a model file; give the .yaml that identify wrote") from None
    except (OSError, ValueError) as error:  # ValueError: a name with a null byte
        raise BadInput(f"{where}: cannot be read ({_reason(error)}); check the path") from None


def loads(text: str, where: str = "model") -> Oscillator:
    """The oscillator in the text of a model file; ``where`` names it in messages. Raises BadInput as ``load``."""
    from ..files.yaml_loader import read_yaml
    from .consistency import free_names
    from .schema import checked

    document = read_yaml(text, where)
    return _oscillator(checked(document), free_names(document.data))


def dumps(oscillator: Oscillator) -> str:
    """The oscillator as the text of a model file.

    Values and covariance come back bit for bit, standard errors to four digits; characters that do not print
    become U+FFFD.
    """
    o = oscillator
    lines = ["# " + " ".join(o.equation().split()), "format: dashpot-model/1", f"name: {scalar_text(o.name)}"]
    base = ["mass", *(p.name for law in BASE for p in law.parameters)]
    lines += table({name: getattr(o, name) for name in base}, o.why_no_mass)
    lines += ["terms:"] if o.terms else ["terms: []"]
    for term in o.terms:
        lines += [f"  - effect: {scalar_text(term.effect)}", "    parameters:"]
        lines += [f"      {line}" for line in table(term.parameters)]
    lines.append(f"response: {flow({'quantity': o.response.quantity, 'unit': o.response.unit})}")
    unit = {"unit": o.force_unit} if o.force_unit != "N" else {}
    if o.mass is not None or unit or o.hold != "smooth":
        lines.append(f"excitation: {flow({**unit, 'hold': o.hold})}")
    ranges = {name: span for name in ("amplitude", "frequency") if (span := getattr(o, name)) is not None}
    if ranges:
        lines.append("valid:   # what the recordings covered")
        lines += [f"  {n}: {flow({'min': r.min, 'max': r.max, 'unit': r.unit})}" for n, r in ranges.items()]
    return "\n".join([*lines, *provenance_lines(o.identified)]) + "\n"


def check_name(name: Any) -> None:
    """See that a model file may hold a name; raises BadInput. Before a fit, so that its result can be written."""
    if not isinstance(name, str):
        raise BadInput(f"the name of a model must be text, not {type(name).__name__}")
    if not name.isprintable():  # which the file would write as another
        raise BadInput(f"the name {name[:60]!r} holds a line break or a control character; take it out")
    if len(name) > LONGEST_NAME:
        raise BadInput(f"the name {name[:20]}... is longer than {LONGEST_NAME} characters; shorten it")


def check(oscillator: Oscillator) -> None:
    """See that a model is one that a model file may hold; raises BadInput with every problem and its path."""
    check_name(oscillator.name)
    try:
        loads(dumps(oscillator), "model")
    except BadInput as problem:  # of a text that nobody has seen, no lines
        raise BadInput(re.sub(r"(?m)^model: line \d+: ", "model: ", str(problem))) from None


def save(oscillator: Oscillator, path: str | os.PathLike[str]) -> None:
    """Write a model file: under a temporary name, then renamed, so that no half-written file is ever seen.

    Raises:
        BadInput: the place cannot be written to, or the oscillator holds what a model file cannot (a NaN, say).
    """
    target, text = Path(path), dumps(oscillator)
    loads(text, str(target))  # a file that could not be read again is never written
    write(target, text)


def _reason(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def _oscillator(form: ModelForm, free: list[str]) -> Oscillator:
    identified = form.identified
    return Oscillator(
        mass=None if form.mass is None else parameter_of(form.mass),
        omega0=parameter_of(form.omega0),
        cubic=parameter_of(form.cubic),
        preload=parameter_of(form.preload),
        viscous=parameter_of(form.viscous),
        dry=parameter_of(form.dry),
        name=form.name,
        terms=tuple(Term(find(t.effect), {n: parameter_of(p) for n, p in t.parameters.items()}) for t in form.terms),
        response=Response(form.response.quantity, form.response.unit),
        force_unit=form.excitation.unit,
        hold=form.excitation.hold,
        amplitude=range_of(form.valid.amplitude),
        frequency=range_of(form.valid.frequency),
        identified=provenance_of(identified, free),
    )


def provenance_of(identified: IdentifiedForm, free: list[str]) -> Provenance:
    """Where the numbers come from; ``free`` are the names of the covariance's rows where the file does not say."""
    covariance = identified.covariance
    return Provenance(
        recordings=tuple(recording.model_dump(exclude_unset=True) for recording in identified.recordings),
        method=identified.method,
        software=identified.software,
        commit=identified.commit,
        versions=dict(identified.versions),
        command=identified.command,
        parameters=tuple(identified.parameters or (free if covariance is not None else ())),
        covariance=None if covariance is None else tuple(tuple(map(float, row)) for row in covariance),
        log_likelihood=identified.log_likelihood,
        band=None if (b := identified.band) is None else Band(b.mode, b.low, b.high),
    )


def parameter_of(form: ParameterForm) -> Parameter:
    """One number of a file."""
    return Parameter(float(form.value), None if form.std is None else float(form.std), form.unit)


def range_of(form: RangeForm | None) -> Range | None:
    """A range of a file."""
    return None if form is None else Range(float(form.min), float(form.max), form.unit)


def number_text(value: float) -> str:
    """Shortest text that reads back as the same number, also for readers that want a dot before an exponent."""
    text = repr(float(value))
    if text in ("inf", "-inf", "nan"):
        return text.replace("inf", ".inf").replace("nan", ".nan")
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}{'' if '.' in mantissa else '.0'}{e}{exponent}"


def scalar_text(value: str) -> str:
    """Text as a YAML scalar: plain where no reader can take it for anything else, quoted otherwise."""
    from ..files.yaml_loader import is_text

    clean = "".join(c if c.isprintable() else "\ufffd" for c in value)
    if _PLAIN.fullmatch(clean) and is_text(clean):
        return clean
    return json.dumps(clean, ensure_ascii=False)  # YAML reads JSON's quoted text as JSON does


def _scalar(value: Any) -> str:
    if value is None:
        return "null"
    return scalar_text(value) if isinstance(value, str) else number_text(value)


def flow(entries: Mapping[str, Any]) -> str:
    """A mapping in one line."""
    return "{" + ", ".join(f"{scalar_text(key)}: {_scalar(value)}" for key, value in entries.items()) + "}"


def _row(values: Iterable[Any]) -> str:
    return "[" + ", ".join(map(_scalar, values)) + "]"


def table(parameters: Mapping[str, Parameter | None], why_no_mass: str = "") -> list[str]:
    """One aligned line a parameter."""
    cells = [
        (
            f"{name}:",
            f"{number_text(p.value)},",
            f"{'null' if p.std is None else number_text(float(f'{p.std:.4g}'))},",
            scalar_text(p.unit),
        )
        for name, p in parameters.items()
        if p is not None
    ]
    width = [max(len(cell[i]) for cell in cells) for i in range(3)] if cells else [0, 0, 0]
    width[0] = max([width[0], *(len(name) + 1 for name in parameters)])
    lines = iter(
        f"{name:<{width[0]}} {{value: {value:<{width[1]}} std: {std:<{width[2]}} unit: {unit}}}"
        for name, value, std, unit in cells
    )
    null = f"null   # {why_no_mass}"
    return [f"{name + ':':<{width[0]}} {null}" if p is None else next(lines) for name, p in parameters.items()]


def provenance_lines(identified: Provenance) -> list[str]:
    """Where the numbers come from, as lines of a file."""
    lines: list[str] = []
    if identified.recordings:
        lines += ["  recordings:", *(f"    - {flow(recording)}" for recording in identified.recordings)]
    lines += [
        f"  {name}: {scalar_text(getattr(identified, name))}"
        for name in ("method", "software", "commit", "command")
        if getattr(identified, name)
    ]
    if identified.versions:
        lines.append(f"  versions: {flow(identified.versions)}")
    if (band := identified.band) is not None:
        lines.append(f"  band: {flow({'mode': band.mode, 'low': band.low, 'high': band.high, 'unit': 'Hz'})}")
    if identified.parameters:
        lines.append(f"  parameters: {_row(identified.parameters)}")
    if identified.covariance is not None:
        lines += ["  covariance:", *(f"    - {_row(row)}" for row in identified.covariance)]
    if identified.log_likelihood is not None:
        lines.append(f"  log_likelihood: {number_text(identified.log_likelihood)}")
    return ["identified:", *lines] if lines else []

"""The file of an element, ``dashpot-element/1``: YAML as that of an oscillator, with forces in newtons."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field
from pydantic_core import ErrorDetails

from ..errors import BadInput
from ..files.writing import write
from ..files.yaml_loader import Document, read_yaml, shown, suggestion
from ..files.yaml_loader import Path as Place
from . import units
from .consistency import covariance_problem
from .dependence_file import ChannelForm, channel_lines, check_channels, dependence_of
from .element import Element, template_of, templates
from .file import (
    check_name,
    flow,
    number_text,
    parameter_of,
    provenance_lines,
    provenance_of,
    range_of,
    scalar_text,
    table,
    text_at,
)
from .form import Form, filled, of_format, printable
from .library import find
from .oscillator import Term
from .schema import ELEMENT as FORMAT
from .schema import IdentifiedForm, ParameterForm, RangeForm, TermForm, sentence_of

if TYPE_CHECKING:
    from .law import Law

_Unit = Annotated[str, Field(min_length=1, max_length=40), AfterValidator(printable)]


class _MotionForm(Form):
    """What was prescribed."""

    unit: _Unit = "m"
    origin: float = 0.0


class _ForceForm(Form):
    """What was recorded."""

    unit: _Unit = "N"


class _ValidForm(Form):
    """What the recordings covered."""

    amplitude: RangeForm | None = None
    speed: RangeForm | None = None


class ElementForm(Form):
    """A whole file."""

    format: Literal["dashpot-element/1"]
    name: Annotated[str, Field(min_length=1, max_length=255), AfterValidator(printable)]
    inertia: ParameterForm
    stiffness: ParameterForm
    cubic: ParameterForm
    preload: ParameterForm
    viscous: ParameterForm
    dry: ParameterForm
    load: ParameterForm
    terms: list[TermForm] = Field(default_factory=list)
    channels: list[ChannelForm] = Field(default_factory=list)
    motion: _MotionForm = _MotionForm()
    force: _ForceForm = _ForceForm()
    valid: _ValidForm = _ValidForm()
    identified: IdentifiedForm = IdentifiedForm()


def is_element(text: str) -> bool:
    """Whether a text says that it is the file of an element."""
    return any(line.split("#")[0].strip() == f"format: {FORMAT}" for line in text.splitlines())


def load_element(path: str | os.PathLike[str]) -> Element:
    """Read the file of an element; raises BadInput with one line a problem, as ``file.load`` does."""
    return loads(text_at(path), os.fspath(path))


def loads(text: str, where: str = "element") -> Element:
    """The element in the text of a file; ``where`` names it in messages. Raises BadInput."""
    document = read_yaml(text, where)
    raw = of_format(document, FORMAT, "holds no element; its file starts with", f"an element says 'format: {FORMAT}'")

    def numbers(error: ErrorDetails) -> tuple[Place, str]:
        path = tuple(step for step in error["loc"] if step != "[key]")
        return path, sentence_of(
            error, lambda: suggestion(str(path[-1]), ElementForm.model_fields), lambda: _example(path)
        )

    form = filled(ElementForm, document, numbers, lambda: _checked(raw, document))
    names = templates()
    terms = tuple(Term(find(t.effect), {n: parameter_of(p) for n, p in t.parameters.items()}) for t in form.terms)
    element = Element(
        {name: parameter_of(getattr(form, name)) for name in names},
        form.name,
        terms,
        form.motion.unit,
        form.force.unit,
        form.motion.origin,
        range_of(form.valid.amplitude),
        range_of(form.valid.speed),
        dependences=tuple(dependence_of(entry) for entry in form.channels),
    )
    free = [name for name, p in element.parameters().items() if p.std is not None]
    return replace(element, identified=provenance_of(form.identified, free))


def dumps(element: Element) -> str:
    """The element as the text of a file; values come back bit for bit, standard errors to four digits."""
    e = element
    lines = ["# " + " ".join(e.equation().split()), f"format: {FORMAT}", f"name: {scalar_text(e.name)}"]
    lines += table(e.members)
    lines += ["terms:"] if e.terms else ["terms: []"]
    for term in e.terms:
        lines += [f"  - effect: {scalar_text(term.effect)}", "    parameters:"]
        lines += [f"      {line}" for line in table(term.parameters)]
    lines += channel_lines(e.dependences)
    lines += [
        f"motion: {{unit: {scalar_text(e.unit)}, origin: {number_text(e.origin)}}}",
        f"force: {flow({'unit': e.force_unit})}",
    ]
    ranges = {name: span for name in ("amplitude", "speed") if (span := getattr(e, name)) is not None}
    if ranges:
        lines.append("valid:   # what the recordings covered")
        lines += [f"  {n}: {flow({'min': r.min, 'max': r.max, 'unit': r.unit})}" for n, r in ranges.items()]
    return "\n".join([*lines, *provenance_lines(e.identified)]) + "\n"


def save_element(element: Element, path: str | os.PathLike[str]) -> None:
    """Write the file of an element, whole or not at all; raises BadInput where it could not be read again."""
    target, text = Path(path), dumps(element)
    check_name(element.name)
    loads(text, str(target))
    write(target, text)


def _checked(raw: dict[str, Any], document: Document) -> None:
    """Report units that do not fit, laws and parameters that are not known, and what is no covariance."""
    unit, force = (_item(_item(raw, part) or {}, "unit") or plain for part, plain in (("motion", "m"), ("force", "N")))
    try:
        expected = {name: units.compose(template, unit, force) for name, template in templates().items()}
    except (BadInput, AttributeError) as problem:
        document.report(("motion", "unit"), str(problem))
        return
    for name, wanted in expected.items():
        _same_unit(document, (name,), _item(raw, name), wanted)
    strengths = dict(expected)
    names = list(expected)
    terms = raw.get("terms")
    for i, term in enumerate(terms if isinstance(terms, list) else []):
        law = _law(document, i, _item(term, "effect"))
        if law is None:
            continue
        given, known = _item(term, "parameters"), {p.name: p for p in law.parameters}
        names += [f"{law.name}.{name}" for name in known]
        made = {name: units.compose(template_of(p), unit, force) for name, p in known.items() if p.strength}
        strengths |= {f"{law.name}.{name}": own for name, own in made.items()}
        for name in given if isinstance(given, dict) else {}:
            if name not in known:
                document.report(
                    ("terms", i, "parameters", name), f"{law.name} has no such parameter; {suggestion(name, known)}"
                )
        for name, p in known.items():
            wanted = units.compose(template_of(p), unit, force)
            if not isinstance(given, dict) or name not in given:
                entry = f"{{value: 1.0, std: null, unit: {wanted}}}"
                document.report(("terms", i, "parameters", name), f"is missing; write {name}: {entry}")
                continue
            _same_unit(document, ("terms", i, "parameters", name), given[name], wanted)
            value = _item(given[name], "value")
            if isinstance(value, int | float) and not p.lower <= value <= p.upper:
                said = f"must lie between {p.lower:g} and {p.upper:g}, but is {value:g}"
                document.report(("terms", i, "parameters", name, "value"), said)
    names += check_channels(raw.get("channels"), strengths, document)
    identified = _item(raw, "identified")
    rows, order = _item(identified, "covariance"), _item(identified, "parameters")
    if isinstance(rows, list) and isinstance(order, list):
        for i, name in enumerate(order):
            if name not in names:
                said = f"the element has no parameter {shown(name)}; {suggestion(str(name), names)}"
                document.report(("identified", "parameters", i), said)
        if all(isinstance(row, list) and all(isinstance(v, int | float) for v in row) for row in rows):
            text = covariance_problem(rows, [str(name) for name in order])
            if text:
                document.report(("identified", "covariance"), text)


def _law(document: Document, i: int, effect: Any) -> Law | None:
    if not isinstance(effect, str):
        return None
    try:
        law = find(effect)
    except BadInput as problem:
        document.report(("terms", i, "effect"), str(problem))
        return None
    if law.force is None:
        document.report(("terms", i, "effect"), f"{effect} is no force; an element holds forces alone")
        return None
    return law


def _same_unit(document: Document, path: Place, entry: Any, wanted: str) -> None:
    unit = _item(entry, "unit")
    if not isinstance(unit, str) or not unit.isprintable():
        return
    try:
        if units.same(unit, wanted):
            return
    except BadInput:
        pass
    document.report((*path, "unit"), f"must be {wanted}, not {unit[:60]!r}; convert the value")


def _example(path: Place) -> str:
    key = str(path[-1]) if path else ""
    if len(path) == 1 and key in templates():
        return f"write {key}: {{value: 0.0, std: null, unit: {units.compose(templates()[key], 'm', 'N')}}}"
    return f"write {key}, or leave the whole entry out"


def _item(raw: Any, key: str) -> Any:
    return raw.get(key) if isinstance(raw, dict) else None

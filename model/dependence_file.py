"""The entry ``channels:`` in the file of an element: which strengths depend on what, and how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from ..errors import BadInput
from ..files.yaml_loader import Document, suggestion
from . import units
from .dependence import FORMS, Dependence, own_unit, possible
from .file import flow, number_text, parameter_of, scalar_text
from .form import Form, printable
from .limits import MOST
from .schema import ParameterForm

_Number = Annotated[float, Field(ge=-MOST, le=MOST)]
_Unit = Annotated[str, Field(min_length=1, max_length=40), AfterValidator(printable)]
_OWN = tuple(form.parameter for form in FORMS.values() if form.parameter)


class _SpanForm(Form):
    """What the recordings covered of a channel."""

    min: _Number
    max: _Number


class ChannelForm(Form):
    """A strength that depends on a channel."""

    channel: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=100)]
    unit: _Unit
    of: Annotated[str, Field(min_length=1, max_length=255), AfterValidator(printable)]
    how: Literal["linear", "origin", "power", "inverse"]
    at: _Number
    slope: ParameterForm | None = None
    exponent: ParameterForm | None = None
    rate: ParameterForm | None = None
    valid: _SpanForm


def dependence_of(form: ChannelForm) -> Dependence:
    """One entry of a file."""
    own = FORMS[form.how].parameter
    number = parameter_of(getattr(form, own)) if own else None
    span = float(form.valid.min), float(form.valid.max)
    return Dependence(form.channel, form.of, form.how, float(form.at), form.unit, *span, number)


def channel_lines(dependences: Sequence[Dependence]) -> list[str]:
    """The entry as lines of a file; none where nothing depends on a channel."""
    lines = ["channels:   # strengths that depend on what was recorded beside, stated where the channel is 'at'"]
    for one in dependences:
        how = {"channel": one.channel, "unit": one.unit, "of": one.of, "how": one.how}
        first, *rest = (f"{name}: {scalar_text(value)}" for name, value in how.items())
        lines += [f"  - {first}", *(f"    {line}" for line in rest), f"    at: {number_text(one.reference)}"]
        if (p := one.parameter) is not None:
            std = None if p.std is None else float(f"{p.std:.4g}")
            lines.append(f"    {one.form.parameter}: {flow({'value': p.value, 'std': std, 'unit': p.unit})}")
        lines.append(f"    valid: {flow({'min': one.low, 'max': one.high})}")
    return lines if dependences else []


def check_channels(given: Any, strengths: Mapping[str, str], document: Document) -> list[str]:
    """Report what is wrong with the entry beyond its form.

    Args:
        given: the entry as it was read.
        strengths: unit of everything that may depend on a channel, by its name among the element's parameters.
        document: to which problems are reported.

    Returns:
        Names of the dependences' own numbers.
    """
    names: list[str] = []
    seen: dict[str, tuple[Any, ...]] = {}
    taken: set[tuple[str, str]] = set()
    for i, entry in enumerate(given if isinstance(given, list) else []):
        if not isinstance(entry, dict):
            continue
        path, how, of = ("channels", i), entry.get("how"), entry.get("of")
        channel, unit = str(entry.get("channel")), str(entry.get("unit"))
        if isinstance(of, str) and of not in strengths:
            document.report((*path, "of"), f"nothing is called so that may depend on it; {suggestion(of, strengths)}")
            continue
        if not isinstance(of, str) or not isinstance(how, str) or how not in FORMS:
            continue
        if (of, channel) in taken:
            document.report((*path, "of"), f"{of} depends on {channel} already; leave one of the two out")
        taken.add((of, channel))
        own = FORMS[how].parameter
        for other in _OWN:
            if other != own and entry.get(other) is not None:
                document.report((*path, other), f"is nothing of '{how}'; leave it out")
        span = entry.get("valid")
        if isinstance(entry.get("unit"), str):
            try:
                units.factors(unit)
            except BadInput as problem:
                document.report((*path, "unit"), str(problem))
                continue
        try:
            low, high, at = float(span["min"]), float(span["max"]), float(entry["at"])  # type: ignore[index]
            wanted = own_unit(how, strengths[of], unit)
        except (TypeError, KeyError, ValueError):  # of which its form says what is wrong
            continue
        if own:
            names.append(Dependence(channel, of, how, at, unit, low, high).name)
            number = entry.get(own)
            if not isinstance(number, dict):
                document.report((*path, own), f"is missing; write {own}: {{value: 0.0, std: null, unit: {wanted}}}")
            elif isinstance(written := number.get("unit"), str) and not _fits(written, wanted):
                document.report((*path, own, "unit"), f"must be {wanted}, not {written[:60]!r}; convert the value")
            elif how == "inverse" and not _stays(number.get("value"), low - at, high - at):
                document.report((*path, own, "value"), f"makes {of} infinite within 'valid'; give a smaller one")
        if not low < high or not low <= at <= high:
            document.report((*path, "valid"), "must be a range with 'at' in it; put min, at and max in order")
        elif said := possible(how, unit, low, high, at):
            document.report((*path, "how"), f"cannot be '{how}', for {said}; take linear")
        same = (unit, at, low, high)
        if seen.setdefault(channel, same) != same:
            document.report(
                (*path, "channel"), f"{channel} has another unit, 'at' or 'valid' above; give it one of each"
            )
    return names


def _fits(written: str, wanted: str) -> bool:
    try:
        return units.same(written, wanted)
    except BadInput:
        return False


def _stays(rate: Any, low: float, high: float) -> bool:
    """Whether a denominator stays above zero."""
    return not isinstance(rate, int | float) or min(1.0 + rate * low, 1.0 + rate * high) > 0.0

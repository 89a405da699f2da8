"""The manifest's form, ``dashpot-fleet/1`` (pydantic), and every problem of a file found in one pass."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field
from pydantic_core import ErrorDetails

from ..files.yaml_loader import Document, Path, shown, suggestion
from ..model.form import Form, filled, of_format, printable

FORMAT = "dashpot-fleet/1"


_Word = Annotated[str, Field(min_length=1, max_length=255), AfterValidator(printable)]
_Place = Annotated[str, Field(min_length=1, max_length=4096), AfterValidator(printable)]
_Positive = Annotated[float, Field(gt=0)]


class OptionsForm(Form):
    """How recordings are read and identified: the options of ``dashpot identify`` by their names."""

    time: _Word | None = None
    force: _Word | None = None
    response: _Word | list[_Word] | None = None
    quantity: Literal["displacement", "velocity", "acceleration"] | None = None
    unit: _Word | None = None
    force_unit: _Word | None = Field(default=None, alias="force-unit")
    calibration: dict[str, _Word] | None = None
    fs: _Positive | None = None
    part: _Word | None = None
    amplitude: _Word | None = None
    parts: Annotated[list[_Word], Field(min_length=1)] | None = None
    max_size: _Positive | None = Field(default=None, alias="max-size")
    hold: Literal["zero", "linear", "smooth"] | None = None
    base: _Word | None = None
    relative: bool | None = None
    through: Literal["spring", "damper"] | None = None
    prescribed: _Word | None = None
    channels: dict[str, _Word | float | list[_Word | float]] | None = None
    laws_beside: list[_Word] | None = Field(default=None, alias="with")
    fix: dict[str, float | _Word] | None = None
    mass: _Positive | _Word | None = None
    start: _Place | None = Field(default=None, alias="from")
    mode: _Word | float | None = None
    faults: bool | None = None
    max_left: _Word | None = Field(default=None, alias="max-left")
    law: list[_Place] | None = None
    diagnose: Literal["unfit", "never", "always"] | None = None
    report: bool | None = None


class RigForm(OptionsForm):
    """One rig: its recordings together make one model, or each of them makes one (``each``)."""

    recordings: _Place | Annotated[list[_Place], Field(min_length=1)]
    name: _Word | None = None
    holdout: _Place | list[_Place] = Field(default_factory=list)
    each: bool = False
    rig: _Word | None = None
    state: _Word | float | None = None
    when: _Word | float | None = None


class ManifestForm(Form):
    """A whole manifest."""

    format: Literal["dashpot-fleet/1"]
    defaults: OptionsForm = OptionsForm()
    rigs: Annotated[list[RigForm], Field(min_length=1)]


_EXAMPLE = "rigs: [{name: rig-1, recordings: [decay.csv, sweep.csv]}]"


def checked(document: Document) -> ManifestForm:
    """The document as a manifest; raises BadInput with every problem, each with its line and path."""
    otherwise = f"write 'format: {FORMAT}' in its first line"
    raw = of_format(document, FORMAT, "holds no manifest; one starts with", otherwise)

    def problem_of(error: ErrorDetails) -> tuple[Path, str]:
        path = _place(error["loc"], raw)
        return path, _sentence(error, path)

    return filled(ManifestForm, document, problem_of)


def _place(loc: tuple[int | str, ...], raw: Any) -> Path:
    """Where in the file a finding is: pydantic's path without the names of the kinds that it tried there."""
    place: list[int | str] = []
    for step in loc:
        if isinstance(raw, dict):
            place.append(step)
            raw = raw.get(step)
        elif isinstance(raw, list) and isinstance(step, int) and step < len(raw):
            place.append(step)
            raw = raw[step]
        else:
            break
    return tuple(place)


def _sentence(error: ErrorDetails, path: Path) -> str:
    """Pydantic's finding in our words."""
    kind, given, limits = error["type"], error["input"], error.get("ctx", {})
    if kind == "missing":
        return "is missing; write " + (_EXAMPLE if path == ("rigs",) else f"{path[-1]}: [decay.csv, 'sweeps/*.csv']")
    if kind == "extra_forbidden":
        return f"unknown key; {suggestion(str(path[-1]), _keys(path))}"
    sentences = {
        "model_type": f"must be a mapping, not {shown(given)}",
        "dict_type": f"must be a mapping, such as {{dry: 0.0}}, not {shown(given)}",
        "float_type": f"must be a plain number, not {shown(given)}",
        "bool_type": f"must be true or false, not {shown(given)}",
        "finite_number": "must be a finite number",
        "greater_than": f"must be greater than {limits.get('gt', 0):g}, not {shown(given)}",
        "string_type": f"must be text, not {shown(given)}; put it in quotes",
        "string_too_short": "is empty; write something there",
        "string_too_long": f"is longer than {limits.get('max_length')} characters; shorten it",
        "list_type": f"must be a list, such as [a, b], not {shown(given)}",
        "too_short": "is an empty list; write something in it",
        "literal_error": f"must be {limits.get('expected')}, not {shown(given)}",
    }
    return sentences.get(kind, error["msg"])


def _keys(path: Path) -> list[str]:
    """The keys that the mapping around ``path`` may have."""
    form = {"rigs": RigForm, "defaults": OptionsForm}.get(str(path[0]), ManifestForm) if len(path) > 1 else ManifestForm
    return [field.alias or name for name, field in form.model_fields.items()]

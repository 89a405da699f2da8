"""The model file's form (pydantic), and every problem of a file found in one pass.

Two passes share one list of problems. Pydantic checks the form: keys, types, finite numbers. ``consistency`` then
checks what needs the physics: units that follow from the response's, effects and their parameters, the covariance.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, get_args

from pydantic import AfterValidator, BaseModel, Field, model_validator
from pydantic_core import ErrorDetails, PydanticCustomError

from ..files.made_by import LONGEST_COMMAND
from ..files.yaml_loader import Document, Path, shown, suggestion
from .consistency import Meaning
from .form import Form, filled, of_format, printable
from .limits import LEAST, LONGEST_NAME, MOST

FORMAT = "dashpot-model/1"
#: What the file of an ``Element`` says.
ELEMENT = "dashpot-element/1"


_Words = Annotated[str, Field(max_length=200), AfterValidator(printable)]
_Name = Annotated[str, Field(min_length=1, max_length=LONGEST_NAME), AfterValidator(printable)]
_Sentence = Annotated[str, Field(min_length=1, max_length=1000), AfterValidator(printable)]
_FilePath = Annotated[str, Field(min_length=1, max_length=4096), AfterValidator(printable)]
_Command = Annotated[str, Field(max_length=LONGEST_COMMAND), AfterValidator(printable)]
_Unit = Annotated[str, Field(min_length=1, max_length=200), AfterValidator(printable)]
_RecordedUnit = Annotated[str, Field(min_length=1, max_length=40), AfterValidator(printable)]


class ParameterForm(Form):
    """One number with its standard error and unit."""

    value: Annotated[float, Field(ge=-MOST, le=MOST)]
    std: Annotated[float, Field(ge=0, le=MOST)] | None = None
    unit: _Unit


def _not_vanishing(value: float) -> float:
    """What a model divides by; raises where its reciprocal would leave double precision."""
    if value < LEAST:
        numbers = {"least": f"{LEAST:g}", "given": f"{value:g}"}
        raise PydanticCustomError("vanishing", "must not be below {least}, but is {given}; check its unit", numbers)
    return value


class PositiveForm(ParameterForm):
    """A parameter that only makes sense above zero."""

    value: Annotated[float, Field(gt=0, le=MOST), AfterValidator(_not_vanishing)]


class TermForm(Form):
    """A further effect."""

    effect: _Name
    parameters: dict[str, ParameterForm]


class ResponseForm(Form):
    """What was recorded of the motion."""

    quantity: Literal["displacement", "velocity", "acceleration"]
    unit: _RecordedUnit


class ExcitationForm(Form):
    """What drives the oscillator, and how it ran between the samples of the recordings."""

    unit: _RecordedUnit = "N"
    hold: Literal["zero", "linear", "smooth"] = "smooth"


class RangeForm(Form):
    """What the recordings covered."""

    min: Annotated[float, Field(ge=0)]
    max: Annotated[float, Field(ge=0)]
    unit: _Unit


class ValidForm(Form):
    """Where the model may be believed."""

    amplitude: RangeForm | None = None
    frequency: RangeForm | None = None


class RecordingForm(Form):
    """One recording that the numbers come from."""

    file: _FilePath
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")] | None = None
    kind: _Words | None = None
    unit: _RecordedUnit | None = None
    nrmse: Annotated[float, Field(ge=0)] | None = None
    over_noise: Annotated[float, Field(ge=0)] | None = None
    zero: float | None = None
    fault: _Sentence | None = None
    added: _Words | None = None


class BandForm(Form):
    """The band in which one mode was isolated."""

    mode: Annotated[float, Field(gt=0)]
    low: Annotated[float, Field(ge=0)] = 0.0
    high: Annotated[float, Field(gt=0)] | None = None
    unit: Literal["Hz"] = "Hz"

    @model_validator(mode="after")
    def _in_order(self) -> BandForm:
        if not self.low < self.mode < (self.high or float("inf")):
            raise PydanticCustomError("band", "the mode must lie between low and high; put them in order")
        return self


class IdentifiedForm(Form):
    """Where the numbers come from."""

    recordings: list[RecordingForm] = Field(default_factory=list)
    method: _Words = ""
    software: _Words = ""
    commit: _Words = ""
    versions: dict[_Words, _Words] = Field(default_factory=dict)
    command: _Command = ""
    parameters: list[str] = Field(default_factory=list)
    covariance: list[list[float]] | None = None
    log_likelihood: float | None = None
    band: BandForm | None = None


class ModelForm(Form):
    """A whole model file."""

    format: Literal["dashpot-model/1"]
    name: _Name
    mass: PositiveForm | None
    omega0: PositiveForm
    cubic: ParameterForm
    preload: ParameterForm
    viscous: ParameterForm
    dry: ParameterForm
    terms: list[TermForm] = Field(default_factory=list)
    response: ResponseForm = ResponseForm(quantity="displacement", unit="m")
    excitation: ExcitationForm = ExcitationForm()
    valid: ValidForm = ValidForm()
    identified: IdentifiedForm = IdentifiedForm()


def checked(document: Document) -> ModelForm:
    """The document as a model file; raises BadInput with every problem, each with its line and path."""
    otherwise = f"this version of dashpot reads 'format: {FORMAT}'"
    if isinstance(document.data, dict) and document.data.get("format") == ELEMENT:
        otherwise = (
            "that is a force law by itself, which the commands show, simulate, diagnose and export take, and in Python "
            "dashpot.load_element; here a rig is asked for"
        )
    raw = of_format(document, FORMAT, "holds no model; a model file starts with", otherwise)
    meaning = Meaning(raw, document)

    def numbers(error: ErrorDetails) -> tuple[Path, str]:
        path = tuple(step for step in error["loc"] if step != "[key]")
        return path, _sentence(error, path, meaning)

    return filled(ModelForm, document, numbers, meaning.check)


def _sentence(error: ErrorDetails, path: Path, meaning: Meaning) -> str:
    return sentence_of(error, lambda: suggestion(str(path[-1]), _keys(path[:-1])), lambda: meaning.example(path))


def sentence_of(error: ErrorDetails, near: Callable[[], str], example: Callable[[], str]) -> str:
    """Pydantic's finding in our words.

    Args:
        error: the finding.
        near: says which keys there are, or which is meant.
        example: says what to write there.
    """
    kind, given, limits = error["type"], error["input"], error.get("ctx", {})
    if kind == "missing":
        return f"is missing; {example()}"
    if kind == "extra_forbidden":
        return f"unknown key; {near()}"
    if kind in ("model_type", "dict_type"):
        return f"must be a mapping, not {shown(given)}; {example()}"
    sentences = {
        "float_type": f"must be a plain number such as 4.6e5, not {shown(given)}",
        "finite_number": "must be a finite number",
        "greater_than": f"must be greater than {limits.get('gt', 0):g}, not {shown(given)}",
        "greater_than_equal": f"must not be below {limits.get('ge', 0):g}, but is {shown(given)}",
        "less_than_equal": f"must be at most {limits.get('le', 0):g}, but is {shown(given)}; check its unit",
        "string_type": f"must be text, not {shown(given)}; put it in quotes",
        "string_too_short": "is empty; write something there",
        "string_too_long": f"is longer than {limits.get('max_length')} characters; shorten it",
        "string_pattern_mismatch": "must be 64 hexadecimal digits in lower case, or null",
        "list_type": f"must be a list, not {shown(given)}; write it as [..., ...]",
        "literal_error": f"must be {limits.get('expected')}, not {shown(given)}",
    }
    return sentences.get(kind, error["msg"])


def _keys(path: Path) -> list[str]:
    """The keys that the mapping at ``path`` may have."""
    form: type[BaseModel] = ModelForm
    for step in path:
        if isinstance(step, str) and step in form.model_fields:
            form = _form_in(form.model_fields[step].annotation) or form
    return list(form.model_fields)


def _form_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((form for inner in get_args(annotation) if (form := _form_in(inner))), None)

"""What the forms of our files share: strict and closed, their texts printable, their problems reported at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from ..errors import BadInput
from ..files.yaml_loader import Document, Path, shown

_Filled = TypeVar("_Filled", bound="Form")


class Form(BaseModel):
    """A mapping of a file: unknown keys, other kinds of values and infinite numbers are refused."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


def printable(text: str) -> str:
    """The text itself; raises where a message could not show it in a line."""
    if not text.isprintable():
        raise PydanticCustomError("unprintable", "holds a line break or a control character; take it out")
    return text


def of_format(document: Document, version: str, nothing: str, otherwise: str) -> dict[str, Any]:
    """The document's mapping.

    Args:
        document: as read.
        version: what its ``format`` must be.
        nothing: what to say of a file that is no mapping.
        otherwise: what to say of one of another format.

    Raises:
        BadInput: it is no mapping, or of another format.
    """
    raw = document.data
    if not isinstance(raw, dict):
        raise BadInput(f"{document.where}: {nothing} 'format: {version}'")
    if raw.get("format") != version:
        said = f"says format {shown(raw['format'])}" if "format" in raw else "has no 'format'"
        raise BadInput(f"{document.where}: {said}; {otherwise}")
    return raw


def filled(
    form: type[_Filled],
    document: Document,
    problem_of: Callable[[ErrorDetails], tuple[Path, str]],
    check: Callable[[], None] = lambda: None,
) -> _Filled:
    """The form as the document fills it.

    Args:
        form: of the whole file.
        document: its mapping.
        problem_of: place and sentence of a finding of pydantic's.
        check: looks for what pydantic cannot see, and reports it to the document.

    Raises:
        BadInput: with every problem, each with its line and path.
    """
    made: _Filled | None = None
    try:
        made = form.model_validate(document.data)
    except ValidationError as errors:
        first: dict[Path, str] = {}  # of what may be of two kinds, pydantic says of each why it is not that
        for error in errors.errors(include_url=False):
            path, sentence = problem_of(error)
            first.setdefault(path, sentence)
        for path, sentence in first.items():
            document.report(path, sentence)
    check()
    if made is None or document.problems:
        raise document.error()
    return made

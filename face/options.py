"""Options that calls of Python share: how recordings are read, and which of several modes is meant."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import Any, ParamSpec, TypeVar

from ..files.arguments import known_options, number_of
from ..recording import Reading

Given = ParamSpec("Given")
Made = TypeVar("Made")


def with_reading(call: Callable[Given, Made]) -> Callable[Given, Made]:
    """A call that takes ``Reading`` beside its own options, and says of any other which one is meant (TypeError)."""
    many = (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)
    own = [name for name, known in signature(call).parameters.items() if known.kind not in many and name != "self"]

    @wraps(call)
    def checked(*given: Given.args, **options: Given.kwargs) -> Made:
        known_options(options, [*own, *Reading.__annotations__])
        return call(*given, **options)

    return checked


def mode_text(mode: Any) -> str | None:
    """A mode by its number or its frequency in Hz as the command line has it; raises BadInput for other things."""
    if mode is None or isinstance(mode, str):
        return mode
    number = number_of(mode, "mode, its place from 1 or its frequency in Hz,")
    return f"{number:.17g}"

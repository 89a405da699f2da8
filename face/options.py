"""Options that calls of Python share: how recordings are read, and which of several modes is meant."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import Any, ParamSpec, TypeVar

from ..files.arguments import known_options, number_of
from ..recording import Reading
from ..recording.content import MOST_MB
from .python_words import speaks_python

Given = ParamSpec("Given")
Made = TypeVar("Made")


def with_reading(call: Callable[Given, Made]) -> Callable[Given, Made]:
    """A call that takes ``Reading`` beside its own options, and says of any other which one is meant (TypeError).

    Its signature, which ``help`` and completion show, has them one by one; its errors are in the words of Python.
    """
    many = (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)
    own = [name for name, known in signature(call).parameters.items() if known.kind not in many and name != "self"]

    @wraps(call)
    def checked(*given: Given.args, **options: Given.kwargs) -> Made:
        known_options(options, [*own, *Reading.__annotations__])
        return call(*given, **options)

    spoken = speaks_python(checked)
    vars(spoken)["__signature__"] = _with_each(signature(call))
    return spoken


def _with_each(own: Signature) -> Signature:
    """The signature with each way to read in place of ``**options``."""
    parameters = [p for p in own.parameters.values() if p.kind is not Parameter.VAR_KEYWORD]
    ways = [
        Parameter(name, Parameter.KEYWORD_ONLY, default=MOST_MB if name == "max_size" else None, annotation=_text(kind))
        for name, kind in Reading.__annotations__.items()
    ]
    return own.replace(parameters=[*parameters, *ways])


def _text(kind: Any) -> str:
    """An annotation as it was written."""
    return getattr(kind, "__forward_arg__", str(kind))


def mode_text(mode: Any) -> str | None:
    """A mode by its number or its frequency in Hz as the command line has it; raises BadInput for other things."""
    if mode is None or isinstance(mode, str):
        return mode
    number = number_of(mode, "mode, its place from 1 or its frequency in Hz,")
    return f"{number:.17g}"

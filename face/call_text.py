"""What ``help(dashpot.identify)`` shows: the call with its arguments, then what it does."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, getdoc, signature
from typing import Any

from ..recording import Reading


def call_text(call: Callable[..., Any]) -> str:
    """Name, arguments with what they may be, one a line, result, and the words of the docstring."""
    shown = signature(call)
    lines = [f"    {_argument(parameter)},\n" for parameter in shown.parameters.values()]
    result = shown.return_annotation
    made = "" if result is shown.empty else f" -> {result}"
    reads = Reading.__annotations__.keys() <= shown.parameters.keys()
    how = f"\n\nHow recordings are read:\n\n{getdoc(Reading)}" if reads else ""
    head = f"{call.__name__}(...){made}: the call.\n\n{call.__name__}(\n{''.join(lines)}){made}"
    return f"{head}\n\n{getdoc(call) or ''}{how}"


def _argument(parameter: Parameter) -> str:
    stars = {Parameter.VAR_POSITIONAL: "*", Parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
    said = "" if parameter.annotation is parameter.empty else f": {parameter.annotation}"
    default = "" if parameter.default is parameter.empty else f" = {parameter.default!r}"
    return f"{stars}{parameter.name}{said}{default}"

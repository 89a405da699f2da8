"""What an error says to a person in Python: options as arguments of the call, not as options of the command line.

The sentences are written once, in the words of the commands, which most people read.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from ..errors import DashpotError
from ..recording import Reading

Given = ParamSpec("Given")
Made = TypeVar("Made")
#: Options that have another name in a call.
_NAMES = {
    "with": "laws",
    "fix": "fixed",
    "from": "start",
    "all": "every",
    "time-limit": "limit",
    "fmi": "version",
    "platform": "platforms",
    "as": "form",
    "law": "dashpot.load_laws",
}
#: Those that have the same name: of other programs, such as pip, nothing is touched.
_ALIKE = frozenset(
    (
        *Reading.__annotations__,
        *(
            "noise",
            "like",
            "mass",
            "mode",
            "faults",
            "holdout",
            "seconds",
            "draws",
            "seed",
            "backend",
            "dof",
            "step",
            "name",
        ),
    )
)
#: Those whose values are texts, and those that take names with values.
_TEXTS = frozenset(
    ("time", "force", "response", "quantity", "unit", "force_unit", "part", "hold", "base", "laws", "form")
)
_BY_NAME = frozenset(("fixed", "calibration"))
_OPTION = re.compile(
    r"(?<![\w-])--(?P<option>[a-z][a-z0-9-]*)"
    r"(?:[ =](?P<value>FROM:TO|[A-Z]{2,}(?:=[A-Z]{2,})?\b|[\w.-]+=-?[\w.]+\b|none\b|zero\b|linear\b|smooth\b"
    r"|\d+(?:\.\d+)?\b"
    r"|(?<=--unit )\S+(?= if\b)|(?<=--with )[a-z]+(?:-[a-z]+)+))?"
)


def in_python(sentence: str) -> str:
    """The sentence with ``--hold zero`` as ``hold='zero'``, ``--fix cubic=0`` as ``fixed={'cubic': 0}``, and so on."""
    return _OPTION.sub(_argument, sentence)


def _argument(found: re.Match[str]) -> str:
    option, value = found["option"], found["value"]
    if option == "absolute":
        return "relative=False"
    name = _NAMES.get(option, option.replace("-", "_"))
    if option not in _NAMES and name not in _ALIKE:
        return found[0]
    if value is None:
        return f"{name}=" if option not in ("relative", "all", "faults") else f"{name}=True"
    if name in _BY_NAME and "=" in value:
        key, _, number = value.partition("=")
        return f"{name}={{{key!r}: {number}}}"
    plain = value.isdigit() or name not in _TEXTS
    return f"{name}={value}" if plain else f"{name}={value!r}"


def speaks_python(call: Callable[Given, Made]) -> Callable[Given, Made]:
    """The call, whose errors name its arguments."""

    @wraps(call)
    def spoken(*given: Given.args, **options: Given.kwargs) -> Made:
        try:
            return call(*given, **options)
        except DashpotError as problem:
            text = problem.args[0] if problem.args and isinstance(problem.args[0], str) else ""
            if (said := in_python(text)) != text:
                problem.args = (said, *problem.args[1:])
            raise

    return spoken

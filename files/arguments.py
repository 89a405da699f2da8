"""The arguments of a call, checked at the border: one sentence for what is of the wrong kind, whatever it is."""

from __future__ import annotations

import difflib
import math
import os
import reprlib
from collections.abc import Iterable, Mapping
from numbers import Real
from pathlib import Path
from typing import Any

from ..errors import BadInput

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 40
#: What the commands call their options, where calls of Python have another word, or another way.
_OF_COMMANDS = {
    "with": "laws",
    "with_law": "laws",
    "fix": "fixed",
    "from": "start",
    "from_": "start",
    "time_limit": "limit",
    "law": "dashpot.load_laws(path)",
    "report": "model.save('report.html')",
    "page": "save('page.html') of what is returned",
    "figures": "figures(folder) of what is returned",
    "write_law": "write_law(file) of what is returned",
    "max_left": "nrmse and over_noise of each recording in model.as_json()['identified']['recordings'], to compare",
    "verbose": "logging.basicConfig(level='INFO')",
    "quiet": "progress, which says nothing where it is left out",
    "output": "model.save(path)",
    "json": "as_json() of what is returned",
}


def shown(given: Any) -> str:
    """Something in a few characters, for messages: also what is nested without end, or has no ``repr``."""
    text = _SHORT.repr(given)
    return text if len(text) <= 80 else f"{text[:77]}..."


def path_of(given: Any, what: str = "a path") -> Path:
    """A path; raises BadInput where ``given`` is no text and no path, or holds a null byte."""
    try:
        text = os.fspath(given)
    except TypeError:
        text = None
    if not isinstance(text, str):
        raise BadInput(f"{shown(given)} is no path; give {what} as a text or a pathlib.Path")
    if "\0" in text:
        raise BadInput(f"{shown(text)} has a null byte, which no path holds; check {what}")
    return Path(given)


def text_of(given: Any, what: str) -> str:
    """A text; raises BadInput where ``given`` is none."""
    if not isinstance(given, str):
        raise BadInput(f"{what} must be a text, not {shown(given)}")
    return given


def number_of(given: Any, what: str) -> float:
    """A plain number, which may be infinite; raises BadInput where ``given`` is none, or NaN."""
    if getattr(given, "ndim", None) == 0 and hasattr(given, "item"):
        given = given.item()  # of numpy
    if isinstance(given, bool) or not isinstance(given, Real):
        raise BadInput(f"{what} must be a number, not {shown(given)}")
    try:
        number = float(given)
    except OverflowError:
        number = math.inf
    if math.isnan(number):
        raise BadInput(f"{what} must be a finite number, not nan")
    return number


def several_of(given: Any, what: str) -> list[Any]:
    """The things of a list; raises BadInput where ``given`` is one thing, or has names instead of an order."""
    if isinstance(given, str | bytes | os.PathLike | Mapping) or not isinstance(given, Iterable):
        raise BadInput(f"{what} must be a list, not {shown(given)}")
    kind = getattr(getattr(given, "dtype", None), "kind", "O")
    if isinstance(given, range) or kind not in "OU" or getattr(given, "ndim", 1) != 1:
        raise BadInput(f"{what} must be a list, and no numbers such as {shown(given)}")
    return list(given)


def known_options(given: Iterable[str], known: Iterable[str]) -> None:
    """Raise TypeError for the first option that a call does not have, with the word that is meant, where one is near.

    Args:
        given: names of options.
        known: those that there are.
    """
    known = list(known)
    for name in sorted(set(given) - set(known)):
        there = _OF_COMMANDS.get(name.removesuffix("_"), _OF_COMMANDS.get(name, ""))
        if there and (there in known or not there.isidentifier()):
            raise TypeError(f"there is no option '{name}', which is one of the command line; here it is {there}")
        near = difflib.get_close_matches(name, known, 1)
        advice = f"did you mean {near[0]}?" if near else f"there are {', '.join(known)}"
        raise TypeError(f"there is no option '{name}'; {advice}")

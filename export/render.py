"""Texts from the templates, with everything that comes from a model file escaped."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

from ..templates import template

#: What XML 1.0 cannot hold even when escaped (section 2.2), among it the halves of a surrogate pair.
_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def plain_text(text: str) -> str:
    """``text`` on one line, with the characters that XML cannot hold replaced by U+FFFD."""
    return " ".join(_ILLEGAL.sub("\ufffd", text).split())


def render(name: str, **values: Any) -> str:
    """The template ``name`` filled in; every value is escaped for XML and HTML."""
    return _prepared(name).render(**values)


@cache
def _prepared(name: str) -> Any:
    """The template made into a program, which takes longer than to run it."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    return environment.from_string(template(name))

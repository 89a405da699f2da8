"""How a file writes its numbers: which sign is the decimal one, and which only groups the digits of thousands."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ...errors import BadInput

_ALONE = r"(?<![\d.,'])(?:0|\d{4,})?{0}\d"  # 0,5 and 1234,5: no group of thousands begins so
_DECIMAL = _ALONE + r"|{0}\d{{1,2}}(?![\d.,])|{0}\d{{4}}|{0}\d+[eE]"
_GROUPS = r"\d{0}\d{{3}}(?:{1}\d|{0}\d{{3}}(?!\d))"
_COMMA_DECIMAL, _DOT_DECIMAL = (re.compile(_DECIMAL.replace("\\d{4,}", "\\d{{4,}}").format(s)) for s in (",", r"\."))
_COMMA_GROUPS, _DOT_GROUPS = (re.compile(_GROUPS.format(*s)) for s in ((",", r"\."), (r"\.", ",")))
_SINGLE = re.compile(r"(?<![\d.,'])[+-]?\d{1,3},\d{3}(?![\d.,])")
#: Signs that only ever group digits: apostrophe and the spaces that do not break a line.
_SPACES = re.compile("(?<=\\d)['\u2019\u00a0\u202f\u2009](?=\\d{3})")


@dataclass(frozen=True)
class Numerals:
    """How numbers are written: the sign that groups digits, "" for none, and whether the comma is the decimal sign."""

    grouping: str = ""
    decimal_comma: bool = False

    def plain(self, text: str) -> str:
        """The text with numbers as programs write them."""
        if self.grouping:
            text = text.replace(self.grouping, "")
        text = _SPACES.sub("", text)
        return text.replace(",", ".") if self.decimal_comma else text


def numerals_of(where: str, text: str) -> Numerals:
    """How the numbers in ``text`` are written, in which no comma and no dot stands for anything else.

    Raises:
        BadInput: where two ways are mixed, or it cannot be told which one it is.
    """
    comma, groups = bool(_COMMA_DECIMAL.search(text)), bool(_COMMA_GROUPS.search(text))
    dots = "." in text
    dot, dot_groups = dots and bool(_DOT_DECIMAL.search(text)), dots and bool(_DOT_GROUPS.search(text))
    if "," not in text:
        comma = dot_groups
    elif not comma and not groups:
        shown = found[0] if (found := _SINGLE.search(text)) else ","
        raise BadInput(
            f"{where}: cannot tell whether {shown} has a decimal comma or a sign that groups thousands; write the "
            "numbers with a decimal point and without groups"
        )
    if (comma and (groups or dot)) or (dot and dot_groups):
        raise BadInput(
            f"{where}: comma and point are each used as the decimal sign; write all numbers with a decimal point and "
            "without groups"
        )
    if comma:
        return Numerals("." if dots else "", decimal_comma=True)
    return Numerals("," if groups else "")

"""An effect in the words of the field, its name in brackets: ``a stop on one side (one-sided-stop)``."""

from __future__ import annotations

import re

from .law import Law
from .laws import BASE, FURTHER
from .library import KNOWN

#: Where a sentence that stands in for a phrase is cut: at what only illustrates or explains.
_CLAUSE = re.compile(r"[:;]|\.(?=\s|$)")
_ARTICLE = re.compile(r"(A|An|The) ")


def phrase_of(law: Law) -> str:
    """The law's phrase; where it has none its sentence, as far as the first colon, semicolon or full stop."""
    if law.phrase:
        return law.phrase
    clause = _CLAUSE.split(law.sentence, maxsplit=1)[0].strip()
    return _ARTICLE.sub(lambda article: article.group().lower(), clause, count=1) if _ARTICLE.match(clause) else clause


def effect_in_words(name: str) -> str:
    """``phrase (name)`` of a law or of an effect, whose plainest law speaks for it.

    A name that the library does not have is returned as it is: an effect that was learnt without a law, a law of a
    user's whose file was not read, or a model.
    """
    laws = (*BASE, *KNOWN.values(), *FURTHER.values())
    law = next((law for law in laws if law.name == name), None) or next(
        (law for law in laws if law.effect == name), None
    )
    return name if law is None else f"{phrase_of(law)} ({name})"

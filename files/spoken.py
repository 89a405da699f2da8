"""Words in a row, as a sentence has them."""

from __future__ import annotations

from collections.abc import Iterable


def spoken(words: Iterable[str], last: str = "and") -> str:
    """``a, b and c``; ``last`` is the word before the last."""
    words = list(words)
    return f" {last} ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)

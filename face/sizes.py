"""How much disk an installation takes, by package: that of the base, and what an extra adds to it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib import metadata
from types import MappingProxyType

_NAME = re.compile(r"[\w.-]+")
_EXTRA = re.compile(r"extra\s*==\s*['\"](?P<extra>[\w-]+)['\"]")
#: Packages that are named with their size.
_NAMED = 4


def sizes_of(
    package: str = "dashpot", extra: str = "", known: Mapping[str, float] = MappingProxyType({})
) -> dict[str, float]:
    """MB of each package that is installed and that a package asks for, directly or through others.

    Args:
        package: whose requirements are followed; it is among them itself.
        extra: with those of this extra; "" for none.
        known: sizes that were found before.

    Returns:
        Sizes as the lists of files that installers leave state them, by name; what is not installed is left out.
    """
    found: dict[str, float] = {}
    asked = [(package, extra)]
    while asked:
        name, with_extra = asked.pop()
        try:
            distribution = metadata.distribution(name)
        except (metadata.PackageNotFoundError, ValueError):
            continue
        if _key(name) not in found:
            size = known.get(_key(name))
            found[_key(name)] = _size(distribution) if size is None else size
        asked += [(name, "") for name in _required(distribution.requires or (), with_extra) if _key(name) not in found]
    return found


def _size(distribution: metadata.Distribution) -> float:
    return sum(file.size or 0 for file in distribution.files or ()) / 1e6


def _key(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _required(requirements: Iterable[str], extra: str) -> Iterable[str]:
    """The names among requirements that hold without an extra, or with the one that is asked for."""
    for text in requirements:
        stated, match = _EXTRA.search(text), _NAME.match(text)
        if match and (stated is None or stated["extra"] == extra):
            yield match[0]


def in_words(sizes: Mapping[str, float]) -> str:
    """The sum, and the largest packages."""
    largest = sorted(sizes.items(), key=lambda pair: -pair[1])[:_NAMED]
    named = ", ".join(f"{name} {size:.0f}" for name, size in largest if size >= 1.0)
    return f"{sum(sizes.values()):.0f} MB{f' ({named})' if named else ''}"

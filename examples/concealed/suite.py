"""Which rigs a suite has: two of each effect, rigs with nothing missing, with two effects, with physics of no list."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .effects import EFFECTS, LATER, SINGLE, UNLISTED, UNWRITTEN

NONE, OPEN, TWO, LAW = "none", "open", "two", "unwritten"
COUNTS = {NONE: 12, OPEN: 8, TWO: 6}
NOISE_OF_NONE = ("white", "ar1", "white", "pink", "white", "quantised")  # in turn


@dataclass(frozen=True)
class Spec:
    """One rig to draw: `kind` is single, none, open or two; its effects with their variants; its noise.

    `number` tells rigs with the same effects apart.
    """

    kind: str
    effects: tuple[str, ...]
    variants: tuple[str, ...]
    noise: str
    number: int

    def entropy(self, seed: int, attempt: int) -> list[int]:
        """Give what seeds this rig's random numbers: independent of the other rigs of the suite."""
        label = "+".join((self.kind, *self.effects, self.noise))
        return [seed, zlib.crc32(label.encode()), self.number, attempt]


def _turn(seed: int, name: str) -> int:
    """A number that differs between seeds and names, to begin with another variant each time."""
    return int(np.random.default_rng([seed, zlib.crc32(name.encode())]).integers(0, 1000))


def _singles(seed: int, name: str, count: int) -> list[Spec]:
    variants, first = SINGLE[name].variants, _turn(seed, name)
    return [Spec("single", (name,), (variants[(first + i) % len(variants)],), "white", i) for i in range(count)]


def _nothing(count: int) -> list[Spec]:
    return [Spec(NONE, (), (), NOISE_OF_NONE[i % len(NOISE_OF_NONE)], i) for i in range(count)]


def _unlisted(seed: int, count: int) -> list[Spec]:
    names = np.random.default_rng([seed, 1]).permutation(list(UNLISTED))
    return [Spec(OPEN, (str(names[i % len(names)]),), ("",), "white", i) for i in range(count)]


def _pairs(seed: int, count: int) -> list[Spec]:
    """Two effects at once, from different paths of the rig."""
    rng = np.random.default_rng([seed, 2])
    pairs = []
    while len(pairs) < count:
        first, second = (EFFECTS[str(name)] for name in rng.choice(list(EFFECTS), 2, replace=False))
        if first.path != second.path:
            variants = tuple(str(rng.choice(effect.variants)) for effect in (first, second))
            pairs.append(Spec(TWO, (first.name, second.name), variants, "white", len(pairs)))
    return pairs


def specs(
    seed: int, kinds: Iterable[str] = (), count: int | None = None, scale: str = "nominal", short: int | None = None
) -> list[Spec]:
    """Give the rigs of a suite in random order.

    `kinds` are names of effects, none, open or two; nothing named means all (with scale small: the effects). `count`
    rigs of each effect: by default as many as it has variants, but two at least, and one where they are small. `short`
    keeps that many, chosen at random. Raises ValueError for an unknown name.
    """
    small = scale == "small"
    chosen = list(dict.fromkeys(kinds)) or [*EFFECTS, *([] if small else COUNTS)]
    known = [*EFFECTS, *COUNTS, *LATER, *UNLISTED, *UNWRITTEN]
    unknown = [name for name in chosen if name not in known]
    if unknown:
        names = ", ".join(known)
        raise ValueError(f"there is no kind of rig named {', '.join(unknown)}; there are {names}")
    suite: list[Spec] = []
    for name in chosen:
        if name in SINGLE:
            suite += _singles(seed, name, count or (1 if small else max(2, len(SINGLE[name].variants))))
        elif name in UNWRITTEN:
            suite += [Spec(LAW, (name,), ("",), "white", i) for i in range(count or 1)]
        elif name in UNLISTED:
            suite += [Spec(OPEN, (name,), ("",), "white", i) for i in range(count or 1)]
        else:
            number = COUNTS[name]
            suite += {NONE: _nothing, OPEN: lambda n: _unlisted(seed, n), TWO: lambda n: _pairs(seed, n)}[name](number)
    order = np.random.default_rng([seed, 3]).permutation(len(suite))
    return [suite[i] for i in order][:short]

"""How often honest recordings are called liars: `benchmarks/honest.py [SETS] [FIRST]`.

Sets of recordings in which nothing lies, by `identify` as a user calls it: of every five three are of the stands of
`dashpot.examples.lies`, each with noises of its own, and two of a rig drawn at random (`calibration.py`), driven, let
go or both, seen by a sensor of displacement, velocity or acceleration. A false word is a fault told, or a
contradiction that is blamed on the measuring chain or the rig.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

from calibration import UNITS, random_rig, recordings_of
from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, told
from dashpot.identify import identify
from dashpot.recording import Recording

#: What a random rig's recordings hold, in turn; three are asked with three quantities in all combinations.
WHICH = ("joint", "forced", "free")


def honest_set(number: int) -> tuple[str, Sequence[Recording]]:
    """The name and the recordings of a set: the same for the same number."""
    seed, place = divmod(number, 5)
    if place < len(STANDS):
        name = list(STANDS)[place]
        return f"{name} {seed}", told(STANDS[name], None, seed)
    drawn = 2 * seed + place - len(STANDS)
    which, quantity = WHICH[drawn % 3], list(UNITS)[drawn // 3 % 3]
    return f"{which} {quantity} {drawn}", recordings_of(random_rig(drawn, which), quantity, drawn)[0]


def false_words(recordings: Sequence[Recording]) -> list[str]:
    """What is said against the recordings."""
    found = identify(recordings)
    return [*found.faults, *(n for n in found.notes if "does not agree with" in n or "contradict" in n)]


def main(sets: int, first: int) -> None:
    asked = false = 0
    for number in range(first, first + sets):
        name, recordings = honest_set(number)
        began = time.monotonic()
        try:
            words = false_words(recordings)
        except BadInput as problem:  # such as a decay that is over too soon: nothing is said of the recordings' honesty
            print(f"{number} {name}: refused: {problem}", flush=True)
            continue
        asked, false = asked + 1, false + bool(words)
        took = time.monotonic() - began
        print(f"{number} {name}: {'; '.join(words) or 'nothing'} ({took:.0f} s)", flush=True)
    print(f"{false} of {asked} honest sets of recordings got a word", flush=True)


if __name__ == "__main__":
    given = [int(word) for word in sys.argv[1:]]
    main(*[*given, *(200, 0)[len(given) :]])

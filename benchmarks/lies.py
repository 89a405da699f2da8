"""Counts which lies of recordings are told, and how often honest ones are called liars: `benchmarks/lies.py [SEEDS]`.

By `identify` as a user calls it, with nothing asked for: how many of its stated errors the worst parameter is off, and
what is said of the record that lies beyond what is left of it.
"""

from __future__ import annotations

import sys

from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, Lie, Stand, lies, told
from dashpot.identify import identify


def words(stand: Stand, lie: Lie | None, seed: int = 0) -> tuple[list[str], float]:
    """What is said of recordings, and by how many of its errors the worst parameter is off."""
    try:
        found = identify(told(stand, lie, seed))
    except BadInput as problem:
        return [str(problem)], 0.0
    parameters = found.oscillator.parameters()
    off = max(abs(p.value - stand.values[name]) / p.std for name, p in parameters.items() if p.std)
    contradicted = [note for note in found.notes if "does not agree with" in note or "contradict" in note]
    return [*found.faults, *contradicted], off


def main(seeds: int) -> None:
    for name, stand in STANDS.items():
        for lie in lies(stand):
            said, off = words(stand, lie)
            print(f"{name:9s} {lie.name:26s} off by {off:6.1f} errors: {'; '.join(said)[:90] or 'nothing'}", flush=True)
        false = sum(bool(words(stand, None, seed)[0]) for seed in range(seeds))
        print(f"{name}: {false} of {seeds} honest sets of recordings got a word", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)

"""Counts which lies of recordings are named, and how often honest ones are called liars: `benchmarks/lies.py [SEEDS]`.

Fits begin at the truth, so that what is measured is the telling and not the search.
"""

from __future__ import annotations

import sys

from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, Lie, Stand, lies, told
from dashpot.identify.faults_found import faults_found
from dashpot.identify.likelihood import maximum_likelihood
from dashpot.model import Oscillator, Response


def words(stand: Stand, lie: Lie | None, seed: int = 0) -> tuple[list[str], float]:
    """What is said of recordings, and by how many of its errors the worst parameter is off."""
    recordings = told(stand, lie, seed)
    model = Oscillator.from_values(dict(stand.values), response=Response(stand.quantity, recordings[0].unit))
    try:
        fit = maximum_likelihood(model, recordings, doubted=False, near=True)
    except BadInput as problem:
        return [str(problem)], 0.0
    parameters = fit.oscillator.parameters()
    off = max(abs(p.value - stand.values[name]) / p.std for name, p in parameters.items() if p.std)
    return [fault.sentence for fault in faults_found(fit, recordings)], off


def main(seeds: int) -> None:
    for name, stand in STANDS.items():
        for lie in lies(stand):
            said, off = words(stand, lie)
            print(f"{name:9s} {lie.name:26s} off by {off:6.1f} errors: {'; '.join(said)[:90] or 'nothing'}", flush=True)
        false = sum(bool(words(stand, None, seed)[0]) for seed in range(seeds))
        print(f"{name}: {false} of {seeds} honest sets of recordings got a word", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10)

"""Counts which lies of recordings are told: `benchmarks/lies.py FILE [STAND...] [--odd] [--seed N] [--noise TIMES]`.

As a user reads and identifies them, with nothing asked for: how many of its stated errors the worst parameter is off,
and what is said of the record that lies. FILE takes a line of JSON a recording, as soon as it is done; begun again with
the same file, what is in there is not done again. `--odd` asks those of `odd_lies`, `--seed` other noise, `--noise` so
many times as much on the response. `honest.py` has the other half: false words.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, Lie, Stand, lies, odd_lies, told
from dashpot.identify import identify
from dashpot.recording.checks import check

#: Stated errors beyond which a number is wrong.
WRONG = 5.0


def outcome(stand: Stand, lie: Lie, seed: int = 0) -> dict[str, object]:
    """What is said of recordings one of which lies, by how many errors the worst parameter is off, and what that is.

    "named": a sentence has the record and the kind; "placed": one has the record and what contradicts it; "misnamed":
    another fault is told; "none needed": nothing is said, and no parameter is off; "silent": nothing, and one is.
    """
    recordings = told(stand, lie, seed)
    name = recordings[lie.record].name
    off, problems = 0.0, [problem for recording in recordings for problem in check(recording)]
    remarks = [problem.sentence for problem in problems]
    try:
        if errors := [problem.sentence for problem in problems if problem.severity == "error"]:
            raise BadInput(" ".join(errors))  # as reading the file does
        found = identify(recordings)
    except BadInput as problem:
        said, noted = [str(problem)], []
    else:
        parameters = found.oscillator.parameters()
        known = {
            key: p for key, p in parameters.items() if key in stand.values
        }  # a lie may be taken for a further mode
        off = max(abs(p.value - stand.values[key]) / p.std for key, p in known.items() if p.std)
        contradicted = [n for n in found.notes if "does not agree with" in n or "contradict" in n]
        said, noted = [*found.faults, *contradicted], [*remarks, *found.notes]
    if any(name in s and lie.is_named(s) for s in (*said, *noted)):
        verdict = "named"
    elif any(name in s for s in said):
        verdict = "placed" if any(name in s and ("agree" in s or "contradict" in s) for s in said) else "misnamed"
    else:
        verdict = "misnamed" if said else "silent" if off > WRONG else "none needed"
    return {"verdict": verdict, "off": round(off, 2), "said": said or noted}


def main(file: Path, names: list[str], *, odd: bool, seed: int, noise: float) -> None:
    """Do what is not in the file, and count what is."""
    kept = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    done = {(row["stand"], row["lie"]) for row in kept}
    stands = {name: replace(STANDS[name], noise=noise * STANDS[name].noise) for name in names}
    turns = zip(*((odd_lies if odd else lies)(stand) for stand in stands.values()), strict=True)
    with file.open("a") as lines:
        for name, lie in (pair for turn in turns for pair in zip(names, turn, strict=True)):
            if (name, lie.name) in done:
                continue
            began = time.monotonic()
            row = {"stand": name, "lie": lie.name, "kind": lie.kind, **outcome(stands[name], lie, seed)}
            kept.append({**row, "seconds": round(time.monotonic() - began, 1)})
            print(json.dumps(kept[-1]), file=lines, flush=True)
    for name in names:
        counts = Counter(row["verdict"] for row in kept if row["stand"] == name)
        print(f"{name}: {', '.join(f'{count} {verdict}' for verdict, count in counts.most_common())}")


if __name__ == "__main__":
    asked = argparse.ArgumentParser()
    asked.add_argument("file", type=Path)
    asked.add_argument("stands", nargs="*", metavar="STAND")
    asked.add_argument("--odd", action="store_true")
    asked.add_argument("--seed", type=int, default=0)
    asked.add_argument("--noise", type=float, default=1.0)
    given = asked.parse_args()
    main(given.file, given.stands or list(STANDS), odd=given.odd, seed=given.seed, noise=given.noise)

"""Counts which lies of recordings are told: `benchmarks/lies.py FILE [STAND...]`.

As a user reads and identifies them, with nothing asked for: how many of its stated errors the worst parameter is off,
and what is said of the record that lies. FILE takes a line of JSON a recording, as soon as it is done; begun again with
the same file, what is in there is not done again. `honest.py` has the other half: false words.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from pathlib import Path

from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, Lie, Stand, lies, told
from dashpot.identify import identify
from dashpot.recording.checks import check

#: Stated errors beyond which a number is wrong.
WRONG = 5.0


def outcome(stand: Stand, lie: Lie) -> dict[str, object]:
    """What is said of recordings one of which lies, by how many errors the worst parameter is off, and what that is.

    "named": a sentence has the record and the kind; "placed": one has the record and what contradicts it; "misnamed":
    another fault is told; "none needed": nothing is said, and no parameter is off; "silent": nothing, and one is.
    """
    recordings = told(stand, lie)
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
        off = max(abs(p.value - stand.values[key]) / p.std for key, p in parameters.items() if p.std)
        contradicted = [n for n in found.notes if "does not agree with" in n or "contradict" in n]
        said, noted = [*found.faults, *contradicted], [*remarks, *found.notes]
    if any(name in s and lie.is_named(s) for s in (*said, *noted)):
        verdict = "named"
    elif any(name in s for s in said):
        verdict = "placed" if any(name in s and ("agree" in s or "contradict" in s) for s in said) else "misnamed"
    else:
        verdict = "misnamed" if said else "silent" if off > WRONG else "none needed"
    return {"verdict": verdict, "off": round(off, 2), "said": said or noted}


def main(file: Path, names: list[str]) -> None:
    """Do what is not in the file, and count what is."""
    kept = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
    done = {(row["stand"], row["lie"]) for row in kept}
    turns = zip(*(lies(STANDS[name]) for name in names), strict=True)
    with file.open("a") as lines:
        for name, lie in (pair for turn in turns for pair in zip(names, turn, strict=True)):
            if (name, lie.name) in done:
                continue
            began = time.monotonic()
            row = {"stand": name, "lie": lie.name, "kind": lie.kind, **outcome(STANDS[name], lie)}
            kept.append({**row, "seconds": round(time.monotonic() - began, 1)})
            print(json.dumps(kept[-1]), file=lines, flush=True)
    for name in names:
        counts = Counter(row["verdict"] for row in kept if row["stand"] == name)
        print(f"{name}: {', '.join(f'{count} {verdict}' for verdict, count in counts.most_common())}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:] or list(STANDS))

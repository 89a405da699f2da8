"""Diagnoses of recordings that no generator of ours drew: the paper's stand with actuator backlash, and public ones.

    python benchmarks/recorded.py [NAME ...] [-o FILE.json]

Each says what the Eq. 17 family lacks there and by how much the error falls on what was held out. The public
recordings are not part of the project; they are looked for in ../shared/data or in $DASHPOT_DATA, and left out where
they are absent.
"""

from __future__ import annotations

import argparse
import gzip
import json
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from dashpot import examples
from dashpot.diagnose import diagnose
from dashpot.diagnose.result import Diagnosis
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.identify.replay import replay
from dashpot.model import Oscillator
from dashpot.recording import Recording, read

STAND = Path(examples.__file__).parent / "recordings" / "paper-stand-backlash"
DATA = Path(os.environ.get("DASHPOT_DATA") or Path(__file__).resolve().parents[2] / "shared" / "data")
#: 10 MHz / 2^14, and the benchmark's own splits.
_SILVERBOX_FS = 10e6 / 2**14
_ARROW_WITHOUT_EXTRAPOLATION = 32_000
_FIRST_SAMPLES = 50


@dataclass(frozen=True)
class Outcome:
    """One diagnosis in figures: of each recording its name, whether it was held out, NRMSE before and after, and noise.

    `tests` are further figures in the unit that they are published in: what, before, after, unit.
    """

    name: str
    verdict: str
    sentence: str
    laws: tuple[str, ...]
    records: tuple[tuple[str, bool, float | None, float | None, float], ...]
    notes: tuple[str, ...]
    seconds: float
    tests: tuple[tuple[str, float, float, str], ...] = field(default=())


def _stand() -> Outcome:
    """The paper's own omission: play between shaker and mass."""
    found = {path.name.partition(".")[0]: read(path) for path in sorted(STAND.glob("*.csv.gz"))}
    training = [found[name] for name in ("bursts", "sweep_low", "sweep_high")]
    return _outcome("the paper's stand with backlash", training, [found["multisine"]])


def _silverbox() -> Outcome:
    """Training multisines (held out: their last part), then the published tests."""
    with gzip.open(DATA / "silverbox_snls80mv.csv.gz", "rt") as file:
        table = np.loadtxt(file, delimiter=",", skiprows=1)
    multisines = table[40650:127400]
    edge = int(0.75 * len(multisines))
    hold = int(0.8 * edge)
    parts = {
        "train": multisines[:hold],
        "holdout": multisines[hold:edge],
        "multisine": multisines[edge:],
        "arrow": table[100:40575],
    }
    recordings = {
        name: Recording(name=name, fs=_SILVERBOX_FS, response=part[:, 1], force=part[:, 0], unit="V", force_unit="V")
        for name, part in parts.items()
    }

    def tests(found: Diagnosis) -> list[tuple[str, float, float, str]]:
        rows = (("multisine", None), ("arrow", _ARROW_WITHOUT_EXTRAPOLATION))
        return [
            (f"test {name}", *(_error_mv(m, recordings[name], last) for m in (found.before, found.model)), "mV")
            for name, last in rows
        ]

    return _outcome("Silverbox", [recordings["train"]], [recordings["holdout"]], tests)


def _error_mv(model: Oscillator, recording: Recording, last: int | None) -> float:
    """Rms of the free run in mV, the first samples left aside as the benchmark allows."""
    left = (replay(model, recording) - recording.response)[_FIRST_SAMPLES:last]
    return 1e3 * float(np.sqrt(np.mean(left**2)))


def _single(name: str, file: str) -> Outcome:
    """One recording, judged on its own end."""
    return _outcome(name, [read(DATA / file)], [])


def _outcome(
    name: str,
    training: Sequence[Recording],
    holdout: Sequence[Recording],
    tests: Callable[[Diagnosis], list[tuple[str, float, float, str]]] = lambda _found: [],
) -> Outcome:
    begun = time.perf_counter()
    try:
        model = identify(training, name=name).oscillator
        begun = time.perf_counter()
        found = diagnose(model, training, holdout)
    except BadInput as problem:  # a verdict too: what cannot be diagnosed is refused with the reason
        return Outcome(name, "refused", str(problem), (), (), (), time.perf_counter() - begun)
    seconds = time.perf_counter() - begun
    return Outcome(
        name,
        found.verdict,
        found.sentence,
        tuple(effect.law for effect in found.effects),
        tuple((r.file, r.holdout, _known(r.nrmse_before), _known(r.nrmse_after), r.noise_floor) for r in found.records),
        tuple(found.notes),
        seconds,
        tuple(tests(found)),
    )


def _known(value: float) -> float | None:
    """None where nothing simulates."""
    return value if np.isfinite(value) else None


#: Each with the file that it needs, from the public ones.
CASES: dict[str, tuple[str | None, Callable[[], Outcome]]] = {
    "stand": (None, _stand),
    "silverbox": ("silverbox_snls80mv.csv.gz", _silverbox),
    "ship": ("kvlcc2_roll_21338.csv.gz", lambda: _single("ship roll", "kvlcc2_roll_21338.csv.gz")),
    "emps": ("emps_train.csv.gz", lambda: _single("EMPS", "emps_train.csv.gz")),
    "beam": ("frid_magmech_decay.csv.gz", lambda: _single("magnetic beam", "frid_magmech_decay.csv.gz")),
}


def run(names: Sequence[str] = ()) -> list[dict]:
    """Diagnose the named cases (all where none is named) whose recordings are here, and print what came out."""
    found = []
    for name in names or CASES:
        file, case = CASES[name]
        if file is not None and not (DATA / file).is_file():
            print(f"{name}: {file} is not here; set DASHPOT_DATA to its folder", flush=True)
            continue
        outcome = case()
        found.append(asdict(outcome))
        print(f"{outcome.name} ({outcome.seconds:.0f} s): {outcome.sentence}", flush=True)
        for file_name, held_out, before, after, floor in outcome.records:
            kind = "held out" if held_out else "training"
            figures = " -> ".join("no simulation" if v is None else f"{100 * v:.3f} %" for v in (before, after))
            print(f"    {kind} {file_name}: {figures} (noise {100 * floor:.3f} %)")
        for what, before, after, unit in outcome.tests:
            print(f"    {what}: {before:.3f} -> {after:.3f} {unit}")
        for note in outcome.notes:
            print(f"    note: {note}")
    return found


def main() -> None:
    """Diagnose, print, and write the figures where asked."""
    parser = argparse.ArgumentParser(description="Diagnoses of recordings from elsewhere.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(CASES)}; all where none is given")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.json")
    given = parser.parse_args()
    if unknown := set(given.names) - set(CASES):
        parser.error(f"no such recording: {', '.join(sorted(unknown))}; known: {', '.join(CASES)}")
    found = run(given.names)
    if given.output:
        given.output.write_text(json.dumps(found, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()

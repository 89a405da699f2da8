"""What is missing from the Eq. 17 family in public recordings, and by how much the error falls: one line each.

    python benchmarks/real_recordings.py [NAME...]

The recordings are not part of the project: they are looked for in ../shared/data or in $DASHPOT_DATA.
"""

from __future__ import annotations

import gzip
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from dashpot.diagnose import diagnose
from dashpot.identify import identify
from dashpot.identify.replay import replay
from dashpot.model import Oscillator
from dashpot.recording import Recording, read

FOLDER = Path(os.environ.get("DASHPOT_DATA") or Path(__file__).resolve().parents[2] / "shared" / "data")
#: 10 MHz / 2^14, and the benchmark's own splits.
SILVERBOX_FS = 10e6 / 2**14
ARROW_WITHOUT_EXTRAPOLATION = 32_000
FIRST_SAMPLES = 50


def silverbox() -> dict[str, Recording]:
    """Training multisines (held out: their last part), test multisine, test arrow."""
    with gzip.open(FOLDER / "silverbox_snls80mv.csv.gz", "rt") as file:
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
    return {
        name: Recording(name=name, fs=SILVERBOX_FS, response=part[:, 1], force=part[:, 0], unit="V", force_unit="V")
        for name, part in parts.items()
    }


def error_mv(model: Oscillator, recording: Recording, last: int | None = None) -> float:
    """Rms of the free run in mV, the first samples left aside as the benchmark allows."""
    left = (replay(model, recording) - recording.response)[FIRST_SAMPLES:last]
    return 1e3 * float(np.sqrt(np.mean(left**2)))


def run_silverbox() -> None:
    """Silverbox, on the benchmark's own tests."""
    parts = silverbox()
    model = identify([parts["train"]], name="silverbox").oscillator
    found = say("Silverbox", model, [parts["train"]], [parts["holdout"]])
    for name, last in (("multisine", None), ("arrow", ARROW_WITHOUT_EXTRAPOLATION)):
        before, after = (error_mv(m, parts[name], last) for m in (found.before, found.model))
        print(f"    test {name}: {before:.3f} -> {after:.3f} mV")


def run_single(name: str, file: str) -> None:
    """One recording, judged on its last third."""
    recording = read(FOLDER / file)
    say(name, identify([recording], name=name).oscillator, [recording], [])


def say(name: str, model: Oscillator, training: list[Recording], holdout: list[Recording]):
    """Diagnose, and print what came out."""
    begun = time.perf_counter()
    found = diagnose(model, training, holdout)
    print(f"{name} ({time.perf_counter() - begun:.0f} s): {found.verdict}. {found.sentence}")
    for record in found.records:
        kind = "held out" if record.holdout else "training"
        print(
            f"    {kind} {record.file}: {100 * record.nrmse_before:.3f} -> {100 * record.nrmse_after:.3f} % "
            f"(noise {100 * record.noise_floor:.3f} %)"
        )
    for effect in found.effects:
        print(f"    {effect.law}: " + ", ".join(f"{n} = {p}" for n, p in effect.parameters.items()))
    for note in found.notes:
        print(f"    note: {note}")
    return found


RUNS: dict[str, Callable[[], None]] = {
    "silverbox": run_silverbox,
    "ship": lambda: run_single("ship roll", "kvlcc2_roll_21338.csv.gz"),
    "emps": lambda: run_single("EMPS", "emps_train.csv.gz"),
    "beam": lambda: run_single("magnetic beam", "frid_magmech_decay.csv.gz"),
}


if __name__ == "__main__":
    if not FOLDER.is_dir():
        sys.exit(f"the real recordings are not in {FOLDER.name}/; set DASHPOT_DATA to their folder")
    for wanted in sys.argv[1:] or RUNS:
        RUNS[wanted]()

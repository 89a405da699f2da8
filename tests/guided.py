"""A coverage-guided fuzzer of what reads untrusted bytes: it keeps every input that reaches code that none did before.

    guided.py TARGET RUNS SEED

TARGET is one of those below; RUNS inputs are tried, grown from a few good ones. Whatever the bytes are, there is a
result or a sentence (`DashpotError`): anything else that is raised, an input that takes longer than 30 s and memory
beyond 2 GB are faults, told by libFuzzer with the input. By atheris (an extra, `pip install .[fuzz]`).
"""

from __future__ import annotations

import io
import logging
import os
import sys
import tempfile
import warnings
import wave
from collections.abc import Callable
from pathlib import Path

import atheris

with atheris.instrument_imports(include=["dashpot.recording", "dashpot.model", "dashpot.fleet"]):
    from dashpot.errors import DashpotError
    from dashpot.fleet.manifest import read_manifest
    from dashpot.model import Oscillator, oscillator_with
    from dashpot.model.file import dumps, loads
    from dashpot.recording.calibration import parse_calibration
    from dashpot.recording.formats import read_tables
    from dashpot.recording.part import parse_part
    from dashpot.recording.read import recording_of
    from dashpot.recording.units import parse_unit

import numpy as np

#: Bytes of the longest input, MB that it may take, and s.
LONGEST, MEMORY, SECONDS = 4096, 2048, 30
#: MB that a file may unpack to.
MOST = 1.0


def _file(name: str) -> Callable[[bytes], object]:
    """A reader of files of one kind, to the recording that is made of each of their records."""

    def read(data: bytes) -> None:
        for table in read_tables(name, data, MOST):
            recording_of(table)

    return read


def _words(data: bytes) -> None:
    """What stands in options."""
    text = data.decode("utf-8", "replace")
    for parse in (lambda word: parse_unit(word, "x"), parse_part, lambda word: parse_calibration(word, "force")):
        try:
            parse(text)
        except DashpotError:
            continue


def _fleet(data: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fleet.yaml"
        path.write_bytes(data)
        read_manifest(path)


def _csv() -> list[bytes]:
    time = np.arange(60) / 50.0
    x = np.exp(-time) * np.cos(20 * time)
    plain = "".join(f"{t:.2f},{v:.4f}\n" for t, v in zip(time, x, strict=True))
    comma = "".join(f"{t:.2f};{v:.4f}\n" for t, v in zip(time, x, strict=True)).replace(".", ",")
    return [
        f"time_s,x_mm\n{plain}".encode(),
        f"Logger 7\nDate: 12.03.2024\nTime/s;Angle [rad]\n{comma}".encode("latin-1"),
        f"# made\n\nt,x\ns,m\n{plain.replace('0.5', 'NA')}".encode("utf-16"),
        b"t x\n12:00:00.1 1\n12:00:00.2 2\n",
    ]


def _wav() -> list[bytes]:
    made = io.BytesIO()
    with wave.open(made, "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(2)
        file.setframerate(500)
        file.writeframes(np.arange(200, dtype="<i2").tobytes())
    return [made.getvalue()]


def _npz() -> list[bytes]:
    made = io.BytesIO()
    np.savez(made, time=np.arange(20) / 50.0, x_m=np.sin(np.arange(20.0)))
    return [made.getvalue()]


def _model() -> list[bytes]:
    values = {"mass": 0.3, "omega0": 80.0, "cubic": 1e5, "preload": 0.1, "viscous": 5.0, "dry": 0.01}
    drag = values | {"quadratic-drag.coefficient": 2.0}
    return [
        dumps(Oscillator.from_values(values)).encode(),
        dumps(oscillator_with(drag, effects=("quadratic-drag",))).encode(),
    ]


def _manifest() -> list[bytes]:
    return [
        b"format: dashpot-fleet/1\ndefaults: {mass: 0.27, report: false}\nrigs: [{name: a, recordings: decay.csv}]\n",
        b"format: dashpot-fleet/1\nrigs:\n  - {name: b, recordings: [x.csv, 'y.mat#run3'], fix: {dry: 0}}\n",
    ]


#: Each with the inputs that it begins from.
TARGETS: dict[str, tuple[Callable[[bytes], object], Callable[[], list[bytes]]]] = {
    "text": (_file("rec.csv"), _csv),
    "wav": (_file("rec.wav"), _wav),
    "npz": (_file("rec.npz"), _npz),
    "model": (lambda data: loads(data.decode("utf-8", "replace")), _model),
    "fleet": (_fleet, _manifest),
    "words": (_words, lambda: [b"m/s2", b"2:30", b"force='22.4 N/V'"]),
}


def main(target: str, runs: int, seed: int) -> None:
    """Run a target; ends the process."""
    run, begin = TARGETS[target]
    warnings.simplefilter("ignore")
    logging.disable()

    def one(data: bytes) -> None:
        try:
            run(data)
        except DashpotError as problem:
            if not str(problem).strip() or os.environ.get("GUIDED_STRICT"):  # by which the tests are tested
                raise

    with tempfile.TemporaryDirectory() as folder:
        for number, content in enumerate(begin()):
            (Path(folder) / f"good{number}").write_bytes(content)
        limits = [
            f"-max_len={LONGEST}",
            f"-rss_limit_mb={MEMORY}",
            f"-timeout={SECONDS}",
            f"-artifact_prefix={folder}/",
        ]
        atheris.Setup([sys.argv[0], f"-runs={runs}", f"-seed={seed}", *limits, folder], one)
        atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))

"""The blind test: `python -m dashpot.examples.concealed.proof -o DIR [--seed N] [--short N] [--scale small]`.

A process of its own makes the suite and prints the SHA-256 of the sealed truth. Then every rig is diagnosed with the
installed commands, which get copies of its CSV files in a folder from which no path leads to the truth. Only when all
are done is the seal opened, with the printed hash, and the score written: DIR/scoreboard.html and DIR/scoreboard.json.
The whole proof then also diagnoses recordings that no generator of ours drew (benchmarks/recorded.py, in a checkout).
Started again, it goes on where it stopped; rigs without a diagnosis are tried again.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from .make import PARTS, options
from .pace import remaining
from .recordings import EXPERIMENTS
from .score import score, summary
from .scoreboard import page
from .seal import NAME, open_sealed, sha256
from .stability import CHANGES, Change, stability, stability_target

ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMEXPR")}
#: What is found may not depend on the speed of the machine, unless whoever runs the test asks for that.
NO_LIMIT = {"DASHPOT_SECONDS": "inf"}
DASHPOT = (sys.executable, "-P", "-m", "dashpot")


def _settings(given: argparse.Namespace) -> list[str]:
    """Give the options that make the suite."""
    arguments = ["--seed", str(given.seed), "--scale", given.scale]
    arguments += ["--kinds", *given.kinds] if given.kinds else []
    arguments += ["--count-per-effect", str(given.count_per_effect)] if given.count_per_effect else []
    arguments += ["--experiment", given.experiment] if given.experiment != "shaker" else []
    arguments += ["--sensor", given.sensor] if given.sensor != "displacement" else []
    arguments += ["--dirty", str(given.dirty)] if given.dirty else []
    return arguments + (["--short", str(given.short)] if given.short else [])


def make_suite(folder: Path, settings: list[str]) -> str:
    """Make the suite in folder/suite in a process of its own, or find it there, and give its SHA-256.

    Raises ValueError where the folder has a suite of other settings or with another hash, RuntimeError where it cannot
    be made.
    """
    suite, note = folder / "suite", folder / "suite.json"
    if note.exists():
        known = json.loads(note.read_text(encoding="utf-8"))
        if known["settings"] != settings:
            raise ValueError(f"{folder}: holds the suite of {' '.join(known['settings'])}; name another folder")
        if not known["sha256"]:
            return _made(folder, settings)
        digest = sha256(suite / NAME)
        if digest != known["sha256"]:
            raise ValueError(
                f"{suite / NAME}: is not the truth that was sealed ({known['sha256']}); start anew elsewhere"
            )
        return digest
    return _made(folder, settings)


def _made(folder: Path, settings: list[str]) -> str:
    """Make the suite, or go on with dirty rigs that were begun."""
    suite, note = folder / "suite", folder / "suite.json"
    if suite.exists() and not (suite / PARTS).is_dir():  # begun and not finished
        shutil.rmtree(suite)
    folder.mkdir(parents=True, exist_ok=True)
    note.write_text(json.dumps({"settings": settings, "sha256": ""}), encoding="utf-8")
    command = [sys.executable, "-P", "-m", "dashpot.examples.concealed.make", str(suite.resolve()), *settings]
    run = subprocess.run(command, stdout=subprocess.PIPE, text=True, env=os.environ | ONE_THREAD, check=False)
    if run.returncode:
        raise RuntimeError(f"the suite could not be made: exit code {run.returncode}")
    digest = run.stdout.split()[-1]
    note.write_text(json.dumps({"settings": settings, "sha256": digest}), encoding="utf-8")
    return digest


def _command(command: Sequence[str], cwd: Path, log: Path, timeout: float) -> int:
    ordinary = {name: value for name, value in os.environ.items() if name != "OLDPWD"}
    with log.open("a", encoding="utf-8") as stream:
        stream.write(f"$ dashpot {' '.join(command)}\n")
        stream.flush()
        try:
            run = subprocess.run(
                [*DASHPOT, *command],
                cwd=cwd,
                env=NO_LIMIT | ordinary | ONE_THREAD | {"PWD": str(cwd)},
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=stream,
                timeout=timeout,
                check=False,
            )
        except subprocess.TimeoutExpired:
            stream.write(f"stopped after {timeout:.0f} s\n")
            return -1
        stream.write(f"exit code {run.returncode}\n")
        return run.returncode


def diagnose_rig(rig: Path, result: Path, timeout: float, change: Change | None = None) -> str:
    """Identify and diagnose one rig, its files changed first; what comes of it ends in `result`.

    Gives one line for the terminal.
    """
    started = time.monotonic()
    shutil.rmtree(result, ignore_errors=True)
    result.mkdir(parents=True)
    with tempfile.TemporaryDirectory(prefix="rig-") as name:
        here = Path(name)
        for path in rig.glob("*.csv.gz"):
            shutil.copy(path, here)
        (trial,) = (e for e in EXPERIMENTS.values() if all((here / f"{name}.csv.gz").exists() for name in e.recordings))
        training = [f"{kind}.csv.gz" for kind in trial.training]
        judged = [f"{kind}.csv.gz" for kind in trial.held_out]
        if change:
            training, judged = change(here, training), change(here, judged)
        held_out = [word for name in judged for word in ("--holdout", name)]
        log = here / "log.txt"
        _command(["identify", *training, "-o", "model.yaml"], here, log, timeout)
        if (here / "model.yaml").exists():  # what identification says of the fit does not stop a diagnosis
            shutil.copy(here / "model.yaml", result / "identified.yaml")
            _command(["diagnose", "model.yaml", *training, *held_out, "-o", "diagnosis"], here, log, timeout)
        shutil.copy(log, result)
        if (here / "diagnosis").is_dir():
            shutil.copytree(here / "diagnosis", result, dirs_exist_ok=True)
    seconds = time.monotonic() - started
    said = "diagnosed" if (result / "diagnosis.json").exists() else f"no diagnosis, see {result / 'log.txt'}"
    (result / "seconds.txt").write_text(f"{seconds:.1f}\n", encoding="utf-8")
    return f"{rig.name}: {said} ({seconds:.0f} s)"


def diagnose_all(suite: Path, results: Path, jobs: int, timeout: float, change: Change | None = None) -> None:
    """Diagnose every rig of a suite that has no diagnosis among the results yet."""
    rigs = sorted(path for path in suite.iterdir() if path.is_dir())
    todo = [rig for rig in rigs if not (results / rig.name / "diagnosis.json").exists()]
    print(f"{len(rigs)} rigs, {len(rigs) - len(todo)} of them diagnosed already", flush=True)
    with ThreadPoolExecutor(jobs) as pool:
        futures = {pool.submit(diagnose_rig, rig, results / rig.name, timeout, change): rig for rig in todo}
        pending = set(todo)
        for done in as_completed(futures):
            pending.discard(futures[done])
            took = [results / rig.name / "seconds.txt" for rig in rigs if rig not in pending]
            seconds = [float(path.read_text()) for path in took if path.exists()]
            print(f"{done.result()}; {remaining(seconds, len(pending), jobs)}", flush=True)


def diagnose_recorded(folder: Path) -> list[dict]:
    """Outcomes of the recordings from elsewhere, kept in folder/recorded.json."""
    kept, script = folder / "recorded.json", Path(__file__).resolve().parents[2] / "benchmarks" / "recorded.py"
    if not kept.exists() and script.exists():
        subprocess.run([sys.executable, "-P", str(script), "-o", str(kept.resolve())], check=False)
    return json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else []


def report(folder: Path, known: str, recorded: Sequence[dict] = ()) -> str:
    """Open the seal, score, write scoreboard.json and scoreboard.html, and give the summary."""
    board = score(open_sealed(folder / "suite" / NAME, known), folder / "results")
    changed, rigs = folder / "changed", [rig["rig"] for rig in board["rigs"]]
    board |= {"sha256": known, "recorded": list(recorded)}
    board["stability"] = stability(folder / "results", changed, rigs) if changed.exists() else None
    board["targets"] += stability_target(board["stability"]) if board["stability"] else []
    (folder / "scoreboard.json").write_text(json.dumps(board, indent=1), encoding="utf-8")
    (folder / "scoreboard.html").write_text(page(board, known), encoding="utf-8")
    return summary(board)


def main(arguments: list[str]) -> int:
    """Run the blind test; exit code 0 when every target is met, 1 when not, 2 for wrong input."""
    parser = argparse.ArgumentParser(prog="concealed.proof", description="Blind test of the diagnosis.")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    options(parser)
    parser.add_argument("--stability", action="store_true", help="diagnose again with files changed a little")
    parser.add_argument("--jobs", type=int, default=2, help="rigs diagnosed at a time; default 2")
    parser.add_argument("--timeout", type=float, default=1800.0, metavar="S", help="seconds for one command")
    given = parser.parse_args(arguments)
    try:
        known = make_suite(given.output, _settings(given))
    except (ValueError, OSError, RuntimeError) as problem:
        print(problem, file=sys.stderr)
        return 2
    print(f"SHA-256 of the sealed truth: {known}", flush=True)
    suite, results = given.output / "suite", given.output / "results"
    diagnose_all(suite, results, given.jobs, given.timeout)
    for name, change in CHANGES.items() if given.stability else ():
        print(f"with a change, {name}:", flush=True)
        diagnose_all(suite, given.output / "changed" / name, given.jobs, given.timeout, change)
    whole = not (given.short or given.kinds or given.dirty) and (given.scale, given.experiment) == ("nominal", "shaker")
    recorded = diagnose_recorded(given.output) if whole else []
    print(report(given.output, known, recorded))
    print(given.output / "scoreboard.html")
    board = json.loads((given.output / "scoreboard.json").read_text(encoding="utf-8"))
    return 0 if all(target["met"] for target in board["targets"]) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

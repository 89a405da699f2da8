"""Make a suite of virtual rigs: `python -m dashpot.examples.concealed.make DIR --seed N`.

DIR/rig_001 ... get five recordings each, in an order that says nothing; DIR/truth.sealed gets the truth. Its SHA-256 is
the only line on stdout: note it before any diagnosis, and the truth cannot change afterwards without being noticed.
"""

from __future__ import annotations

import argparse
import gzip
import io
import json
import multiprocessing
import shutil
import sys
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numpy as np

from .dirty import CYCLES, draw_dirty
from .pace import remaining
from .record import record
from .recordings import EXPERIMENTS
from .seal import NAME, seal
from .suite import specs
from .virtual import STRENGTH, Trial, draw

SHOWN = {"displacement": "displacement_m", "acceleration": "acceleration_m/s2", "camera": "displacement_m"}
PARTS = "parts"  # of a suite begun: the truth of each rig, gone when it is sealed


def write_recording(path: Path, table: np.ndarray, shown: str = "displacement_m") -> None:
    """Write a recording as `csv_of` gives it."""
    path.write_bytes(csv_of(table, shown))


def csv_of(table: np.ndarray, shown: str = "displacement_m") -> bytes:
    """A recording, (n, 3), its third column headed `shown`, as gzipped CSV; the same numbers, the same bytes.

    One of (n, 2) has no force.
    """
    text = io.StringIO()
    force = table.shape[1] == 3
    text.write(f"time_s,{'force_N,' if force else ''}{shown}\n")
    np.savetxt(text, table, fmt=["%.9f", "%.7g", "%.7g"] if force else ["%.9f", "%.7g"], delimiter=",")
    return gzip.compress(text.getvalue().encode(), compresslevel=6, mtime=0)


def make(
    folder: Path,
    seed: int,
    kinds: list[str] | None = None,
    count: int | None = None,
    scale: str = "nominal",
    short: int | None = None,
    cycles: tuple[float, float] = (300.0, 600.0),
    trial: Trial = Trial(),  # noqa: B008 - frozen
) -> str:
    """Make a suite in `folder`, which must not hold one, and give the SHA-256 of its sealed truth.

    Arguments as in `suite.specs`. Raises FileExistsError where the folder holds something, ValueError for a kind that
    is unknown.
    """
    chosen = specs(seed, kinds or (), count, scale, short)
    if folder.exists() and any(folder.iterdir()):
        raise FileExistsError(f"{folder}: is not empty; name another folder for the suite")
    folder.mkdir(parents=True, exist_ok=True)
    rigs = {}
    for i, spec in enumerate(chosen, start=1):
        name = f"rig_{i:03d}"
        tables, truth = record(draw(spec, seed, scale, cycles, trial=trial))
        (folder / name).mkdir()
        for kind, table in tables.items():
            write_recording(folder / name / f"{kind}.csv.gz", table, SHOWN[trial.quantity])
        rigs[name] = truth
        print(f"{name} of {len(chosen)}", file=sys.stderr, flush=True)
    return seal(folder / NAME, {"format": "concealed/1", "seed": seed, "scale": scale, "rigs": rigs})


def _one_dirty(folder: Path, seed: int, number: int, cycles: tuple[float, float]) -> tuple[str, float]:
    """Make one dirty rig: its recordings, then its part of the truth, which says that it is complete."""
    started = time.monotonic()
    name = f"rig_{number + 1:03d}"
    virtual = draw_dirty(seed, number, cycles)
    tables, truth = record(virtual)
    shutil.rmtree(folder / name, ignore_errors=True)
    (folder / name).mkdir()
    for kind, table in tables.items():
        write_recording(folder / name / f"{kind}.csv.gz", table, SHOWN[virtual.trial.quantity])
    made = folder / PARTS / f"{name}.new"
    made.write_text(json.dumps(truth), encoding="utf-8")
    made.replace(folder / PARTS / f"{name}.json")
    return name, time.monotonic() - started


def make_dirty(folder: Path, seed: int, count: int, cycles: tuple[float, float] = CYCLES, jobs: int = 2) -> str:
    """Make `count` dirty rigs in `folder`, or those that it lacks, and give the SHA-256 of their sealed truth.

    Each rig in a process of its own, `jobs` at a time. Raises FileExistsError where the folder holds something else or
    a suite that is sealed, RuntimeError where a rig cannot be drawn.
    """
    parts = folder / PARTS
    if folder.exists() and any(folder.iterdir()) and not parts.is_dir():
        raise FileExistsError(f"{folder}: is not empty; name another folder for the suite")
    parts.mkdir(parents=True, exist_ok=True)
    todo = [i for i in range(count) if not (parts / f"rig_{i + 1:03d}.json").exists()]
    seconds: list[float] = []
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, max_tasks_per_child=1) as pool:
        for done in as_completed([pool.submit(_one_dirty, folder, seed, i, cycles) for i in todo]):
            name, took = done.result()
            seconds.append(took)
            print(f"{name} made, {remaining(seconds, len(todo) - len(seconds), jobs)}", file=sys.stderr, flush=True)
    names = [f"rig_{i + 1:03d}" for i in range(count)]
    rigs = {name: json.loads((parts / f"{name}.json").read_text(encoding="utf-8")) for name in names}
    truth = {"format": "concealed/1", "seed": seed, "scale": "nominal", "dirty": count, "rigs": rigs}
    digest = seal(folder / NAME, truth)
    shutil.rmtree(parts)
    return digest


def options(parser: argparse.ArgumentParser) -> None:
    """Add what describes a suite."""
    parser.add_argument("--seed", type=int, default=1, help="the same seed gives the same suite")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", help="names of effects, none, open, two; default all")
    parser.add_argument("--count-per-effect", type=int, metavar="K", help="rigs of each effect; default 2, small: 1")
    parser.add_argument("--scale", choices=list(STRENGTH), default="nominal", help="small: a fifth of the strength")
    parser.add_argument("--experiment", choices=list(EXPERIMENTS), default="shaker", help="how the rigs are driven")
    parser.add_argument("--sensor", choices=list(SHOWN), default="displacement", help="what it shows")
    parser.add_argument("--short", type=int, metavar="N", help="only N rigs of the suite")
    parser.add_argument("--dirty", type=int, metavar="N", help="instead, N rigs with the imperfections of laboratories")


def main(arguments: list[str]) -> int:
    """Run the command; the exit code is 2 where the input is wrong."""
    parser = argparse.ArgumentParser(prog="concealed.make", description=(__doc__ or "").split(":")[0])
    parser.add_argument("folder", type=Path, metavar="DIR")
    options(parser)
    given = parser.parse_args(arguments)
    try:
        trial = Trial(given.experiment, given.sensor)
        suite = given.kinds, given.count_per_effect, given.scale, given.short
        if given.dirty:
            print(make_dirty(given.folder, given.seed, given.dirty))
        else:
            print(make(given.folder, given.seed, *suite, trial=trial))
    except (ValueError, OSError, RuntimeError) as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

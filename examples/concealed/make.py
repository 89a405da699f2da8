"""Make a suite of virtual rigs: `python -m dashpot.examples.concealed.make DIR --seed N`.

DIR/rig_001 ... get five recordings each, in an order that says nothing; DIR/truth.sealed gets the truth. Its SHA-256 is
the only line on stdout: note it before any diagnosis, and the truth cannot change afterwards without being noticed.
"""

from __future__ import annotations

import argparse
import gzip
import io
import sys
from pathlib import Path

import numpy as np

from .record import record
from .recordings import EXPERIMENTS
from .seal import NAME, seal
from .suite import specs
from .virtual import STRENGTH, Trial, draw

SHOWN = {"displacement": "displacement_m", "acceleration": "acceleration_m/s2"}


def write_recording(path: Path, table: np.ndarray, shown: str = "displacement_m") -> None:
    """Write a recording, (n, 3), its third column headed `shown`, as gzipped CSV; the same numbers, the same bytes."""
    text = io.StringIO()
    text.write(f"time_s,force_N,{shown}\n")
    np.savetxt(text, table, fmt=["%.9f", "%.7g", "%.7g"], delimiter=",")
    path.write_bytes(gzip.compress(text.getvalue().encode(), compresslevel=6, mtime=0))


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


def options(parser: argparse.ArgumentParser) -> None:
    """Add what describes a suite."""
    parser.add_argument("--seed", type=int, default=1, help="the same seed gives the same suite")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", help="names of effects, none, open, two; default all")
    parser.add_argument("--count-per-effect", type=int, metavar="K", help="rigs of each effect; default 2, small: 1")
    parser.add_argument("--scale", choices=list(STRENGTH), default="nominal", help="small: a fifth of the strength")
    parser.add_argument("--experiment", choices=list(EXPERIMENTS), default="shaker", help="how the rigs are driven")
    parser.add_argument("--sensor", choices=list(SHOWN), default="displacement", help="what it shows")
    parser.add_argument("--short", type=int, metavar="N", help="only N rigs of the suite")


def main(arguments: list[str]) -> int:
    """Run the command; the exit code is 2 where the input is wrong."""
    parser = argparse.ArgumentParser(prog="concealed.make", description=(__doc__ or "").split(":")[0])
    parser.add_argument("folder", type=Path, metavar="DIR")
    options(parser)
    given = parser.parse_args(arguments)
    try:
        trial = Trial(given.experiment, given.sensor)
        suite = given.kinds, given.count_per_effect, given.scale, given.short
        print(make(given.folder, given.seed, *suite, trial=trial))
    except (ValueError, OSError, RuntimeError) as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

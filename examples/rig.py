"""The two stands, simulated and recorded like the paper's Figs. 3 and 6; run as a module it makes the recordings again.

Each recording starts from rest. The simulation is driven by the true force; the recorded force has noise added, as has
the displacement of the position sensor (LVDT).
"""

from __future__ import annotations

import gzip
import io
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from .actuator_backlash import integrate_with_backlash
from .force import chirp, multisine
from .oscillator import integrate_pieces
from .truth import ACTUATOR, TRUTH

FS = 1000.0  # Hz
DT = 1.0 / FS
SENSOR_NOISE = 1e-6  # m, standard deviation
FORCE_NOISE = 1e-3  # of the peak force, standard deviation
KINDS = ("bursts", "sweep_low", "sweep_high", "multisine")


def force(kind: str) -> np.ndarray:
    """Give the true force of a kind of recording as polynomials over the steps, (n, 11), N; column 0 is its samples."""
    if kind == "bursts":  # Fig. 3: 19.5 cycles of 13 Hz, stopped on a sample, then 3.5 s of free decay, four times
        pattern = np.zeros((5000, 11))
        pattern[:1500] = chirp(1.15, 13.0, 0.0, np.arange(1500) / FS, DT)
        return np.tile(pattern, (4, 1))
    if kind in ("sweep_low", "sweep_high"):  # Fig. 6
        amplitude = 0.3 if kind == "sweep_low" else 1.0
        return chirp(amplitude, 5.0, 15.0 / 80.0, np.arange(80_000) / FS, DT)
    if kind == "multisine":  # three periods of 20 s, every line from 5 to 20 Hz, as strong as a sine of 0.6 N
        lines = np.arange(100, 401) / 20.0
        phases = np.random.default_rng(20).uniform(0.0, 2 * np.pi, len(lines))
        period = multisine(0.6 / np.sqrt(len(lines)), lines, phases, np.arange(20_000) / FS, DT)
        return np.tile(period, (3, 1))
    raise ValueError(f"{kind!r} is no kind of recording; there are {', '.join(KINDS)}")


def paper_stand(pieces: np.ndarray) -> np.ndarray:
    """Give the displacement, (n,) m, of Equation 17 with the true parameters, from rest."""
    return integrate_pieces(TRUTH, pieces[:-1], DT)[0]


def paper_stand_backlash(pieces: np.ndarray) -> np.ndarray:
    """Give the displacement of the main mass, (n,) m, of the stand with actuator backlash, from rest."""
    return integrate_with_backlash(TRUTH, ACTUATOR, pieces[:-1], DT)[:, 0]


# Each stand with the first of its seeds.
STANDS: dict[str, tuple[Callable[[np.ndarray], np.ndarray], int]] = {
    "paper-stand": (paper_stand, 100),
    "paper-stand-backlash": (paper_stand_backlash, 200),
}


def record(stand: str, kind: str) -> np.ndarray:
    """Simulate one recording: columns time s, force N, displacement m, (n, 3), rounded as in the file."""
    simulate, seed = STANDS[stand]
    pieces = force(kind)
    true = pieces[:, 0]
    noise = np.random.default_rng(seed + KINDS.index(kind))
    measured = true + FORCE_NOISE * np.abs(true).max() * noise.standard_normal(len(true))
    x = simulate(pieces) + SENSOR_NOISE * noise.standard_normal(len(true))
    return np.column_stack([np.arange(len(true)) / FS, measured.round(5), x.round(8)])


def write(path: Path, table: np.ndarray) -> None:
    """Write a recording as CSV, gzipped without a time stamp so that the same numbers give the same bytes."""
    text = io.StringIO()
    text.write("time_s,force_N,displacement_m\n")
    np.savetxt(text, table, fmt=["%.3f", "%.5f", "%.8f"], delimiter=",")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(text.getvalue().encode(), mtime=0))


def main(arguments: list[str]) -> None:
    """Make every recording again, below the folder given or in their place."""
    folder = Path(arguments[0]) if arguments else Path(__file__).parent / "recordings"
    for stand in STANDS:
        for kind in KINDS:
            path = folder / stand / f"{kind}.csv.gz"
            write(path, record(stand, kind))
            print(path)


if __name__ == "__main__":
    main(sys.argv[1:])

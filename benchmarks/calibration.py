"""Are the standard errors honest? Many rigs and many noises, identified blind; prints (found - true) / std.

    python benchmarks/calibration.py [RIGS [NOISES]]

An honest error gives a root mean square of one. Rigs are drawn at random (2 to 100 Hz, damping ratio 0.6 to 10 %, 15 to
80 samples a cycle, noise 0.01 to 0.5 % of the amplitude, with and without preload and dry friction) and simulated by
the Taylor-series integrator of the examples.
"""

from __future__ import annotations

import sys

import numpy as np
from dashpot.errors import DashpotError
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.rig import FORCE_NOISE, FS, SENSOR_NOISE, force, paper_stand
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.recording import Recording

NAMES = tuple(TRUTH)


def scores(recordings: list[Recording], truth: dict[str, float]) -> np.ndarray:
    """Distance of each identified parameter from the truth, in its own standard errors."""
    parameters = identify(recordings).oscillator.parameters()
    return np.array([(parameters[name].value - truth[name]) / (parameters[name].std or np.nan) for name in NAMES])


def random_rig(seed: int) -> tuple[list[Recording], dict[str, float]]:
    """Two sweeps and a decay of a rig drawn at random, and what it is."""
    random = np.random.default_rng(seed)
    frequency, amplitude, ratio = 10 ** random.uniform([0.3, -4, -2.2], [2, -2, -1])
    omega0 = 2 * np.pi * frequency
    scale = omega0**2 * amplitude
    truth = {
        "mass": 10 ** random.uniform(-1, 1),
        "omega0": omega0,
        "cubic": random.uniform(0, 0.5) * scale / amplitude**3,
        "preload": scale * random.choice([0.0, 10 ** random.uniform(-3, -1.3)]),
        "viscous": 2 * ratio * omega0,
        "dry": scale * random.choice([0.0, 10 ** random.uniform(-3.3, -1.5)]),
    }
    samples, cycles = random.uniform([15, 200], [80, 500])
    fs = round(frequency * samples)
    noise = amplitude * 10 ** random.uniform(-4, -2.3)
    top = truth["mass"] * (amplitude * omega0 * truth["viscous"] + 1.27 * truth["dry"])
    recordings = []
    n = int(cycles * samples)
    for name, level in (("high", top), ("low", 0.35 * top)):
        pieces = chirp(level, 0.5 * frequency, 1.1 * frequency * fs / n, np.arange(n) / fs, 1 / fs)
        x = integrate_pieces(truth, pieces, 1 / fs, 0.0, 0.0)[0][:n]
        measured = pieces[:, 0] + 1e-3 * level * random.standard_normal(n)
        recordings.append(Recording(name=name, fs=fs, response=x + noise * random.standard_normal(n), force=measured))
    n = int(100 * samples)
    x = integrate_pieces(truth, np.zeros((n, 2)), 1 / fs, 0.9 * amplitude, 0.0)[0][:n]
    recordings.append(Recording(name="decay", fs=fs, response=x + noise * random.standard_normal(n)))
    return recordings, truth


def paper_stand_again(count: int) -> list[np.ndarray]:
    """The built-in rig under other noises of the same size."""
    clean = {kind: force(kind) for kind in ("bursts", "sweep_low", "sweep_high")}
    motion = {kind: paper_stand(pieces) for kind, pieces in clean.items()}
    rows = []
    for seed in range(count):
        random = np.random.default_rng(100 + seed)
        recordings = []
        for kind, pieces in clean.items():
            x, f = motion[kind][: len(pieces)], pieces[:, 0]
            y = x + SENSOR_NOISE * random.standard_normal(x.size)
            g = f + FORCE_NOISE * np.max(np.abs(f)) * random.standard_normal(f.size)
            recordings.append(Recording(name=kind, fs=FS, response=y, force=g))
        rows.append(scores(recordings, TRUTH))
        print("paper stand", seed, np.round(rows[-1], 2), flush=True)
    return rows


def summary(title: str, rows: list[np.ndarray]) -> None:
    """Root mean square and largest size of the scores, a column a parameter."""
    table = np.array(rows)
    print(f"{title}: {len(rows)} identifications; columns are {', '.join(NAMES)}")
    print("   root mean square", np.round(np.sqrt(np.nanmean(table**2, axis=0)), 2))
    print("   largest         ", np.round(np.nanmax(np.abs(table), axis=0), 2))


def main() -> None:
    """Print one line an identification and the two summaries."""
    rigs, noises = (int(text) for text in (sys.argv[1:] + ["24", "10"][len(sys.argv) - 1 :])[:2])
    rows = []
    for seed in range(rigs):
        recordings, truth = random_rig(1000 + seed)
        try:
            rows.append(scores(recordings, truth))
            print("random rig", seed, np.round(rows[-1], 2), flush=True)
        except DashpotError as problem:
            print("random rig", seed, "refused:", problem, flush=True)
    if rows:
        summary("random rigs", rows)
    if noises:
        summary("the built-in rig", paper_stand_again(noises))


if __name__ == "__main__":
    main()

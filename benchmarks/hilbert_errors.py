"""FREEVIB and FORCEVIB alone on the built-in rig: errors over their own standard errors, at 1, 10, 100 times its noise.

.venv/bin/python -P benchmarks/hilbert_errors.py [--seeds 100] [--sweeps 20]
"""

from __future__ import annotations

import argparse

import numpy as np
from dashpot.examples.rig import FORCE_NOISE, FS, SENSOR_NOISE, force, paper_stand
from dashpot.examples.truth import TRUTH
from dashpot.identify import hilbert_analysis
from dashpot.recording import Recording

LEVELS = (1, 10, 100)


def table(method: str, kind: str, seeds: int) -> None:
    pieces = force(kind)
    true, clean = pieces[:, 0], paper_stand(pieces)
    for level in LEVELS:
        fits = []
        for seed in range(seeds):
            noise = np.random.default_rng(1000 * level + seed)
            measured = true + level * FORCE_NOISE * np.abs(true).max() * noise.standard_normal(true.size)
            response = clean + level * SENSOR_NOISE * noise.standard_normal(true.size)
            if method == "freevib":  # the decays alone, without the force's help in finding them
                parts = [slice(1500 + 5000 * i, 5000 * (i + 1)) for i in range(4)]
                recordings = [Recording(f"decay {i}", FS, response[part]) for i, part in enumerate(parts)]
            else:
                recordings = [Recording(kind, FS, response, measured)]
            fit = getattr(hilbert_analysis(recordings), method)
            if fit is not None:
                fits.append(fit)
        print(f"{method.upper()}, {kind}, {level} times the noise, {len(fits)} of {seeds} seeds")
        for name in fits[0].values:
            off = np.array([fit.values[name] - TRUTH[name] for fit in fits])
            std = np.array([fit.stds[name] for fit in fits])
            print(
                f"  {name:8} error {100 * np.sqrt(np.mean(off**2)) / TRUTH[name]:9.2g} %   over its own standard error "
                f"{np.sqrt(np.mean((off / std) ** 2)):.2f} rms, {np.mean(off / std):+.2f} mean",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--sweeps", type=int, default=20, help="seeds of the sweep, which takes seconds each")
    given = parser.parse_args()
    table("freevib", "bursts", given.seeds)
    table("forcevib", "sweep_high", given.sweeps)
    table("forcevib", "bursts", given.sweeps)


if __name__ == "__main__":
    main()

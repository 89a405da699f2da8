"""Beside other tools, on the same recordings with the same noise: the tables of docs/beside.md.

    pip install lmfit pyOMA-2
    python -P benchmarks/beside.py [SEEDS] [--write]

*scipy* and *lmfit* fit Eq. 17, simulated by ``solve_ivp`` with its signs as they are, to a decay of the built-in rig,
as somebody would write it in an afternoon: start from zero crossings and the envelope, no cubic, preload or friction.
Their errors are those that they state. A row of scipy starts a tenth off the truth, as after good luck. *pyOMA-2*
(covariance-driven subspace identification) and dashpot give frequency and damping of a linear rig from its decay.
What is not installed is left out. Times are processor time of one core.
"""

from __future__ import annotations

import argparse
import logging
import re
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.recording import Recording

PAGE = Path(__file__).resolve().parents[1] / "docs/beside.md"
NAMES = ("omega0", "cubic", "preload", "viscous", "dry")
NOISE, FS, SECONDS, BEGIN = 1e-6, 500.0, 1.5, 8e-3
LINEAR = {**TRUTH, "cubic": 0.0, "preload": 0.0, "dry": 0.0}
#: What one unit of a parameter is for a fit that wants them alike.
SCALE = {"omega0": 80.0, "cubic": 1e5, "preload": 0.1, "viscous": 5.0, "dry": 0.1, "x0": BEGIN, "v0": 0.1}
Answer = tuple[dict[str, float], dict[str, float]]


def start(x: np.ndarray) -> dict[str, float]:
    """Frequency by zero crossings, damping by the envelope, and nothing else."""
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    cycle = (up[-1] - up[0]) / (len(up) - 1) / FS
    peaks = [np.abs(x[a:b]).max() for a, b in pairwise(up)]
    rate = np.log(peaks[0] / peaks[-1]) / (cycle * (len(peaks) - 1))
    none = dict.fromkeys(("cubic", "preload", "dry", "v0"), 0.0)
    return {**none, "omega0": 2 * np.pi / cycle, "viscous": 2 * rate, "x0": x[0]}


def simulated(values: dict[str, float], n: int) -> np.ndarray:
    """(n,) by ``solve_ivp``; far too large where it runs away."""
    from scipy.integrate import solve_ivp

    w2, c, p, h, d = values["omega0"] ** 2, *(values[name] for name in NAMES[1:])

    def rates(_t: float, z: np.ndarray) -> tuple[float, float]:
        return z[1], -h * z[1] - d * np.sign(z[1]) - w2 * z[0] - c * z[0] ** 3 - p * np.sign(z[0])

    t = np.arange(n) / FS
    run = solve_ivp(rates, (0.0, t[-1]), (values["x0"], values["v0"]), t_eval=t, rtol=1e-7, atol=1e-10, max_step=4 / FS)
    return run.y[0] if run.y.shape[1] == n else np.full(n, 1.0)


def near_the_truth(recording: Recording) -> Answer:
    parts = dict(zip(NAMES, (1.0005, 1.1, 0.9, 1.1, 0.9), strict=True))
    return by_scipy(recording, {**{name: parts[name] * TRUTH[name] for name in NAMES}, "x0": BEGIN, "v0": 0.0})


def by_scipy(recording: Recording, begin: dict[str, float] | None = None) -> Answer:
    from scipy.optimize import least_squares

    x, first = recording.response, begin or start(recording.response)
    names = list(SCALE)

    def left(scaled: np.ndarray) -> np.ndarray:
        values = {name: float(u) * SCALE[name] for name, u in zip(names, scaled, strict=True)}
        return (simulated(values, x.size) - x) / NOISE

    fit = least_squares(left, [first[name] / SCALE[name] for name in names], diff_step=1e-5, max_nfev=40)
    spread = np.sqrt(np.diag(np.linalg.pinv(fit.jac.T @ fit.jac)) * 2 * fit.cost / (x.size - len(names)))
    values = {name: u * SCALE[name] for name, u in zip(names, fit.x, strict=True)}
    return values, {name: s * SCALE[name] for name, s in zip(names, spread, strict=True)}


def by_lmfit(recording: Recording) -> Answer:
    import lmfit

    x, first = recording.response, start(recording.response)
    parameters = lmfit.Parameters()
    for name, unit in SCALE.items():
        parameters.add(name, value=first[name] / unit)

    def left(given: lmfit.Parameters) -> np.ndarray:
        return (simulated({name: given[name].value * unit for name, unit in SCALE.items()}, x.size) - x) / NOISE

    fit = lmfit.minimize(left, parameters, epsfcn=1e-10, max_nfev=320)
    found = {name: fit.params[name] for name in SCALE}
    return (
        {name: p.value * SCALE[name] for name, p in found.items()},
        {name: (p.stderr or np.nan) * SCALE[name] for name, p in found.items()},
    )


def by_dashpot(recording: Recording) -> Answer:
    parameters = identify([recording], every=True).oscillator.parameters()
    return (
        {name: parameters[name].value for name in NAMES},
        {name: parameters[name].std or np.nan for name in NAMES},
    )


def linear_by_dashpot(recording: Recording) -> tuple[float, float]:
    parameters = identify([recording]).oscillator.parameters()
    omega = parameters["omega0"].value
    return omega / (2 * np.pi), parameters["viscous"].value / (2 * omega)


def linear_by_pyoma(recording: Recording) -> tuple[float, float]:
    logging.disable(logging.INFO)
    from pyoma2.algorithms import SSI
    from pyoma2.setup import SingleSetup

    x = recording.response
    setup = SingleSetup(np.column_stack([x, np.roll(x, -3)])[:-3], fs=recording.fs)
    algorithm = SSI(name="ssi", method="cov", br=20, ordmax=8)
    setup.add_algorithms(algorithm)
    setup.run_by_name("ssi")
    frequencies, ratios = algorithm.result.Fn_poles[:, 4], algorithm.result.Xi_poles[:, 4]
    near = int(np.nanargmin(np.abs(frequencies - 12.67)))
    return float(frequencies[near]), float(ratios[near])


NONLINEAR: dict[str, Callable[[Recording], Answer]] = {
    "dashpot": by_dashpot,
    "scipy `least_squares`": by_scipy,
    "scipy, a tenth off the truth to begin with": near_the_truth,
    "lmfit": by_lmfit,
}
ONE_MODE = {"dashpot": linear_by_dashpot, "pyOMA-2, SSI": linear_by_pyoma}


def nonlinear(seeds: int) -> str:
    """Errors in per cent (root mean square), the worst in the tool's own standard errors, seconds."""
    rows = ["| tool | " + " | ".join(f"`{name}`" for name in NAMES) + " | worst, in its own errors | seconds |"]
    rows.append("|---" * (len(NAMES) + 3) + "|")
    decays = [recording_of(begin=(BEGIN, 0.0), fs=FS, seconds=SECONDS, seed=10 + i, noise=NOISE) for i in range(seeds)]
    for tool, fit in NONLINEAR.items():
        off, worst, began = [], 0.0, time.process_time()
        try:
            for decay in decays:
                values, errors = fit(decay)
                off.append([values[name] / TRUTH[name] - 1 for name in NAMES])
                worst = max(worst, *(abs(values[name] - TRUTH[name]) / errors[name] for name in NAMES))
        except ImportError as missing:
            print(f"{tool}: {missing}")
            continue
        took = (time.process_time() - began) / seeds
        cells = [f"{100 * value:.2g} %" for value in np.sqrt(np.mean(np.square(off), axis=0))]
        rows.append(f"| {tool} | " + " | ".join(cells) + f" | {worst:.2g} | {took:.2g} |")
    return "\n".join(rows)


def one_mode(seeds: int) -> str:
    """Frequency and damping ratio of a linear rig: root mean square errors over seeds, at two levels of noise."""
    rows = ["| tool | noise | frequency | damping ratio | seconds |", "|---|---|---|---|---|"]
    for noise in (1e-6, 1e-4):
        how = {"begin": (BEGIN, 0.0), "fs": FS, "seconds": SECONDS, "noise": noise}
        decays = [recording_of(LINEAR, **how, seed=30 + i) for i in range(seeds)]
        for tool, fit in ONE_MODE.items():
            began = time.process_time()
            try:
                found = np.array([fit(decay) for decay in decays])
            except ImportError as missing:
                print(f"{tool}: {missing}")
                continue
            took = (time.process_time() - began) / seeds
            true = np.array([LINEAR["omega0"] / (2 * np.pi), LINEAR["viscous"] / (2 * LINEAR["omega0"])])
            frequency, ratio = 100 * np.sqrt(np.mean((found / true - 1) ** 2, axis=0))
            rows.append(f"| {tool} | {1e6 * noise:.0f} µm | {frequency:.2g} % | {ratio:.2g} % | {took:.2g} |")
    return "\n".join(rows)


def main() -> None:
    """Print the tables, and put them into the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="?", default=5)
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    tables = nonlinear(given.seeds), one_mode(given.seeds)
    print("\n\n".join(tables))
    if given.write:
        text = PAGE.read_text("utf-8")
        for number, made in enumerate(tables, start=1):
            mark = f"<!-- table {number} of benchmarks/beside.py -->"
            text = re.sub(re.escape(mark) + r"\n\n(\|.*\n)*", lambda _, m=mark, t=made: f"{m}\n\n{t}\n", text)
        PAGE.write_text(text, "utf-8")


if __name__ == "__main__":
    main()

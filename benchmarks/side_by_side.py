"""The same records by what a user would write, by sparse regression, and by dashpot: error over bound, and seconds.

    python benchmarks/side_by_side.py [SEEDS] [--seconds S] [--ways dashpot pysindy scipy]

A sweep of the built-in rig with its own noises. *scipy* is least squares over a simulation by ``solve_ivp``, sgn and
all, the force interpolated, from a start that is off by a tenth; *pysindy* (an extra of this benchmark alone:
``pip install pysindy``) regresses the acceleration on Eq. 17's functions of smoothed derivatives, as its manual does;
*dashpot* is told nothing. Prints the root mean square over seeds of each error over the Cramér-Rao bound.
"""

from __future__ import annotations

import argparse
import time
from functools import partial

import numpy as np
from cramer_rao import NAMES, Record, bound, motion
from dashpot.examples.force import chirp
from dashpot.examples.rig import DT, FORCE_NOISE, FS, SENSOR_NOISE
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.recording import Recording

#: Steps that least squares may take; each simulates seven times.
_STEPS = 12


def scipy_fit(force: np.ndarray, x: np.ndarray) -> np.ndarray:
    """(6,) by least squares over ``solve_ivp``."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import least_squares

    t = np.arange(x.size) * DT
    start = np.array([1.1, 0.9, 1.1, 0.9, 1.1, 0.9]) * np.array([TRUTH[name] for name in NAMES])

    def left(scaled: np.ndarray) -> np.ndarray:
        m, w, c, p, h, d = scaled * start

        def rates(time: float, z: np.ndarray) -> tuple[float, float]:
            u = float(np.interp(time, t, force)) / m
            return z[1], u - h * z[1] - d * np.sign(z[1]) - w * w * z[0] - c * z[0] ** 3 - p * np.sign(z[0])

        run = solve_ivp(rates, (0.0, t[-1]), (0.0, 0.0), t_eval=t, rtol=1e-6, atol=1e-9, max_step=2 * DT)
        return (run.y[0] - x) / SENSOR_NOISE

    return least_squares(left, np.ones(6), diff_step=1e-4, max_nfev=_STEPS).x * start


def pysindy_fit(force: np.ndarray, x: np.ndarray) -> np.ndarray:
    """(6,) by regression of the acceleration on what Eq. 17 is made of, each column at unit size and without ridge."""
    import pysindy

    smooth = pysindy.SmoothedFiniteDifference(smoother_kws={"window_length": 21, "polyorder": 4})
    v = np.asarray(smooth._differentiate(x[:, None], DT))[:, 0]
    functions = [lambda x: x, lambda x: x**3, lambda x: np.sign(x)]
    library = pysindy.CustomLibrary(functions, [lambda x: x, lambda x: f"{x}^3", lambda x: f"sgn {x}"])
    model = pysindy.SINDy(pysindy.STLSQ(threshold=0.0, alpha=0.0, normalize_columns=True), library, smooth)
    model.fit(np.column_stack([x, v]), t=DT, u=force[:, None])
    row = dict(zip(model.get_feature_names(), np.asarray(model.coefficients())[1], strict=True))
    preload, dry = -row["sgn x0"], -row["sgn x1"]
    return np.array([1 / row["u0"], np.sqrt(max(-row["x0"], 0.0)), -row["x0^3"], preload, -row["x1"], dry])


def dashpot_fit(force: np.ndarray, x: np.ndarray) -> np.ndarray:
    """(6,) by ``identify``."""
    parameters = identify([Recording("sweep", FS, x, force=force)]).oscillator.parameters()
    return np.array([parameters[name].value for name in NAMES])


def main() -> None:
    """Print a line for each way."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="?", default=3)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument(
        "--ways", choices=("dashpot", "pysindy", "scipy"), nargs="+", default=["dashpot", "pysindy", "scipy"]
    )
    given = parser.parse_args()
    n = round(given.seconds * FS)
    pieces = chirp(1.0, 5.0, 15.0 / given.seconds, np.arange(n) / FS, DT)
    record = Record("sweep", pieces, (0.0, 0.0), FS, True, rests=True)
    clean, level = motion(TRUTH, record)[0], FORCE_NOISE * float(np.max(np.abs(pieces[:, 0])))
    least = bound(TRUTH, [record], SENSOR_NOISE, force_noise=[level])
    print(f"{'error over the bound':22}{'s':>8}" + "".join(f"{name:>10}" for name in NAMES))
    ways = {"dashpot": dashpot_fit, "pysindy": pysindy_fit, "scipy": scipy_fit}
    for name in given.ways:
        errors, spent = [], []
        for seed in range(given.seeds):
            random = np.random.default_rng(seed)
            drawn = partial(random.standard_normal, n)
            force, x = pieces[:, 0] + level * drawn(), clean + SENSOR_NOISE * drawn()
            began = time.process_time()
            try:
                errors.append((ways[name](force, x) - np.array([TRUTH[key] for key in NAMES])) / least)
            except ImportError:
                print(f"{name:22} is not installed")
                break
            spent.append(time.process_time() - began)
        else:
            rms = np.sqrt(np.mean(np.square(errors), axis=0))
            print(f"{name:22}{np.median(spent):8.1f}" + "".join(f"{value:10.3g}" for value in rms), flush=True)


if __name__ == "__main__":
    main()

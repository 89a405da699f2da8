"""How near maximum likelihood comes to the least error that is possible, and whether its intervals hold.

    python benchmarks/maximum_likelihood.py [SEEDS] [--records free forced joint] [--noise 1 10] [--seed N] [--jobs N]

The built-in rig is recorded again and again under other noises: 1 is that of its recordings, 1 µm on the displacement
and 0.1 % of the peak on the force, 10 is ten times both. ``free`` are four decays without a force, ``forced`` the two
sweeps, ``joint`` the sweeps and the bursts. Prints for each parameter the root mean square of its error over the
Cramér-Rao bound, the same over its own standard error, and how many of the 95 % intervals hold the truth.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np
from cramer_rao import NAMES, Record, bound, motion
from dashpot.examples.rig import FORCE_NOISE, FS, SENSOR_NOISE, force
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.recording import Recording

#: Samples of a burst, and of a burst with the decay after it.
_DRIVEN, _EACH = 1500, 5000
#: The normal distribution's, of a 95 % interval.
_INSIDE = 1.96


def parts() -> dict[str, list[Record]]:
    """The rig's records as they are fitted: sweeps from rest, bursts, and free decays whose beginning is unknown."""
    sweeps = [Record(kind, force(kind), (0.0, 0.0), FS, True, rests=True) for kind in ("sweep_low", "sweep_high")]
    whole = Record("bursts", force("bursts"), (0.0, 0.0), FS, True)
    x, v = motion(TRUTH, whole)
    decays, bursts = [], []
    for begin in range(0, len(whole.pieces), _EACH):
        end = begin + _DRIVEN
        there = (float(x[begin]), float(v[begin])), (float(x[end]), float(v[end]))
        bursts.append(Record("burst", whole.pieces[begin:end], there[0], FS, True, rests=True))
        decays.append(Record("decay", np.zeros((_EACH - _DRIVEN, 2)), there[1], FS, False))
    return {"free": decays, "forced": sweeps, "joint": [*sweeps, *bursts, *decays]}


def force_noise(record: Record, times: float) -> float:
    """Standard deviation of the noise on a record's force, N."""
    return times * FORCE_NOISE * float(np.max(np.abs(record.pieces[:, 0])))


def recordings(records: Sequence[Record], clean: Sequence[np.ndarray], times: float, seed: int) -> list[Recording]:
    """What was recorded under some noise; the bursts with their decays in one record."""
    random = np.random.default_rng([seed, round(times)])
    made = []
    for i, (record, x) in enumerate(zip(records, clean, strict=True)):
        y = x + times * SENSOR_NOISE * random.standard_normal(x.size)
        f = record.pieces[:, 0] + force_noise(record, times) * random.standard_normal(x.size) if record.driven else None
        made.append(Recording(f"{record.name} {i}", record.fs, y, force=f))
    return made


def found(seed: int, records: Sequence[Record], clean: Sequence[np.ndarray], times: float) -> np.ndarray:
    """(2, 6) values and standard errors of one identification; NaN for what it does not give."""
    parameters = identify(recordings(records, clean, times, seed)).oscillator.parameters()
    nothing = np.full(2, np.nan)
    return np.array([[p.value, p.std or np.nan] if (p := parameters.get(n)) else nothing for n in NAMES]).T


def table(which: str, times: float, least: np.ndarray, rows: np.ndarray) -> None:
    """Print what came of (seeds, 2, 6) identifications."""
    errors = rows[:, 0] - np.array([TRUTH[name] for name in NAMES])
    print(f"{which}, {times:g} times the noise, {len(rows)} seeds:" + " " * 8 + "".join(f"{n:>9}" for n in NAMES))
    inside = 100 * np.mean(np.abs(errors / rows[:, 1]) < _INSIDE, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        over = np.sqrt(np.mean(errors**2, axis=0)) / least
    own = np.sqrt(np.mean((errors / rows[:, 1]) ** 2, axis=0))
    chance = 1 / np.sqrt(2 * len(rows))
    for what, values in (
        (f"error over the bound (chance +-{chance:.2f})", over),
        ("error over its own", own),
        ("% of 95 % intervals", inside),
    ):
        shown = "".join("-".rjust(9) if np.isnan(mean) else f"{v:9.2f}" for v, mean in zip(values, own, strict=True))
        print(f"  {what:38}{shown}", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("seeds", type=int, nargs="?", default=200)
    parser.add_argument(
        "--records", choices=("free", "forced", "joint"), nargs="+", default=["free", "forced", "joint"]
    )
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0, 10.0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    known = parts()
    whole = Record("bursts", force("bursts"), (0.0, 0.0), FS, True)
    for which in given.records:
        fitted = known[which]
        recorded = [*fitted[:2], whole] if which == "joint" else fitted
        names = NAMES[1:] if which == "free" else NAMES
        clean = [motion(TRUTH, record)[0] for record in recorded]
        for times in given.noise:
            disturbed = [force_noise(record, times) for record in fitted]
            least = bound(TRUTH, fitted, times * SENSOR_NOISE, names, force_noise=disturbed)
            one = partial(found, records=recorded, clean=clean, times=times)
            with ProcessPoolExecutor(given.jobs) as pool:
                rows = list(pool.map(one, range(given.seed, given.seed + given.seeds)))
            table(which, times, least, np.array(rows))


if __name__ == "__main__":
    main()

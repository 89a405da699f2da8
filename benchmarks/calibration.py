"""Are standard errors honest, and does every fit end at its optimum? Many rigs and noises, identified blind.

    python benchmarks/calibration.py [RIGS] [--quantity Q] [--records free|forced|joint] [--hold H] [--bound]
                                     [--seed N] [--jobs N]

Prints (found - true) / std of each parameter: an honest error gives a root mean square of one, and 95 % of the scores
lie within 1.96. Where a fit leaves more than noise, or a parameter lies beyond five of its errors, another is begun
at the truth: a fit that is decidedly less likely has missed the optimum, and whether it says so is counted. Rigs are
drawn at random (0.01 to 100 kg, 0.5 to 500 Hz, damping ratio 0.1 to 10 %, a spring that hardens or softens by up to
half at the largest amplitude, 15 to 80 samples a cycle, noise 0.01 to 0.5 % of the amplitude, with and without preload
and dry friction, which the low sweep overcomes) and simulated by the Taylor-series integrator of the examples, which
shares no code with the package. ``--bound``: no noise on the force, and errors are compared with the Cramér-Rao bound
(`cramer_rao.py`); `maximum_likelihood.py` has the built-in rig with all its noises. ``--hold``: how the force runs
between its samples, which is to be found.
"""

from __future__ import annotations

import argparse
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from cramer_rao import NAMES, Record, bound, shown
from dashpot.errors import DashpotError
from dashpot.examples.force import chirp
from dashpot.identify import Identification, identify
from dashpot.model.fit_state import LACKING
from dashpot.recording import Recording

#: Beyond so many errors a parameter is wrong, and a fit that leaves so many times the noise is not at its optimum.
WRONG, REMAINS = 5.0, 1.1
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


@dataclass(frozen=True, eq=False)
class Rig:
    """What is drawn: its parameters in SI, its records, and the noise of the sensor relative to the largest motion."""

    truth: dict[str, float]
    records: tuple[Record, ...]
    noise: float
    force_noise: float


@dataclass(frozen=True)
class Outcome:
    """What became of one rig: scores (6,), errors over the bound (6,), or why it was refused; whether it said so.

    ``behind``: by how much its log-likelihood stays below that of a fit begun at the truth, where that was asked for.
    ``hold`` is what was found of the force between samples; ``biased``: whether a parameter is off by more than its
    standard error where a force that is held or runs straight is taken for smooth.
    """

    scores: np.ndarray
    over_bound: np.ndarray
    remains: float
    told: bool
    refused: str = ""
    hold: str = ""
    biased: bool = False
    behind: float = 0.0

    @property
    def reached(self) -> bool:
        """Whether the fit is at its optimum: as likely as one that was begun at the truth, up to a standard error."""
        return not self.refused and self.behind < 0.5


def held(pieces: np.ndarray, hold: str) -> np.ndarray:
    """The force as it runs between samples: (n, terms) for each step in s."""
    if hold == "smooth":
        return pieces
    samples = pieces[:, 0]
    rise = np.diff(samples, append=samples[-1]) if hold == "linear" else np.zeros_like(samples)
    return np.column_stack([samples, rise])


def random_rig(seed: int, which: str = "joint", force_noise: float = 1e-3, hold: str = "smooth") -> Rig:
    """Two sweeps and a decay of a rig drawn at random, or only the one or the other."""
    random = np.random.default_rng(seed)
    frequency, amplitude, ratio = (10 ** random.uniform([-0.3, -4, -3], [2.7, -2, -1])).tolist()
    omega0 = 2 * np.pi * frequency
    scale = omega0**2 * amplitude
    truth = {
        "mass": 10 ** random.uniform(-2, 2),
        "omega0": omega0,
        "cubic": random.uniform(-0.5, 0.5) * scale / amplitude**3,
        "preload": scale * float(random.choice([0.0, 10 ** random.uniform(-3, -1.3)])),
        "viscous": 2 * ratio * omega0,
        "dry": scale * float(random.choice([0.0, 10 ** random.uniform(-3.3, -1.5)])),
    }
    if which != "free":  # else the low sweep would never set it in motion
        at_resonance = truth["viscous"] * amplitude * omega0
        truth["dry"], truth["preload"] = (
            min(truth["dry"], 0.2 * at_resonance),
            min(truth["preload"], 0.15 * at_resonance),
        )
    samples, cycles = random.uniform([15, 60], [80, 200]).tolist()
    fs = frequency * samples
    noise = 10 ** random.uniform(-4, -2.3)
    top = truth["mass"] * (amplitude * omega0 * truth["viscous"] + 1.27 * truth["dry"])
    n = int(cycles * samples)
    records = []
    for name, level in (("high", top), ("low", 0.35 * top)) if which != "free" else ():
        pieces = chirp(level, 0.5 * frequency, 1.1 * frequency * fs / n, np.arange(n) / fs, 1 / fs)
        records.append(Record(name, held(pieces, hold), (0.0, 0.0), fs, True))
    if which != "forced":
        seen = min(100.0, 3.0 - np.log(noise) / (2 * np.pi * ratio))  # cycles until noise covers it
        still = np.zeros((int(seen * samples), 2))
        records.append(Record("decay", still, (0.9 * amplitude, 0.0), fs, False))
    return Rig(truth, tuple(records), noise, force_noise)


def recordings_of(rig: Rig, quantity: str, seed: int) -> tuple[list[Recording], float]:
    """The rig's records with noise, and the noise's size in the unit of the quantity."""
    random = np.random.default_rng([seed, 1])
    clean = [shown(rig.truth, record, quantity) for record in rig.records]
    noise = rig.noise * max(float(np.max(np.abs(y))) for y in clean)
    made = []
    for record, y in zip(rig.records, clean, strict=True):
        measured = None
        if record.driven:
            measured = record.pieces[:, 0]
            measured = measured + rig.force_noise * np.max(np.abs(measured)) * random.standard_normal(y.size)
        seen = y + noise * random.standard_normal(y.size)
        made.append(Recording(record.name, record.fs, seen, force=measured, unit=UNITS[quantity], quantity=quantity))
    return made, noise


def scores(identification: Identification, truth: dict[str, float]) -> np.ndarray:
    """Distance of each identified parameter from the truth, in its own standard errors."""
    parameters = identification.oscillator.parameters()  # without a mass, where no recording has a force
    found = [parameters.get(name) for name in NAMES]
    return np.array(
        [
            np.nan if p is None else (p.value - truth[name]) / (p.std or np.nan)
            for p, name in zip(found, NAMES, strict=True)
        ]
    )


def _samples(found: Identification) -> list[tuple[int, int, int]]:
    """What was fitted: where a hair decides whether friction holds the mass, stretches are left out."""
    return [(s.segment.recording, s.segment.start, s.segment.stop) for s in found.fit.segments]


def outcome(seed: int, quantity: str, which: str, bounded: bool, hold: str) -> Outcome:
    """One rig identified."""
    rig = random_rig(seed, which, 0.0 if bounded else 1e-3, hold)
    recordings, noise = recordings_of(rig, quantity, seed)
    nothing = np.full(len(NAMES), np.nan)
    biased = False
    try:
        found = identify(recordings)
        if hold != "smooth":
            apart = [
                identify([replace(r, hold=h) for r in recordings]).oscillator.parameters() for h in ("smooth", hold)
            ]
            biased = any(
                abs(p.value - apart[1][name].value) > (apart[1][name].std or np.inf) for name, p in apart[0].items()
            )
    except DashpotError as problem:
        return Outcome(nothing, nothing, np.nan, True, str(problem))
    scored = scores(found, rig.truth)
    remains = max(segment.over_noise for segment in found.fit.segments)
    over = nothing
    if bounded:
        parameters = found.oscillator.parameters()
        names = tuple(n for n in NAMES if n in parameters and parameters[n].std)  # zero too is to be found
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = np.array([parameters[n].value - rig.truth[n] if n in names else np.nan for n in NAMES])
            over = errors / bound(rig.truth, rig.records, noise, names, quantity=quantity)
            over[[name not in names for name in NAMES]] = np.nan
    behind = 0.0
    if remains > REMAINS or np.any(np.nan_to_num(abs(scored)) > WRONG):
        known = {name: p for name, p in found.oscillator.parameters().items() if name in NAMES}
        begun = found.oscillator.with_parameters({n: replace(p, value=rig.truth[n]) for n, p in known.items()})
        again = identify(found.recordings, start=begun, near=True)
        behind = again.fit.log_likelihood - found.fit.log_likelihood
        if _samples(found) != _samples(again):  # likelihoods of other samples: how far apart, in standard errors
            there = again.oscillator.parameters()
            behind = max(0.5 * ((there[n].value - p.value) / (p.std or np.inf)) ** 2 for n, p in known.items())
    told = found.useless is not None or remains >= LACKING
    return Outcome(scored, over, remains, told, hold=found.oscillator.hold, biased=biased, behind=behind)


def summary(title: str, rows: list[np.ndarray]) -> None:
    """Root mean square and largest size of the scores and how many lie within 1.96, a column a parameter."""
    table = np.array(rows)
    print(f"{title}: {len(rows)} identifications; columns are {', '.join(NAMES)}")
    with warnings.catch_warnings(), np.errstate(invalid="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)  # a parameter that no rig has
        known = np.isfinite(table)
        print("   root mean square", np.round(np.sqrt(np.nanmean(table**2, axis=0)), 2))
        print("   median size     ", np.round(np.nanmedian(np.abs(table), axis=0), 2))
        print("   largest         ", np.round(np.nanmax(np.abs(table), axis=0), 2))
        print("   % within 1.96   ", np.round(100 * np.sum(np.abs(table) < 1.96, axis=0) / known.sum(axis=0), 1))


def main() -> None:
    """Print one line an identification and the summaries."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", type=int, nargs="?", default=24)
    parser.add_argument("--quantity", choices=UNITS, default="displacement")
    parser.add_argument("--records", choices=("free", "forced", "joint"), default="joint")
    parser.add_argument("--hold", choices=("smooth", "linear", "zero"), default="smooth")
    parser.add_argument("--bound", action="store_true")
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    one = partial(outcome, quantity=given.quantity, which=given.records, bounded=given.bound, hold=given.hold)
    seeds = range(given.seed, given.seed + given.rigs)
    outcomes: list[Outcome] = []
    with ProcessPoolExecutor(given.jobs) as pool:
        for seed, end in zip(seeds, pool.map(one, seeds), strict=True):
            outcomes.append(end)
            how = end.refused or f"{end.remains:.3g} times the noise, {np.round(end.scores, 2)}"
            verdict = "reached" if end.reached else "missed, told" if end.told else "MISSED IN SILENCE"
            how += f", force {end.hold}" + (", which matters" if end.biased else "")
            how += f", {end.behind:.2g} below a fit begun at the truth" if end.behind else ""
            print(f"random rig {seed}: {verdict}: {how}", flush=True)
    reached = [end for end in outcomes if end.reached]
    if outcomes:
        silent = sum(not end.reached and not end.told for end in outcomes)
        print(f"at the optimum {len(reached)} of {len(outcomes)}; of the others {silent} do not say so")
    if given.hold != "smooth":
        matters = [end for end in outcomes if end.biased]
        right = sum(end.hold == given.hold for end in matters)
        print(f"force {given.hold}: found in {right} of {len(matters)} where another would bias a parameter")
    if reached:
        summary("random rigs at the optimum", [end.scores for end in reached])
    if given.bound and reached:
        summary("their errors over the Cramér-Rao bound", [end.over_bound for end in reached])


if __name__ == "__main__":
    main()

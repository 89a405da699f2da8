"""How well a check before the fit foretells the errors that a fit states, and how often plans reach what they say.

    python -P benchmarks/foretold.py [-n 30] [--plans 12] [--seed 47]

Random rigs of Eq. 17 (3 to 40 Hz, 0.05 to 20 kg), recorded by the reference integrator that shares no code with the
engine: a release, a sweep, both, or sweeps at two levels; displacement, velocity or acceleration; noise of 5e-5 to 5e-3
of the amplitude. Each is checked, then identified. The ratio of expected to stated error is printed for each parameter,
and how many lie within a factor of 1.5. Then tests are planned, for 15 to 70 % of the error
of one parameter that the shortest test leaves, and tried.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Mapping

import numpy as np
from dashpot.errors import DashpotError
from dashpot.examples.virtual_recording import recording_of
from dashpot.foresight.check import check
from dashpot.foresight.plan import Bounds, plan
from dashpot.foresight.virtual import Noise
from dashpot.identify.identification import identify
from dashpot.model import Oscillator
from dashpot.recording import Recording

WITHIN = 1.5


def rig(random: np.random.Generator) -> tuple[dict[str, float], float]:
    """Values of Eq. 17 and an amplitude in m."""
    omega = 2 * np.pi * math.exp(random.uniform(math.log(3), math.log(40)))
    amplitude = math.exp(random.uniform(math.log(0.5e-3), math.log(20e-3)))
    inertia = omega**2 * amplitude
    values = {
        "mass": math.exp(random.uniform(math.log(0.05), math.log(20))),
        "omega0": omega,
        "viscous": 2 * omega * math.exp(random.uniform(math.log(0.004), math.log(0.06))),
        "cubic": random.choice([0, 1]) * random.uniform(0.02, 0.4) * omega**2 / amplitude**2,
        "preload": random.choice([0, 1]) * random.uniform(0.002, 0.03) * inertia,
        "dry": random.choice([0, 1, 1]) * random.uniform(0.001, 0.02) * inertia,
    }
    return {name: float(value) for name, value in values.items()}, float(amplitude)


def recordings(
    kind: int, values: Mapping[str, float], amplitude: float, random: np.random.Generator
) -> list[Recording]:
    """Those of one rig: a release, a sweep, both, or two sweeps."""
    natural = values["omega0"] / (2 * np.pi)
    how = {
        "fs": float(natural * random.uniform(20, 80)),
        "quantity": ["displacement", "acceleration", "velocity"][random.choice(3, p=[0.6, 0.3, 0.1])],
        "noise": float(amplitude * 10 ** random.uniform(-4.3, -2.3)),
    }
    size = values["viscous"] * values["omega0"] * amplitude * random.uniform(0.6, 1.2)
    force = float(values["mass"] * (size + 1.5 * (values["dry"] + values["preload"])))
    long = float(random.uniform(60, 150) / natural)
    seeds = random.integers(1 << 30, size=3)
    band = 0.6 * natural, 1.6 * natural
    made = []
    if kind in (0, 2):
        seconds = float(random.uniform(25, 60) / natural)
        made.append(recording_of(values, begin=(amplitude, 0.0), seconds=seconds, seed=seeds[0], name="release", **how))
    for place, level in enumerate({0: [], 1: [1.0], 2: [1.0], 3: [1.0, 0.6]}[kind]):
        heard = float(force * 10 ** random.uniform(-3.5, -2))
        sweep = (level * force, *band)
        more = {"sweep": sweep, "seconds": long, "force_noise": heard, "seed": seeds[1 + place]}
        made.append(recording_of(values, name=f"sweep {place + 1}", **more, **how))
    return made


def main() -> None:
    """Print a line a rig, then how many are as foretold."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-n", type=int, default=30)
    parser.add_argument("--plans", type=int, default=12)
    parser.add_argument("--seed", type=int, default=47)
    asked = parser.parse_args()
    ratios: list[float] = []
    follows: list[float] = []
    for number in range(asked.n):
        random = np.random.default_rng([asked.seed, number])
        values, amplitude = rig(random)
        given = recordings(number % 4, values, amplitude, random)
        begun = time.process_time()
        try:
            found = check(given)
            took = time.process_time() - begun
            model = identify(given, every=False).oscillator
        except (DashpotError, np.linalg.LinAlgError) as problem:
            print(f"{number:3d} {problem}", flush=True)
            continue
        known = model.parameters()
        each = {
            told.name: told.std / std
            for told in found.parameters
            if told.std is not None and told.name not in found.left_out and (std := known[told.name].std)
        }
        ratios += each.values()
        follows += each.values() if found.follows else ()
        words = " ".join(f"{name} {ratio:.2f}" for name, ratio in each.items())
        print(f"{number:3d} {took:5.2f} s {'' if found.follows else 'rough '}{words}", flush=True)
    for what, some in (("all", ratios), ("where the start leaves noise", follows)):
        size, (low, high) = np.abs(np.log(some)), np.quantile(some, (0.05, 0.95))
        print(
            f"{what}: {np.sum(size <= math.log(WITHIN))} of {len(some)} errors within a factor of {WITHIN}, "
            f"median ratio {np.median(some):.2f}, 5 to 95 %: {low:.2f} to {high:.2f}"
        )
    told = tried = reached = covered = 0
    for number in range(asked.plans):
        random = np.random.default_rng([asked.seed, 1, number])
        values, amplitude = rig(random)
        name = str(random.choice([name for name in values if values[name]]))
        share = float(random.uniform(0.15, 0.7))
        noise = Noise(
            float(amplitude * 10 ** random.uniform(-4.3, -3)),
            1e-3 * values["mass"] * values["omega0"] ** 2 * amplitude * 0.05,
        )
        model = Oscillator.from_values(values, name="rig")
        begun = time.process_time()
        try:
            bounds = Bounds(amplitude, seconds=100.0 * 2 * np.pi / values["omega0"] * 10)
            (easy,) = plan(model, [f"{name} 1000%"], bounds, noise, tries=0).expected
            found = plan(model, [f"{name} {share * easy:.6g}"], bounds, noise, tries=3)
        except DashpotError as problem:
            print(f"plan {number:3d} {problem}", flush=True)
            continue
        told += found.tells
        if found.tells:
            tried += len(found.trials)
            reached += found.reached
            covered += sum(t.off[0] <= 2 * t.stated[0] for t in found.trials)
        took, said = time.process_time() - begun, found.excitation.sentence()
        print(f"plan {number:3d} {took:5.1f} s {name} {share:.2f}: {said}; {found.tells} {found.reached}", flush=True)
    print(
        f"plans: {told} of {asked.plans} tell what is wanted; of their {tried} trials {reached} reached it, and the "
        f"truth lay within twice the stated error in {covered}"
    )


if __name__ == "__main__":
    main()

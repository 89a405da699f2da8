"""How often the law that a specimen hides is named along prescribed motions, and how its numbers hold.

    python benchmarks/prescribed_population.py [--n N] [--seed S] [--json OUT.json]

Random specimens of `examples/specimens.py`: members of Eq. 17 in newtons, of strokes from 0.3 mm to 50 mm and 0.2 to
10 Hz, and in every ninth case nothing, else one of the laws there, as strong as a quarter to seven tenths of the rest.
Two motions are fitted and a third, of another level, is held out; of sines at several levels, a sweep, triangles and
random motion each has three. Force and motion are noisy. A law is named first, alone or in the group of what cannot be
told from it. Parameters beside the true law are held against their standard errors.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from dashpot.examples.specimens import LAWS, Specimen, motion, recorded
from dashpot.model.library import find
from dashpot.prescribed.element_fit import diagnose_element, identify_element
from dashpot.recording import Recording

#: What is hidden, in turn; nothing twice.
HIDDEN = ("", "", *LAWS)


@dataclass(frozen=True)
class Rig:
    """A specimen and its three recordings, the last one held out."""

    specimen: Specimen
    recordings: tuple[Recording, ...]


def rig_of(seed: int) -> Rig:
    """One of the population."""
    rng = np.random.default_rng(seed)
    law = HIDDEN[seed % len(HIDDEN)]
    length, frequency = 10 ** rng.uniform(-3.5, -1.3), 10 ** rng.uniform(-0.7, 1.0)
    fs, seconds = frequency * float(rng.choice([100.0, 200.0])), rng.uniform(10.0, 20.0) / frequency
    speed, size = 2 * np.pi * frequency * length, 10 ** rng.uniform(1.0, 4.0)
    members = {
        "inertia": float(rng.choice([0.0, rng.uniform(0.02, 0.2)])) * size / (speed * 2 * np.pi * frequency),
        "stiffness": rng.uniform(0.0, 1.0) * size / length,
        "cubic": float(rng.choice([0.0, rng.uniform(-0.2, 0.4)])) * size / length**3,
        "viscous": rng.uniform(0.1, 0.7) * size / speed,
        "dry": float(rng.choice([0.0, rng.uniform(0.05, 0.4)])) * size,
        "load": rng.uniform(-1.0, 1.0) * size,
    }
    kinds = rng.permutation(["sines", "sweep", "triangle", "random"])[:3]
    levels = (1.0, rng.uniform(0.4, 0.8), rng.uniform(0.6, 0.95))
    motions = [
        motion(str(kind), length * level, frequency, fs, seconds, seed)
        for kind, level in zip(kinds, levels, strict=True)
    ]
    part, numbers = rng.uniform(0.25, 0.7), _numbers(law, rng, length, speed)
    specimen = Specimen(members, law, numbers)
    noise, moved = 10 ** rng.uniform(-3.0, -2.0), 10 ** rng.uniform(-5.0, -3.7)
    if law:  # as strong as that part of the rest, where it is recorded first
        plain, whole = (recorded(s, motions[0], fs).force for s in (Specimen(members), specimen))
        assert plain is not None
        assert whole is not None
        times = part * float(np.std(plain)) / max(float(np.std(whole - plain)), 1e-12)
        strengths = [p.name for p in find(law).parameters if p.strength]
        numbers = {name: value * (times if name in strengths else 1.0) for name, value in numbers.items()}
        specimen = replace(specimen, numbers=numbers)
    how = {"noise": noise, "motion_noise": moved}
    made = [recorded(specimen, x, fs, **how, seed=10 * seed + i) for i, x in enumerate(motions)]
    return Rig(specimen, tuple(made))


def _numbers(law: str, rng: np.random.Generator, length: float, speed: float) -> dict[str, float]:
    """Numbers of a law, its strengths one; drawn in the same number whatever the law."""
    a, b, c = rng.uniform(size=3)
    small = length * 10 ** (-2.0 + 0.8 * a)
    known: dict[str, dict[str, float]] = {
        "hysteresis": {"stiffness": 1.0, "limit": small * 2, "exponent": 1.0, "loading": 0.5},
        "viscoelastic": {"stiffness": 1.0, "rate": speed / length * 10 ** (-1.0 + 1.3 * a)},
        "nonlinear-maxwell": {"stiffness": 1.0, "limit": 2 * small, "speed": 0.3 * speed, "exponent": 1.5 + 3 * b},
        "lugre": {"stiffness": 1.0, "damping": 0.0, "limit": small, "excess": b, "speed": speed * (0.05 + 0.1 * c)},
        "stribeck": {"excess": 1.0, "speed": speed * (0.03 + 0.2 * a), "exponent": 1.0},
        "two-sided-stop": {"stiffness": 1.0, "position": length * (0.4 + 0.3 * a)},
        "one-sided-stop": {"stiffness": 1.0, "position": length * (0.1 + 0.5 * a)},
        "softening-stiffness": {"stiffness": 1.0, "width": length * (0.15 + 0.3 * a)},
        "digressive-damping": {"force": 1.0, "speed": speed * (0.05 + 0.3 * a)},
        "gas-spring": {"force": 1.0, "length": length * (1.3 + 2 * a), "exponent": 1.3},
        "exponential-spring": {"force": 1.0, "length": length * (0.25 + 0.3 * a)},
        "asymmetric-friction": {"viscous": 1.0},
    }
    return known.get(law, {"coefficient": 1.0})


def score(seed: int) -> dict[str, object]:
    """What came out of one rig."""
    rig, begin = rig_of(seed), time.perf_counter()
    law, (one, other, held) = rig.specimen.law, rig.recordings
    found = diagnose_element([one, other], [held])
    seconds = time.perf_counter() - begin
    named = [named.law.name for named in found.found.named]
    groups = [{n.law.name, *n.rivals} for n in found.found.named]
    fit = identify_element(rig.recordings, laws=[law] if law else [], every=True)
    known = fit.element.parameters()
    errors = {
        name: (known[name].value - value) / std
        for name, value in rig.specimen.members.items()
        if (std := known[name].std)
    }
    return {
        "seed": seed,
        "law": law or "none",
        "named": named,
        "first": bool(named) and named[0] == law,
        "alone": named == [law],
        "group": any(law in group for group in groups),
        "probability": [round(n.probability, 4) for n in found.found.named],
        "errors": {name: round(float(value), 2) for name, value in errors.items()},
        "over_noise": [round(record.over_noise, 2) for record in (*found.best.records, *found.held_after)],
        "seconds": round(seconds, 1),
    }


def main() -> None:
    """Print one line a rig and the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=34)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    rows = []
    for seed in range(given.seed, given.seed + given.n):
        row = score(seed)
        rows.append(row)
        words = "named " + (", ".join(map(str, row["named"])) or "nothing")  # pyright: ignore[reportArgumentType]
        print(
            f"{seed:6} {row['law']:22} {words}; {row['probability']}; {row['errors']}; {row['seconds']} s", flush=True
        )
    hidden, plain = [r for r in rows if r["law"] != "none"], [r for r in rows if r["law"] == "none"]
    for what in ("first", "alone", "group"):
        print(f"{what}: {sum(bool(r[what]) for r in hidden)} of {len(hidden)}")
    print(f"named where nothing is hidden: {sum(bool(r['named']) for r in plain)} of {len(plain)}")
    off = np.abs([value for r in rows for value in r["errors"].values()])  # pyright: ignore[reportAttributeAccessIssue]
    print(f"members: {np.mean(off < 2):.2f} within 2 errors, {np.mean(off < 3):.2f} within 3, of {off.size}")
    seconds = np.array([r["seconds"] for r in rows], float)
    print(f"seconds: median {np.median(seconds):.1f}, worst {np.max(seconds):.1f}")
    if given.json:
        given.json.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()

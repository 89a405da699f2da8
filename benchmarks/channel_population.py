"""How often a strength that depends on a channel is found along prescribed motions, and how its numbers hold.

    python benchmarks/channel_population.py [--n N] [--seed S] [--json OUT.json]

Random specimens as in `prescribed_population.py`. Of each five one has a channel on which nothing depends; of the
others a strength depends on a temperature, a pressure, a current, a gap or a load, by a quarter to three times over
what was recorded. The channel is one number for each of three files, or a column that drifts or swings while the
machine runs. In every third specimen a law is missing besides. A fourth recording is held out. A dependence is named
right where strength and channel are; its form where that is the true one, or among those that are said not to be told
from it.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from dashpot.examples.specimens import Specimen, motion, recorded
from dashpot.model.dependence import FORMS
from dashpot.model.library import find
from dashpot.prescribed.element_fit import diagnose_element, identify_element
from dashpot.recording import Recording
from dashpot.recording.channel import Channel
from prescribed_population import _numbers

#: What depends on what, and how; in turn, with none after four.
WAYS = (
    ("dry", "pressure", "linear"),
    ("viscous", "temperature", "inverse"),
    ("viscous", "current", "linear"),
    ("dry", "load", "origin"),
    ("stiffness", "gap", "power"),
    ("viscous", "temperature", "linear"),
    ("law", "current", "linear"),
    ("dry", "pressure", "power"),
)
#: Units, and what is recorded of each.
RANGES = {
    "pressure": ("Pa", 1e5, 7e5),
    "temperature": ("degC", 18.0, 75.0),
    "current": ("A", 0.0, 1.5),
    "load": ("N", 20.0, 120.0),
    "gap": ("m", 1e-3, 4e-3),
}
#: What is missing besides, in every third.
BESIDE = ("quadratic-drag", "hysteresis", "lugre", "digressive-damping", "two-sided-stop", "nonlinear-maxwell")


@dataclass(frozen=True)
class Rig:
    """A specimen's numbers, its recordings (the last one held out), and what depends on which channel."""

    values: dict[str, float]
    law: str
    way: tuple[str, str, str] | None
    channel: str
    recordings: tuple[Recording, ...]


def rig_of(seed: int) -> Rig:
    """One of the population."""
    rng = np.random.default_rng(10_000 + seed)
    place = seed - seed // 5
    way = None if seed % 5 == 4 else WAYS[place % len(WAYS)]
    law = BESIDE[(seed // 3) % len(BESIDE)] if seed % 3 == 0 else ""
    channel = WAYS[place % len(WAYS)][1] if way is None else way[1]
    if way is not None and way[0] == "law":
        law = law if law in ("hysteresis", "lugre", "nonlinear-maxwell") else "nonlinear-maxwell"
    unit, low, high = RANGES[channel]
    length, frequency = 10 ** rng.uniform(-3.0, -1.5), 10 ** rng.uniform(-0.5, 0.8)
    fs, seconds = frequency * float(rng.choice([100.0, 200.0])), rng.uniform(12.0, 20.0) / frequency
    speed, size = 2 * np.pi * frequency * length, 10 ** rng.uniform(1.0, 4.0)
    members = {
        "inertia": float(rng.choice([0.0, rng.uniform(0.02, 0.2)])) * size / (speed * 2 * np.pi * frequency),
        "stiffness": rng.uniform(0.2, 1.0) * size / length,
        "viscous": rng.uniform(0.2, 0.7) * size / speed,
        "dry": rng.uniform(0.1, 0.4) * size,
        "load": rng.uniform(-1.0, 1.0) * size,
    }
    numbers = _numbers(law, rng, length, speed) if law else {}
    kinds = rng.permutation(["sines", "sweep", "triangle", "random"])
    levels = (1.0, rng.uniform(0.4, 0.8), rng.uniform(0.6, 0.95), rng.uniform(0.5, 0.9))
    motions = [
        motion(str(kind), length * level, frequency, fs, seconds, seed)
        for kind, level in zip(kinds, levels, strict=True)
    ]
    column = bool(rng.integers(2))
    channels = [_channel(rng, column, i, x.size, low, high) for i, x in enumerate(motions)]
    reference, times = 0.5 * (low + high), rng.uniform(1.25, 4.0) ** float(rng.choice([1.0, 1.0, -1.0]))
    if law:  # as strong as that part of the rest
        first = motions[0]
        plain, whole = (recorded(s, first, fs).force for s in (Specimen(members), Specimen(members, law, numbers)))
        assert plain is not None
        assert whole is not None
        part = rng.uniform(0.3, 0.7) * float(np.std(plain)) / max(float(np.std(whole - plain)), 1e-12)
        strong = {p.name for p in find(law).parameters if p.strength}
        numbers = {name: value * (part if name in strong else 1.0) for name, value in numbers.items()}
    values = members | {f"{law}.{name}": value for name, value in numbers.items()}
    own = _own(way, low, high, times)
    noise, moved = 10 ** rng.uniform(-3.0, -2.0), 10 ** rng.uniform(-5.0, -3.7)
    made = []
    for i, (x, channel_values) in enumerate(zip(motions, channels, strict=True)):
        m, n = dict(members), dict(numbers)
        if way is not None:
            of, _, how = way
            target, name = (n, _strength(law)) if of == "law" else (m, of)
            at = np.asarray(channel_values, float)
            target[name] = FORMS[how].value(
                target[name], own * (target[name] if how == "linear" else 1.0), at, reference
            )  # pyright: ignore
        specimen = Specimen(m, law, n)
        one = recorded(specimen, x, fs, noise=noise, motion_noise=moved, seed=10 * seed + i)
        seen = channel_values + (0.002 * (high - low) * rng.standard_normal(x.size) if column else 0.0)
        made.append(replace(one, channels=(Channel(channel, unit, seen if column else float(channel_values)),)))
    if way is not None:
        of = f"{law}.{_strength(law)}" if way[0] == "law" else way[0]
        way = (of, way[1], way[2])
        if (word := FORMS[way[2]].parameter) != "":
            values[f"{of}.{channel}_{word}"] = own * (values[of] if way[2] == "linear" else 1.0)
    return Rig(values, law, way, channel, tuple(made))


def _strength(law: str) -> str:
    return next(p.name for p in find(law).parameters if p.strength)


def _channel(rng: np.random.Generator, column: bool, place: int, n: int, low: float, high: float) -> np.ndarray | float:
    """A number for each file, or (n,): it warms up, or swings."""
    if not column:
        return low + (high - low) * (0.0, 1.0, rng.uniform(0.3, 0.7), rng.uniform(0.2, 0.8))[place]
    time = np.linspace(0.0, 1.0, n)
    begin, end = sorted(rng.uniform(0.0, 1.0, 2) * 0.3 + np.array([0.0, 0.7]))
    swing = 0.5 - 0.5 * np.cos(np.pi * rng.uniform(1.5, 4.0) * time)
    shape = (1.0 - np.exp(-3.0 * time)) / (1.0 - np.exp(-3.0)) if rng.integers(2) else swing
    return low + (high - low) * (begin + (end - begin) * shape)


def _own(way: tuple[str, str, str] | None, low: float, high: float, times: float) -> float:
    """A form's own number, relative of linear, by which the strength grows so many times from one end to the other."""
    if way is None or way[2] == "origin":
        return 0.0
    if way[2] == "power":
        return float(np.log(times) / np.log(high / low))
    ratio = (times - 1.0) / (times + 1.0) / (0.5 * (high - low))
    return ratio if way[2] == "linear" else -ratio


def score(seed: int) -> dict[str, object]:
    """What came out of one rig."""
    rig, begin = rig_of(seed), time.process_time()
    found = diagnose_element(rig.recordings[:3], rig.recordings[3:])
    seconds = time.process_time() - begin
    laws = [named.law.name for named in found.found.named]
    ways = [named.way for named in found.found.dependent]
    pair = None if rig.way is None else rig.way[:2]
    right = [named for named in found.found.dependent if (named.way.of, named.way.channel) == pair]
    forms = {rival for named in right for rival in (str(named.way), *named.rivals)}
    asked = [rig.law] if rig.law else []
    asked += [":".join(rig.way)] if rig.way else []
    fit = identify_element(rig.recordings, laws=asked, every=True)
    known, stated = fit.element.parameters(), fit.element
    truth = _at_reference(rig, stated.channels[rig.channel].reference) if stated.channels else rig.values
    if rig.law == "nonlinear-maxwell":  # whose limit is stated at a speed of its own
        own = {name: truth[f"{rig.law}.{name}"] for name in ("limit", "speed", "exponent")}
        times = known[f"{rig.law}.speed"].value / own["speed"]
        truth = truth | {f"{rig.law}.limit": own["limit"] * times ** (1.0 / own["exponent"])}
    errors = {name: (known[name].value - value) / std for name, value in truth.items() if (std := known[name].std)}
    own = rig.way is not None and f"{rig.way[0]}({rig.way[1]}, {rig.way[2]})"
    return {
        "seed": seed,
        "law": rig.law or "none",
        "way": str(own or "none"),
        "column": not isinstance(rig.recordings[0].channels[0].values, float),
        "laws": laws,
        "ways": list(map(str, ways)),
        "first": bool(ways) and (ways[0].of, ways[0].channel) == pair,
        "there": bool(right),
        "alone": len(ways) == 1 and bool(right) and set(laws) <= {rig.law},
        "form": own in forms,
        "false": [str(way) for way in ways if (way.of, way.channel) != pair],
        "false laws": [name for name in laws if name != rig.law],
        "group": [list(named.rivals) for named in found.found.dependent],
        "errors": {name: round(float(value), 2) for name, value in errors.items()},
        "over_noise": [round(record.over_noise, 2) for record in (*found.best.records, *found.held_after)],
        "seconds": round(seconds, 1),
    }


def _at_reference(rig: Rig, reference: float) -> dict[str, float]:
    """The true numbers where the channel has another reference value."""
    if rig.way is None:
        return rig.values
    of, channel, how = rig.way
    _, low, high = RANGES[channel]
    word, middle, values = FORMS[how].parameter, 0.5 * (low + high), dict(rig.values)
    name = f"{of}.{channel}_{word}"
    own = values.get(name, 0.0)
    values[of] = float(FORMS[how].value(values[of], own, reference, middle))
    if how == "inverse":
        values[name] = own / (1.0 + own * (reference - middle))
    return values


def main() -> None:
    """Print one line a rig and the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=30)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    rows = []
    for seed in range(given.seed, given.seed + given.n):
        row = score(seed)
        rows.append(row)
        kind = "column" if row["column"] else "numbers"
        print(
            f"{seed:5} {row['way']} + {row['law']}, {kind}: ways {row['ways']} not told {row['group']}, laws "
            f"{row['laws']}; {row['errors']}; {row['over_noise']}; {row['seconds']} s",
            flush=True,
        )
    hidden, plain = [r for r in rows if r["way"] != "none"], [r for r in rows if r["way"] == "none"]
    for what in ("first", "there", "alone", "form"):
        print(f"{what}: {sum(bool(r[what]) for r in hidden)} of {len(hidden)}")
    print(f"a further dependence named beside a true one: {sum(bool(r['false']) for r in hidden)} of {len(hidden)}")
    print(f"named where nothing depends: {sum(bool(r['false']) for r in plain)} of {len(plain)}")
    print(f"a law named that is not there: {sum(bool(r['false laws']) for r in rows)} of {len(rows)}")
    off = np.abs([value for r in rows for value in r["errors"].values()])  # pyright: ignore[reportAttributeAccessIssue]
    print(f"numbers: {np.mean(off < 2):.3f} within 2 errors, {np.mean(off < 3):.3f} within 3, of {off.size}")
    seconds = np.array([r["seconds"] for r in rows], float)
    print(f"seconds: median {np.median(seconds):.1f}, worst {np.max(seconds):.1f}")
    if given.json:
        given.json.write_text(json.dumps(rows, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()

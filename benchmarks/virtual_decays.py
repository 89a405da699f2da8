"""Virtual decays of pendulums, held before and caught after: how many are found, and how many identified.

    python benchmarks/virtual_decays.py [COUNT] [--identify] [--seed N]

A sine spring with dry and viscous friction, let go at 0.2 to 2.8 rad, 0.5 to 5 Hz, sampled at 50 Hz to 2 kHz, 5 to 200
cycles; a hand that holds it before, one that catches it after, an offset of the sensor, noise or an encoder's steps.
The integrator shares no code with the package.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.identify.motion.decays import find_free_motion
from dashpot.recording import Recording

#: A decay is found where it begins within so many cycles of the release, ends no later than so many after the catch,
#: and holds this part of the free cycles that are large enough to be seen.
_LATE, _BEYOND, _PART = 3.0, 0.5, 0.7


@dataclass(frozen=True, eq=False)
class Virtual:
    """One recording and the truth in rad/s, 1/s, rad/s².

    Then the samples between which the motion is free and seen, where a loud one is caught, and those of a cycle.
    """

    recording: Recording
    omega: float
    viscous: float
    dry: float
    start: int
    stop: int
    caught: int | None
    period: float


def free_swings(omega: float, viscous: float, dry: float, begin: float, t: np.ndarray) -> np.ndarray:
    """Angle (n,) of x'' + viscous x' + dry sgn x' + omega² sin x = 0 from rest at ``begin``, at times (n,)."""
    from scipy.integrate import solve_ivp

    x, now, angle = np.full(t.size, np.nan), 0.0, begin
    while now <= t[-1]:
        if omega**2 * abs(np.sin(angle)) <= dry:
            x[t >= now] = angle
            break
        way = -np.sign(np.sin(angle))

        def rates(_: float, y: np.ndarray, way: float = way) -> list[float]:
            return [y[1], -viscous * y[1] - dry * way - omega**2 * np.sin(y[0])]

        def turns(_: float, y: np.ndarray) -> float:
            return float(y[1])

        turns.terminal, turns.direction = True, -way  # type: ignore[attr-defined]
        until = now + 60.0 / omega
        first = [angle + 1e-12 * way, 1e-9 * way]
        run = solve_ivp(rates, (now, until), first, events=turns, dense_output=True, rtol=1e-9, atol=1e-11)
        inside = (t >= now) & (t <= run.t[-1])
        x[inside] = run.sol(t[inside])[0]
        now, angle = float(run.t[-1]), float(run.y[0, -1])
    return x


def virtual(seed: int) -> Virtual:
    """One of the set."""
    random = np.random.default_rng(seed)
    frequency = np.exp(random.uniform(np.log(0.5), np.log(5.0)))
    fs = np.exp(random.uniform(np.log(max(50.0, 20 * frequency)), np.log(2000.0)))
    if seed % 4 == 0:
        frequency, fs = 0.8, 100.0
    omega = 2 * np.pi * frequency
    cycles = np.exp(random.uniform(np.log(5.0), np.log(200.0)))
    begin = random.uniform(0.2, 2.8) * random.choice([-1.0, 1.0])
    cycles = min(cycles, 150_000 / fs * frequency)
    viscous = 2 * np.exp(random.uniform(np.log(0.3), np.log(5.0))) / (cycles / frequency)
    dry = random.uniform(0.0, 0.3) * omega**2 * abs(np.sin(min(abs(begin), 1.0))) / (2 * cycles)
    held, after = random.uniform(0.0, 5.0) / frequency, random.uniform(0.0, 5.0) / frequency
    caught = random.random() < 0.5
    seconds = cycles / frequency
    t = np.arange(round(seconds * fs)) / fs
    swing = free_swings(omega, viscous, dry, begin, t)
    before = np.full(round(held * fs), begin)
    parts = [before, swing]
    if caught:
        hand = np.exp(-np.arange(round(after * fs) + 1) / fs / (0.05 / frequency))
        parts.append(swing[-1] * hand[1:])
    x = np.concatenate(parts)
    noise = 10 ** random.uniform(-4, -2.3) * abs(begin)
    step = noise * 3.0 if random.random() < 0.3 else 0.0
    x = x + noise * random.standard_normal(x.size) + random.uniform(-0.5, 0.5)
    if step:
        x = step * np.round(x / step)
    peaks = np.array([np.ptp(part) / 2 for part in np.array_split(swing, max(1, int(cycles)))])
    small = np.flatnonzero(peaks < 6 * noise)
    seen = swing.size if not small.size else int(small[0] / peaks.size * swing.size)
    recording = Recording(f"virtual {seed}", float(fs), x, unit="rad")
    return Virtual(
        recording,
        omega,
        viscous,
        dry,
        before.size,
        before.size + seen,
        before.size + swing.size if caught and peaks[-1] > 0.1 * abs(begin) else None,
        fs / frequency,
    )


def is_found(case: Virtual) -> str:
    """Empty where the decay is found; else what is wrong."""
    decays = find_free_motion(case.recording).decays
    if not decays:
        return "none"
    best = max(decays, key=lambda decay: decay.stop - decay.start)
    if best.start < case.start - 0.25 * case.period:
        return "early"
    if best.start > case.start + _LATE * case.period:
        return "late"
    if case.caught is not None and best.stop > case.caught + _BEYOND * case.period:
        return "beyond"
    return "" if best.stop - best.start > _PART * (case.stop - case.start) else "part"


def is_identified(case: Virtual) -> bool:
    """Whether frequency at rest and viscous friction come out within three of their errors with a sine spring."""
    try:
        oscillator = identify([case.recording], effects=["softening-stiffness/sine"]).oscillator
    except BadInput:
        return False
    value = oscillator.values()
    stiffness = value["omega0"] ** 2 + value["softening-stiffness/sine.stiffness"]
    known = oscillator.parameters()
    spread = np.hypot(
        2 * value["omega0"] * (known["omega0"].std or 0.0), known["softening-stiffness/sine.stiffness"].std or 0.0
    )
    near = abs(value["viscous"] - case.viscous) < 3 * (known["viscous"].std or 0.0)
    return bool(near and abs(stiffness - case.omega**2) < 3 * spread)


def main() -> None:
    """Print the share that is found and identified, and what is wrong with the others."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int, nargs="?", default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--step", type=int, default=1, help="4 for exact 0.8 Hz at 100 Hz")
    parser.add_argument("--identify", action="store_true")
    given = parser.parse_args()
    hits = identified = 0
    for seed in range(given.seed, given.seed + given.count * given.step, given.step):
        case = virtual(seed)
        wrong = is_found(case)
        hits += not wrong
        if wrong:
            cycles = (case.stop - case.start) / case.period
            print(
                f"{seed}: {wrong}; {cycles:.1f} cycles of {case.period:.0f} samples from {case.start / case.period:.1f}"
            )
        elif given.identify:
            identified += is_identified(case)
    print(f"found {hits} of {given.count}" + (f", identified {identified}" if given.identify else ""))


if __name__ == "__main__":
    main()

"""Recordings that lie, as data: what a measuring chain does to records of a virtual rig, and what must be said of it.

A lie leaves numbers that look like a recording. Each is named by its kind, the words of which one must stand in the
sentence that a user gets, and by the record it was told in.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..recording.recording import QUANTITIES, Recording
from .truth import TRUTH
from .virtual_recording import recording_of

Change = Callable[[Recording], Recording]


@dataclass(frozen=True)
class Stand:
    """A virtual rig and how it is recorded: a decay, a weak sweep, a strong one.

    `begin` m is where it is let go, `force` N the peak of the strong sweep, `noise` m that of the displacement; that of
    the force is a thousandth of its peak.
    """

    values: Mapping[str, float]
    begin: float
    force: float
    noise: float
    fs: float
    cycles: float = 150.0
    quantity: str = "displacement"

    def clean(self, **values: float) -> list[Recording]:
        """Its three recordings without noise; `values` are those in which it is another rig."""
        rig = dict(self.values) | values
        frequency = self.values["omega0"] / (2 * np.pi)
        common = {"fs": self.fs, "quantity": self.quantity, "noise": 0.0}
        low, high = 0.5 * frequency, 1.6 * frequency
        driven = {"seconds": self.cycles / frequency} | common
        return [
            recording_of(rig, begin=(self.begin, 0.0), seconds=60 / frequency, name="decay.csv", **common),
            recording_of(rig, sweep=(0.4 * self.force, low, high), name="weak.csv", **driven),
            recording_of(rig, sweep=(self.force, high, low), name="strong.csv", **driven),
        ]

    def noisy(self, recordings: Sequence[Recording], seed: int = 0) -> list[Recording]:
        """The recordings with the noise of their sensors."""
        size = self.noise * self.values["omega0"] ** QUANTITIES.index(self.quantity)
        made = []
        for i, r in enumerate(recordings):
            random = np.random.default_rng([seed, i])
            response = r.response + size * random.standard_normal(r.n)
            force = r.force
            if force is not None:
                force = force + 1e-3 * np.max(np.abs(force)) * random.standard_normal(r.n)
            made.append(replace(r, response=response, force=force))
        return made


STANDS = {
    "built-in": Stand(TRUTH, 9e-3, 1.0, 1e-6, 500.0),
    "slow": Stand(
        {"mass": 3.0, "omega0": 14.0, "cubic": 900.0, "preload": 0.0, "viscous": 0.5, "dry": 0.03},
        0.08, 4.0, 3e-5, 100.0,
    ),
    "fast": Stand(
        {"mass": 0.04, "omega0": 300.0, "cubic": -4e8, "preload": 0.3, "viscous": 9.0, "dry": 0.5},
        2e-3, 0.1, 1e-6, 2500.0, quantity="velocity",
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Lie:
    """One thing that a measuring chain does to one of the recordings.

    `kind` is what it is; `record` the place of the recording that lies; `change` what happens to it, `last` with the
    noise already on it.
    """

    name: str
    kind: str
    record: int
    change: Change
    last: bool = False


def told(stand: Stand, lie: Lie | None, seed: int = 0) -> list[Recording]:
    """The recordings of a stand with that lie among them, or none."""
    clean = stand.clean()
    lying = [lie.change(r) if lie is not None and i == lie.record else r for i, r in enumerate(clean)]
    if lie is not None and lie.last:
        return [lie.change(r) if i == lie.record else r for i, r in enumerate(stand.noisy(clean, seed))]
    return stand.noisy(lying, seed)


def response_gain(by: float, since: float) -> Change:
    """The response counts `by` times from that part of the record on."""
    return lambda r: replace(r, response=np.where(_part(r) < since, 1.0, by) * r.response)


def force_gain(by: float, since: float) -> Change:
    """The force counts `by` times from that part of the record on."""
    return lambda r: replace(r, force=np.where(_part(r) < since, 1.0, by) * r.force)


def late(seconds: float) -> Change:
    """The response comes late by so much: of the two channels one is read later."""

    def change(r: Recording) -> Recording:
        from scipy.interpolate import CubicSpline

        shown = CubicSpline(r.time, r.response)(np.maximum(r.time - seconds, r.start))
        return replace(r, response=shown).slice(0, r.n - max(0, round(-seconds * r.fs)))

    return change


def hum(hertz: float, part: float) -> Change:
    """A line on the response, of that part of its rms."""
    return lambda r: replace(r, response=r.response + part * np.std(r.response) * _tone(r, hertz))


def force_hum(hertz: float, part: float) -> Change:
    """A line on the recorded force, of that part of its rms."""
    return lambda r: replace(r, force=r.force + part * np.std(r.force) * _tone(r, hertz))


def step(part: float, since: float) -> Change:
    """The sensor's zero steps by that part of the rms of the response."""
    return lambda r: replace(r, response=r.response + part * np.std(r.response) * (_part(r) >= since))


def drift(part: float) -> Change:
    """The sensor's zero drifts by that part of the rms of the response from end to end."""
    return lambda r: replace(r, response=r.response + part * np.std(r.response) * _part(r))


def walk(part: float, seed: int = 0) -> Change:
    """The sensor's zero walks at random, as far as that part of the rms of the response."""

    def change(r: Recording) -> Recording:
        path = np.cumsum(np.random.default_rng(seed).standard_normal(r.n))
        return replace(r, response=r.response + part * np.std(r.response) * path / np.sqrt(r.n))

    return change


def clock(by: float) -> Change:
    """The recorder's clock is off by that part: its file states another rate than it has."""
    return lambda r: replace(r, fs=r.fs * (1.0 + by))


def wavering(by: float, times: float) -> Change:
    """The recorder's speed goes up and down by that part, so many times in the record."""

    def change(r: Recording) -> Recording:
        from scipy.interpolate import CubicSpline

        turn = 2 * np.pi * times / r.duration
        at = r.time + by / turn * (1.0 - np.cos(turn * (r.time - r.start)))
        at = np.clip(at, r.time[0], r.time[-1])
        force = None if r.force is None else CubicSpline(r.time, r.force)(at)
        return replace(r, response=CubicSpline(r.time, r.response)(at), force=force)

    return change


def clipped_peak() -> Change:
    """The tip of the largest swing is cut off, by a twentieth of its height."""

    def change(r: Recording) -> Recording:
        top = int(np.argmax(r.response))
        near = np.abs(np.arange(r.n) - top) < 0.01 * r.n
        return replace(r, response=np.where(near, np.minimum(r.response, 0.95 * r.response[top]), r.response))

    return change


def coarse_force(levels: int) -> Change:
    """The force comes in so many levels."""

    def change(r: Recording) -> Recording:
        size = np.ptp(r.force) / levels
        return replace(r, force=size * np.round(r.force / size))

    return change


def of_another_rig(stand: Stand, **times: float) -> Change:
    """A record of a rig of which some values are so many times those of this one."""

    def change(r: Recording) -> Recording:
        others = stand.clean(**{name: by * stand.values[name] for name, by in times.items()})
        return next(other for other in others if other.name == r.name)

    return change


def lies(stand: Stand) -> tuple[Lie, ...]:
    """What records of a stand are made to tell: times and frequencies are in those of its motion."""
    cycle = 2 * np.pi / stand.values["omega0"]
    line = 1.0 / cycle
    return (
        Lie("response x0.8", "gain", 2, response_gain(0.8, 0.55)),
        Lie("response x1.05", "gain", 2, response_gain(1.05, 0.4)),
        Lie("response x0.9, weak", "gain", 1, response_gain(0.9, 0.6)),
        Lie("force x0.8", "force gain", 2, force_gain(0.8, 0.45)),
        Lie("force x1.1, weak", "force gain", 1, force_gain(1.1, 0.5)),
        Lie("late by 0.06 cycles", "late", 2, late(0.06 * cycle)),
        Lie("late by 0.25 cycles", "late", 1, late(0.25 * cycle)),
        Lie("early by 0.1 cycles", "late", 2, late(-0.1 * cycle)),
        Lie("hum 4 times above, 2 %", "hum", 2, hum(3.95 * line, 0.02)),
        Lie("hum in the band, 3 %", "hum", 2, hum(1.17 * line, 0.03)),
        Lie("strong hum outside", "hum", 1, hum(5.3 * line, 0.5)),
        Lie("hum on the decay", "hum", 0, hum(4.1 * line, 0.05)),
        Lie("force hum in the band, 5 %", "force hum", 2, force_hum(1.13 * line, 0.05)),
        Lie("zero steps by 5 %", "step", 2, step(0.05, 0.5)),
        Lie("zero steps by 0.5 %", "step", 1, step(0.005, 0.3)),
        Lie("drift of 20 %", "drift", 2, drift(0.2)),
        Lie("walk of 5 %", "walk", 2, walk(0.05)),
        Lie("clock 2 % fast", "clock", 2, clock(0.02)),
        Lie("clock 0.3 % slow", "clock", 0, clock(-0.003)),
        Lie("clock wavers by 1 %", "wavering", 2, wavering(0.01, 3.0)),
        Lie("clock wavers fast", "wavering", 2, wavering(0.01, 20.0)),
        Lie("another rig, 10 %", "another rig", 0, of_another_rig(stand, omega0=1.1)),
        Lie("another rig, 40 %", "another rig", 1, of_another_rig(stand, omega0=1.4)),
        Lie("another rig's friction", "another rig", 1, of_another_rig(stand, viscous=1.3, dry=1.3)),
        Lie("a clipped peak", "clipped", 2, clipped_peak(), last=True),
        Lie("20 levels of force", "levels", 2, coarse_force(20), last=True),
    )


def _part(r: Recording) -> np.ndarray:
    """(n,) from 0 to 1 along the record."""
    return np.arange(r.n) / r.n


def _tone(r: Recording, hertz: float) -> np.ndarray:
    """(n,) a sine of rms 1."""
    return np.sqrt(2.0) * np.sin(2 * np.pi * hertz * r.time + 0.7)

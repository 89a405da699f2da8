"""Recordings that lie, as data: what a measuring chain does to records of a virtual rig, and what must be said of it.

A lie leaves numbers that look like a recording. Each is named by its kind, the words of which one must stand in the
sentence that a user gets, and by the record it was told in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..recording.recording import QUANTITIES, Recording
from .measuring_chain import (
    Change,
    clipped_at,
    clipped_peak,
    clock,
    coarse_force,
    coarse_response,
    drift,
    force_gain,
    force_hum,
    held,
    hum,
    late,
    lost,
    outlier,
    response_gain,
    step,
    twice,
    walk,
    wavering,
    zeroed,
)
from .odd_chains import (
    averaged_runs,
    backwards,
    bent,
    copied,
    dead_band,
    dropouts,
    echo,
    every_second,
    exchanged,
    gain_by_sign,
    gain_walks,
    gain_waves,
    high_pass,
    last_value,
    leaks,
    levelled,
    lost_of_one,
    low_pass,
    mean_about,
    mean_of,
    noisier,
    on_force,
    on_response,
    play,
    popcorn,
    pre_roll,
    quantised_time,
    rig_changes,
    saturates,
    spikes,
    stuck_bit,
    swapped_pairs,
    tilted,
    two_clocks,
    voltage_for_force,
    wraps,
)
from .truth import TRUTH
from .virtual_recording import recording_of

#: Of each kind words of which one must stand in the sentence; of one that a record shows where it is.
WORDS = {
    "gain": ("the response counts",),
    "force gain": ("the force counts",),
    "late": ("in step", "cycle late"),
    "sign": ("its sign", "jumps by"),
    "hum": ("lies on the response",),
    "force hum": ("lies on the force",),
    "step": ("zero steps", "jumps by"),
    "drift": ("drift",),
    "walk": ("walks",),
    "clock": ("clock",),
    "wavering": ("wavers",),
    "another rig": ("another rig",),
    "clipped": ("cut off", "clipped"),
    "levels": ("levels",),
    "lost": ("jumps by", "lost"),
    "twice": ("twice", "jumps by"),
    "held": ("jumps by", "stands still"),
    "zeros": ("jumps by", "stands still"),
    "outlier": ("jumps by", "is off by"),
    "force wraps": ("the force wraps",),
    "response wraps": ("the response wraps",),
    "back-EMF": ("back-EMF",),
    "copied": ("jumps by", "once more"),
    "backwards": ("takes work out",),
    "exchanged": ("takes work out",),
    "gain walk": ("a gain that walks",),
    "saturation": ("that saturates",),
    "force saturation": ("that saturates",),
    "force gain walk": ("a gain that walks",),
    "gain by sign": ("for each sign",),
    "bent": ("for each sign",),
}


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

    `kind` is what it is, and `also` are kinds that leave the same numbers; `record` the place of the recording that
    lies; `change` what happens to it, `last` with the noise already on it, `driven` to the other driven one as well.
    """

    name: str
    kind: str
    record: int
    change: Change
    last: bool = False
    also: tuple[str, ...] = ()
    driven: bool = False

    def is_named(self, sentence: str) -> bool:
        """Whether a sentence has the words of its kind."""
        return any(word in sentence for kind in (self.kind, *self.also) for word in WORDS.get(kind, ()))


def told(stand: Stand, lie: Lie | None, seed: int = 0) -> list[Recording]:
    """The recordings of a stand with that lie among them, or none."""
    clean = stand.clean()
    places = () if lie is None else (1, 2) if lie.driven else (lie.record,)
    lying = [lie.change(r) if lie is not None and i in places else r for i, r in enumerate(clean)]
    if lie is not None and lie.last:
        return [lie.change(r) if i == lie.record else r for i, r in enumerate(stand.noisy(clean, seed))]
    return stand.noisy(lying, seed)


def of_another_rig(stand: Stand, **times: float) -> Change:
    """A record of a rig of which some values are so many times those of this one."""

    def change(r: Recording) -> Recording:
        others = stand.clean(**{name: by * stand.values[name] for name, by in times.items()})
        return next(other for other in others if other.name == r.name)

    return change


def odd_lies(stand: Stand) -> tuple[Lie, ...]:
    """What else they are made to tell, by ``odd_chains``; of a kind without words it is enough that the record is."""
    cycle = 2 * np.pi / stand.values["omega0"]
    line, sample = 1.0 / cycle, 1.0 / stand.fs
    brake = 0.2 * stand.values["viscous"] * stand.values["mass"]
    another = of_another_rig(stand, omega0=0.97)
    return (
        Lie("gain walks by 3 %", "gain walk", 2, on_response(gain_walks(0.03))),
        Lie("gain walks by -3 %, weak", "gain walk", 1, on_response(gain_walks(-0.03))),
        Lie("force gain walks by 3 %", "force gain walk", 2, on_force(gain_walks(0.03))),
        Lie("gain waves by 2 %", "gain wave", 2, on_response(gain_waves(0.02, 2.0))),
        Lie("saturates by 3 %", "saturation", 2, on_response(saturates(0.03))),
        Lie("force saturates by 3 %", "force saturation", 2, on_force(saturates(0.03))),
        Lie("force wraps at 70 %", "force wraps", 2, on_force(wraps(0.7)), last=True),
        Lie("response wraps at 80 %", "response wraps", 2, on_response(wraps(0.8)), last=True),
        Lie("skew of 0.3 samples", "late", 2, late(0.3 * sample)),
        Lie("skew of -0.1 samples", "late", 1, late(-0.1 * sample)),
        Lie("mean of 4 samples", "mean of samples", 2, on_response(mean_of(4)), also=("late",)),
        Lie("mean of both channels", "mean of samples", 1, lambda r: on_force(mean_of(9))(on_response(mean_of(9))(r))),
        Lie("smoothed", "smoothed", 2, on_response(mean_about(7)), also=("gain",)),
        Lie("voltage for force", "back-EMF", 2, voltage_for_force(brake), driven=True),
        Lie("quantised time", "quantised time", 2, quantised_time(0.37 * sample)),
        Lie("copied block", "copied", 2, copied(3 * cycle, 5.2 * cycle, 0.45), last=True),
        Lie("copied block of a decay", "copied", 0, copied(3 * cycle, 4.0 * cycle, 0.3), last=True),
        Lie("pre-roll of 2 cycles", "late", 2, pre_roll(2.2 * cycle)),
        Lie("low-pass on response", "low-pass", 2, on_response(low_pass(20 * line)), also=("late",)),
        Lie("low-pass on force", "low-pass", 2, on_force(low_pass(20 * line)), also=("late",)),
        Lie("high-pass on response", "high-pass", 2, on_response(high_pass(0.05 * line)), also=("late",)),
        Lie("high-pass on force", "high-pass", 1, on_force(high_pass(0.05 * line)), also=("late",)),
        Lie("tilted", "tilt", 2, on_response(tilted(0.05, line))),
        Lie("echo of 3 %", "echo", 2, on_response(echo(0.03, 2.6 * cycle))),
        Lie("dead band of 2 %", "dead band", 2, on_response(dead_band(0.02))),
        Lie("play of 2 %", "play", 2, on_response(play(0.02))),
        Lie("stuck bit", "stuck bit", 2, on_response(stuck_bit(1 / 32)), last=True),
        Lie("automatic gain", "automatic gain", 2, on_response(levelled(0.2, 5 * cycle))),
        Lie("dropouts", "dropouts", 2, on_response(dropouts(97)), last=True),
        Lie("pairs swapped", "swapped", 2, on_response(swapped_pairs()), last=True),
        Lie("half rate, held", "half rate", 2, on_response(every_second(held=True)), last=True, also=("late",)),
        Lie("half rate, between", "half rate", 2, on_response(every_second(held=False)), last=True, also=("gain",)),
        Lie("spikes", "outlier", 2, on_response(spikes(0.5, 5)), last=True),
        Lie("noise for a while", "noise", 2, on_response(noisier(0.05, 0.4, 0.5))),
        Lie("popcorn noise", "step", 2, on_response(popcorn(0.02, 7))),
        Lie("last value", "held", 2, on_response(last_value(0.8)), last=True),
        Lie("bent sensor", "bent", 2, on_response(bent(0.03))),
        Lie("gain by sign", "gain by sign", 2, on_response(gain_by_sign(0.03))),
        Lie("force gain by sign", "gain by sign", 2, on_force(gain_by_sign(0.05))),
        Lie("two clocks", "two clocks", 2, two_clocks(2e-4), also=("late", "wavering")),
        Lie("force on response", "leak", 2, leaks(0.03), also=("late",)),
        Lie("response on force", "leak", 2, leaks(0.03, onto_force=True), also=("late",)),
        Lie("channels exchanged", "exchanged", 2, exchanged()),
        Lie("backwards", "backwards", 2, backwards()),
        Lie("mean of two runs", "mean of runs", 2, averaged_runs(0.1 * cycle), also=("late",)),
        Lie("lost in one channel", "lost", 2, lost_of_one(0.3 * cycle, 0.4), also=("late",)),
        Lie("rig changes midway", "rig changes", 2, rig_changes(another, 0.5)),
    )


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
        Lie("response x1.3", "gain", 2, response_gain(1.3, 0.7)),
        Lie("response x0.97, weak", "gain", 1, response_gain(0.97, 0.5)),
        Lie("response x1.15 throughout", "gain", 1, response_gain(1.15, 0.0), also=("force gain",)),
        Lie("response x0.85 on the decay", "gain", 0, response_gain(0.85, 0.15)),
        Lie("response turned over", "sign", 2, response_gain(-1.0, 0.5)),
        Lie("force x1.25 throughout", "force gain", 2, force_gain(1.25, 0.0), also=("gain", "another rig")),
        Lie("force x0.95, weak", "force gain", 1, force_gain(0.95, 0.6)),
        Lie("force x1.5", "force gain", 2, force_gain(1.5, 0.7)),
        Lie("force x0.9 early", "force gain", 2, force_gain(0.9, 0.25)),
        Lie("late by 0.02 cycles", "late", 1, late(0.02 * cycle)),
        Lie("late by 0.5 cycles", "late", 2, late(0.5 * cycle)),
        Lie("early by 0.03 cycles", "late", 1, late(-0.03 * cycle)),
        Lie("hum 2 times above, 1 %", "hum", 1, hum(2.1 * line, 0.01)),
        Lie("hum in the band, 10 %", "hum", 1, hum(0.87 * line, 0.1)),
        Lie("hum below, 5 %", "hum", 2, hum(0.3 * line, 0.05)),
        Lie("hum near the decay, 3 %", "hum", 0, hum(1.4 * line, 0.03)),
        Lie("force hum in the band, 15 %", "force hum", 1, force_hum(0.9 * line, 0.15)),
        Lie("force hum above, 20 %", "force hum", 2, force_hum(3.3 * line, 0.2)),
        Lie("zero steps by 20 %", "step", 2, step(0.2, 0.7)),
        Lie("zero steps back by 3 %", "step", 1, step(-0.03, 0.6)),
        Lie("zero steps on the decay", "step", 0, step(0.05, 0.1)),
        Lie("drift of 5 %", "drift", 1, drift(0.05)),
        Lie("drift of 100 %", "drift", 2, drift(1.0)),
        Lie("drift on the decay", "drift", 0, drift(0.2)),
        Lie("walk of 20 %", "walk", 1, walk(0.2, 1)),
        Lie("clock 5 % slow", "clock", 1, clock(-0.05), also=("another rig",)),
        Lie("clock 1 % fast", "clock", 1, clock(0.01), also=("another rig",)),
        Lie("clock 0.5 % fast", "clock", 2, clock(0.005), also=("another rig",)),
        Lie("clock wavers by 0.3 %", "wavering", 1, wavering(0.003, 8.0)),
        Lie("clock wavers by 2 %", "wavering", 2, wavering(0.02, 5.0)),
        Lie("another rig's mass", "another rig", 2, of_another_rig(stand, mass=1.2), also=("force gain", "gain")),
        Lie("another rig's spring", "another rig", 2, of_another_rig(stand, omega0=0.95), also=("clock",)),
        Lie("another rig's cubic", "another rig", 2, of_another_rig(stand, cubic=2.0)),
        Lie("a block lost", "lost", 2, lost(0.3 * cycle, 0.4)),
        Lie("a block twice", "twice", 2, twice(2.3 * cycle, 0.45), last=True),
        Lie("a block held", "held", 1, held(0.5 * cycle, 0.5), last=True),
        Lie("a block of zeros", "zeros", 2, zeroed(0.6 * cycle, 0.5), last=True),
        Lie("one sample off", "outlier", 1, outlier(1.0, 0.5)),
        Lie("clipped at 80 %", "clipped", 2, clipped_at(0.8), last=True),
        Lie("20 levels of response", "levels", 1, coarse_response(20), last=True),
    )

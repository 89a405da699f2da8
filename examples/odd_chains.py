"""What else happens to recordings between sensor and file, each as a function from what is to what is recorded.

As ``measuring_chain``, but of kinds for which most programs have no word: gains that walk, ranges that wrap, channels
that are filtered, mixed or exchanged, blocks and bits that are others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..recording.recording import Recording
from .measuring_chain import Change

Signal = Callable[[np.ndarray, Recording], np.ndarray]


def on_response(made: Signal) -> Change:
    """A change of the response alone."""
    return lambda r: replace(r, response=made(r.response, r))


def on_force(made: Signal) -> Change:
    """A change of the force's channel alone."""
    return lambda r: r if r.force is None else replace(r, force=made(r.force, r))


def gain_walks(by: float) -> Signal:
    """The gain goes from 1 to 1 + by along the record."""
    return lambda s, r: s * (1.0 + by * np.arange(s.size) / s.size)


def gain_waves(by: float, times: float) -> Signal:
    """The gain goes up and down by that part, so many times in the record: with the temperature of a room."""
    return lambda s, r: s * (1.0 + by * np.sin(2 * np.pi * times * np.arange(s.size) / s.size))


def gain_by_sign(by: float) -> Signal:
    """What is above zero counts 1 + by times."""
    return lambda s, r: np.where(s > 0, 1.0 + by, 1.0) * s


def saturates(by: float) -> Signal:
    """The largest value comes out smaller by that part, others by the cube of what they are of it."""
    return lambda s, r: s * (1.0 - by * (s / np.max(np.abs(s))) ** 2)


def wraps(part: float) -> Signal:
    """Beyond that part of the largest value it goes on at the other end, as a counter does."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        limit = part * np.max(np.abs(s))
        return (s + limit) % (2 * limit) - limit

    return made


def mean_of(samples: int) -> Signal:
    """Each sample is the mean of so many that ended with it: an integrating converter, late by half of them."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        return np.convolve(np.concatenate([np.full(samples - 1, s[0]), s]), np.full(samples, 1.0 / samples), "valid")

    return made


def mean_about(samples: int) -> Signal:
    """Each sample is the mean of so many (odd) about it: smoothed afterwards."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        return np.convolve(np.pad(s, samples // 2, "edge"), np.full(samples, 1.0 / samples), "valid")

    return made


def low_pass(hertz: float) -> Signal:
    """A first-order low-pass in the channel's amplifier."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        from scipy.signal import bilinear, lfilter, lfilter_zi

        b, a = bilinear([1.0], [1.0 / (2 * np.pi * hertz), 1.0], r.fs)
        return lfilter(b, a, s, zi=lfilter_zi(b, a) * s[0])[0]

    return made


def high_pass(hertz: float) -> Signal:
    """A first-order high-pass: a channel that was coupled for alternating voltage."""
    return lambda s, r: s - low_pass(hertz)(s, r)


def tilted(by: float, hertz: float) -> Signal:
    """What lies above that frequency counts 1 + by times: a cable or a charge amplifier."""
    return lambda s, r: s + by * high_pass(hertz)(s, r)


def echo(by: float, seconds: float) -> Signal:
    """That part of the signal comes once more, later."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        shift = round(seconds * r.fs)
        return s + by * np.concatenate([np.zeros(shift), s[: s.size - shift]])

    return made


def dead_band(part: float) -> Signal:
    """What is below that part of the largest value is shown as zero."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        limit = part * np.max(np.abs(s))
        return np.where(np.abs(s) < limit, 0.0, s)

    return made


def play(part: float) -> Signal:
    """The sensor's arm has a play of that part of the largest value."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        half, shown = 0.5 * part * np.max(np.abs(s)), np.empty_like(s)
        at = s[0]
        for i, value in enumerate(s):
            at = min(max(at, value - half), value + half)
            shown[i] = at
        return shown

    return made


def stuck_bit(part: float) -> Signal:
    """A bit of the converter, worth that part of the largest value, is always zero."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        worth = part * np.max(np.abs(s))
        return s - worth * (np.floor(s / worth) % 2)

    return made


def levelled(by: float, seconds: float) -> Signal:
    """An automatic gain takes so much of what the envelope is above its mean, with that time constant."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        level = np.sqrt(np.maximum(low_pass(1.0 / (2 * np.pi * seconds))(s**2, r), 1e-12 * np.mean(s**2)))
        return s * (level / np.mean(level)) ** -by

    return made


def dropouts(every: int) -> Signal:
    """One sample of so many is zero."""
    return lambda s, r: np.where(np.arange(s.size) % every == every - 1, 0.0, s)


def swapped_pairs() -> Signal:
    """Each pair of samples in the wrong order."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        places = np.arange(s.size)
        even = places[: s.size // 2 * 2].reshape(-1, 2)[:, ::-1].ravel()
        return s[np.concatenate([even, places[even.size :]])]

    return made


def every_second(held: bool) -> Signal:
    """Recorded at half the rate: each second sample is the one before it, or the mean of its neighbours."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        shown = s.copy()
        odd = shown[1:-1:2].size
        shown[1:-1:2] = shown[0:-2:2][:odd] if held else 0.5 * (shown[0:-2:2][:odd] + shown[2::2][:odd])
        return shown

    return made


def spikes(part: float, count: int, seed: int = 0) -> Signal:
    """So many samples anywhere are off by that part of the rms."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        random, shown = np.random.default_rng(seed), s.copy()
        places = random.choice(s.size, count, replace=False)
        shown[places] += part * np.std(s) * random.choice([-1.0, 1.0], count)
        return shown

    return made


def noisier(part: float, since: float, until: float, seed: int = 0) -> Signal:
    """Noise of that part of the rms in a stretch of the record: a motor nearby."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        at = np.arange(s.size) / s.size
        noise = np.random.default_rng(seed).standard_normal(s.size)
        return s + part * np.std(s) * noise * ((at >= since) & (at < until))

    return made


def popcorn(part: float, times: int, seed: int = 0) -> Signal:
    """The zero goes to and fro between two levels, at so many instants: popcorn noise of a semiconductor."""

    def made(s: np.ndarray, r: Recording) -> np.ndarray:
        edges = np.sort(np.random.default_rng(seed).choice(s.size, times, replace=False))
        return s + part * np.std(s) * (np.searchsorted(edges, np.arange(s.size)) % 2)

    return made


def last_value(since: float) -> Signal:
    """From some part of the record on the last value that came."""
    return lambda s, r: np.where(np.arange(s.size) < since * s.size, s, s[int(since * s.size) - 1])


def bent(by: float) -> Signal:
    """The characteristic is bent: the square of the signal lies on it, of that part at the largest value."""
    return lambda s, r: s + by * s**2 / np.max(np.abs(s))


def copied(seconds: float, back: float, since: float) -> Change:
    """A block of both channels is a copy of what stood some seconds before it, and what was there is lost."""

    def change(r: Recording) -> Recording:
        places = np.arange(r.n)
        first, length = int(since * r.n), round(seconds * r.fs)
        places[first : first + length] -= round(back * r.fs)
        return replace(r, response=r.response[places], force=None if r.force is None else r.force[places])

    return change


def pre_roll(seconds: float) -> Change:
    """The response begins with the end of the run before, and all of it comes as much later than the force."""

    def change(r: Recording) -> Recording:
        n = round(seconds * r.fs)
        return replace(r, response=np.concatenate([r.response[-n:], r.response[:-n]]))

    return change


def quantised_time(seconds: float) -> Change:
    """Samples are taken at the nearest ticks of a coarse timer, and the file says nothing of it."""

    def change(r: Recording) -> Recording:
        from scipy.interpolate import CubicSpline

        at = np.clip(np.round(r.time / seconds) * seconds, r.time[0], r.time[-1])
        force = None if r.force is None else CubicSpline(r.time, r.force)(at)
        return replace(r, response=CubicSpline(r.time, r.response)(at), force=force)

    return change


def two_clocks(by: float) -> Change:
    """The force's channel has a clock of its own, faster by that part."""

    def change(r: Recording) -> Recording:
        from scipy.interpolate import CubicSpline

        at = np.minimum(r.time * (1.0 + by), r.time[-1])
        return replace(r, force=CubicSpline(r.time, r.force)(at)).slice(0, int(r.n / (1.0 + abs(by))))

    return change


def voltage_for_force(damping: float) -> Change:
    """The voltage of a shaker is recorded in place of its force, scaled to it at standstill: back-EMF lies on it.

    ``damping``, N s/m, is what it adds to the damping of the driven rig: the coil's constant squared over its
    resistance.
    """

    def change(r: Recording) -> Recording:
        speed = r.response if r.quantity == "velocity" else np.gradient(r.response, 1.0 / r.fs)
        return r if r.force is None else replace(r, force=r.force + damping * speed)

    return change


def leaks(part: float, *, onto_force: bool = False) -> Change:
    """That part of one channel lies on the other, each of its own rms."""

    def change(r: Recording) -> Recording:
        ratio = np.std(r.response) / np.std(r.force)
        if onto_force:
            return replace(r, force=r.force + part / ratio * r.response)
        return replace(r, response=r.response + part * ratio * r.force)

    return change


def exchanged() -> Change:
    """The two channels' plugs were exchanged, each scaled to the other's rms."""

    def change(r: Recording) -> Recording:
        ratio = np.std(r.response) / np.std(r.force)
        return replace(r, force=r.response / ratio, response=r.force * ratio)

    return change


def backwards() -> Change:
    """The record runs backwards, as from a stack."""
    return lambda r: replace(r, response=r.response[::-1], force=None if r.force is None else r.force[::-1])


def averaged_runs(seconds: float) -> Change:
    """The mean of two runs that were triggered some time apart."""

    def change(r: Recording) -> Recording:
        n = round(seconds * r.fs)
        made = 0.5 * (r.response[n:] + r.response[:-n])
        return replace(r.slice(0, r.n - n), response=made)

    return change


def lost_of_one(seconds: float, since: float) -> Change:
    """A block of the response's samples is not there; the force's are, and both end together."""

    def change(r: Recording) -> Recording:
        first, length = int(since * r.n), round(seconds * r.fs)
        left = np.delete(r.response, slice(first, first + length))
        return replace(r, response=left, force=None if r.force is None else r.force[: left.size])

    return change


def rig_changes(of_another: Change, since: float) -> Change:
    """From some part of the record on it is the record of another rig."""

    def change(r: Recording) -> Recording:
        other = of_another(r)
        return replace(r, response=np.where(np.arange(r.n) < since * r.n, r.response, other.response[: r.n]))

    return change

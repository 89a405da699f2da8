"""What a measuring chain does to a recording, each as a function from what is to what is recorded.

Nothing here knows a rig, or how the faults are looked for: channels change their gain or zero, come late, carry hum,
run by an uneven clock, come to their limits, lose samples.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..recording.recording import Recording

Change = Callable[[Recording], Recording]


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


def clipped_at(part: float) -> Change:
    """The response goes no farther than that part of its largest swing."""

    def change(r: Recording) -> Recording:
        limit = part * np.max(np.abs(r.response))
        return replace(r, response=np.clip(r.response, -limit, limit))

    return change


def coarse_response(levels: int) -> Change:
    """The response comes in so many levels."""

    def change(r: Recording) -> Recording:
        size = np.ptp(r.response) / levels
        return replace(r, response=size * np.round(r.response / size))

    return change


def outlier(part: float, since: float) -> Change:
    """One sample of the response is off by that part of its rms."""

    def change(r: Recording) -> Recording:
        shown = r.response.copy()
        shown[int(since * r.n)] += part * np.std(shown)
        return replace(r, response=shown)

    return change


def lost(seconds: float, since: float) -> Change:
    """A block of samples is not there, and the file has no times that would tell."""

    def change(r: Recording) -> Recording:
        first = int(since * r.n)
        kept = np.delete(np.arange(r.n), slice(first, first + round(seconds * r.fs)))
        return replace(r, response=r.response[kept], force=None if r.force is None else r.force[kept])

    return change


def twice(seconds: float, since: float) -> Change:
    """A block of samples is there twice, one behind the other."""

    def change(r: Recording) -> Recording:
        first, length = int(since * r.n), round(seconds * r.fs)
        places = np.insert(np.arange(r.n), first + length, np.arange(first, first + length))
        return replace(r, response=r.response[places], force=None if r.force is None else r.force[places])

    return change


def held(seconds: float, since: float) -> Change:
    """The response stays at one value for so long: the recorder repeats the last that came."""

    def change(r: Recording) -> Recording:
        shown, first = r.response.copy(), int(since * r.n)
        shown[first : first + round(seconds * r.fs)] = shown[first]
        return replace(r, response=shown)

    return change


def zeroed(seconds: float, since: float) -> Change:
    """The response is zero for so long: a cable was loose."""

    def change(r: Recording) -> Recording:
        shown, first = r.response.copy(), int(since * r.n)
        shown[first : first + round(seconds * r.fs)] = 0.0
        return replace(r, response=shown)

    return change


def _part(r: Recording) -> np.ndarray:
    """(n,) from 0 to 1 along the record."""
    return np.arange(r.n) / r.n


def _tone(r: Recording, hertz: float) -> np.ndarray:
    """(n,) a sine of rms 1."""
    return np.sqrt(2.0) * np.sin(2 * np.pi * hertz * r.time + 0.7)

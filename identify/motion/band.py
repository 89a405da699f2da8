"""A zero-phase band on a recording: response and force alike, so that the equation stays true for what is linear.

What the band takes of the noise is put back, white and of the same level, drawn with a fixed seed: the fit weighs every
frequency by the noise there, and a hole in it would weigh more than the motion. Where the recording begins or ends in
motion, the band has nothing to lean on for as long as it reaches, and that much is cut off.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...model.oscillator import Band
from ...recording.recording import Recording
from ..signals.odds import SIGNIFICANT
from ..signals.registry import numerics
from ..signals.signals import drive_of, response_of
from .blows import blows_of, contact_force
from .envelope import envelope_of
from .force_off import force_is_silent

_REACH = numerics(2.0, "inverses of the taper's width", why="after which its kernel has fallen below a hundredth")
_OVER = numerics(1e-3, "of its largest", why="where a blow that went through the band has ended: 60 dB")


def in_band(recording: Recording, band: Band) -> Recording:
    """The recording as far as it lies in the band; ``struck`` holds a hammer's blows, now as long as it makes them.

    Args:
        recording: with or without force; its unit and name stay.
        band: with ``gain`` (1 where it passes).
    """
    x, fs = np.asarray(recording.response, float), recording.fs
    reach = round(_REACH / band.taper * fs)
    noise = response_of(recording).noise
    period = max(2, round(fs / band.mode))
    struck: tuple[tuple[int, int, bool], ...] = ()
    force = None if recording.force is None else np.asarray(recording.force, float)
    envelope = envelope_of(recording)
    blows = ()
    if force is not None and np.any(force) and not force_is_silent(recording) and envelope is not None:
        blows = blows_of(force, envelope.period)
    rest = float(np.median(x[-2 * period :]))
    begins = (bool(blows) and blows[0].start < period) or _rests(x[:period], noise)
    ends = _rests(x[-period:], noise)
    made = _through(x, band, fs, reach, begins, ends, rest) + _put_back(x.size, fs, band, noise, 0)
    if force is not None and blows:
        alone = contact_force(force, blows, period)
        force = _through(alone, band, fs, reach, True, True, 0.0)
        struck = _struck(alone, force, [(b.start, b.stop, b.clipped) for b in blows], reach)
    elif force is not None and np.any(force):
        drive = drive_of(recording)
        level = 0.0 if drive is None else drive.noise
        force = _through(force, band, fs, reach, begins, ends, float(np.median(force)))
        force = force + _put_back(x.size, fs, band, level, 1)
    isolated = replace(recording, response=made, force=force, struck=struck)
    first, last = 0 if begins else reach, x.size - (0 if ends else reach)
    return isolated if last - first < 2 * reach else isolated.slice(first, last)


def _rests(end: np.ndarray, noise: float) -> bool:
    return bool(np.ptp(end) < 2 * SIGNIFICANT * noise)


def _through(x: np.ndarray, band: Band, fs: float, reach: int, begins: bool, ends: bool, rest: float) -> np.ndarray:
    """(n,) signal through the band; it goes on at rest where it begins or ends so, else by point reflection."""
    reach = min(reach, x.size - 1)
    before = np.full(reach, rest) if begins else 2 * x[0] - x[reach:0:-1]
    after = np.full(reach, rest) if ends else 2 * x[-1] - x[-2 : -reach - 2 : -1]
    wide = np.concatenate([before, x, after])
    trend = np.linspace(wide[0], wide[-1], wide.size)
    size = wide.size + 2 * reach
    spectrum = np.fft.rfft(wide - trend, size)
    made = np.fft.irfft(spectrum * band.gain(np.fft.rfftfreq(size, 1 / fs)), size)[: wide.size]
    return (made + (trend if band.low == 0.0 else 0.0))[reach : reach + x.size]


def _put_back(n: int, fs: float, band: Band, level: float, seed: int) -> np.ndarray:
    """(n,) white noise of a standard deviation, as much of it as the band takes away."""
    drawn = np.fft.rfft(level * np.random.default_rng([seed, n]).standard_normal(n))
    taken = np.sqrt(1.0 - band.gain(np.fft.rfftfreq(n, 1 / fs)) ** 2)
    taken[0] = 0.0
    return np.asarray(np.fft.irfft(drawn * taken, n))


def _struck(
    alone: np.ndarray, force: np.ndarray, blows: list[tuple[int, int, bool]], reach: int
) -> tuple[tuple[int, int, bool], ...]:
    """Start, stop and whether clipped of blows after the band has drawn them out."""
    struck: list[tuple[int, int, bool]] = []
    for a, b, clipped in blows:
        low, high = max(0, a - reach), min(force.size, b + reach)
        loud = np.flatnonzero(np.abs(force[low:high]) > _OVER * np.max(np.abs(force[low:high])))
        start, stop = low + int(loud[0]), low + int(loud[-1]) + 1
        if struck and start < struck[-1][1]:
            start = struck[-1][1]
        if start < stop:
            struck.append((start, stop, clipped))
    return tuple(struck)

"""What a laboratory can play: sweeps, multisines, bursts of one frequency, and releases, at several levels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...identify.motion.excitation import band_of
from ...identify.problem.data import Data
from ...identify.signals.registry import numerics
from ..limits import BEYOND, CYCLES, DRIVE_LEVELS, RELEASE_LEVELS

_LINES = numerics(40, "lines of a multisine", why="enough to look like noise, few enough for each to stand above it")
_AROUND = numerics((0.7, 1.4), "times the natural frequency", why="a resonance lies half an octave around")
_WIDEST = numerics((0.3, 3.0), "times the natural frequency", why="harmonics of third order lie within")
_SEED = numerics(1, "of the phases", why="any seed gives a multisine of as low a crest")


@dataclass(frozen=True)
class Limits:
    """What may be asked of a rig: largest force (0: none can be applied), largest displacement, band in Hz."""

    force: float
    displacement: float
    band_hz: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Excitation:
    """One thing to play.

    Attributes:
        kind: sweep, multisine, sine or decay.
        level: largest force, or the displacement of the release.
        relative: level in units of the largest recorded.
        band_hz: from where to where, as played (a sweep downwards begins high).
        seconds: length.
    """

    kind: str
    level: float
    relative: float
    band_hz: tuple[float, float]
    seconds: float

    def signal(self, fs: float) -> np.ndarray:
        """(n,) force at ``fs`` Hz: zero in a decay; ramped up and down over a twentieth of its length."""
        n = max(round(self.seconds * fs), 2)
        t = np.arange(n) / fs
        low, high = self.band_hz
        if self.kind == "decay":
            return np.zeros(n)
        if self.kind == "sweep":
            phase = 2 * np.pi * (low * t + (high - low) * t**2 / (2 * self.seconds))
            wave = np.sin(phase)
        elif self.kind == "sine":  # on for the first half: the second shows how it dies away
            wave = np.where(t < self.seconds / 2, np.sin(2 * np.pi * low * t), 0.0)
        else:
            lines = np.unique(np.round(np.linspace(low, high, _LINES) * self.seconds)) / self.seconds
            phases = np.random.default_rng(_SEED).uniform(0.0, 2 * np.pi, lines.size)
            wave = np.cos(2 * np.pi * lines[:, None] * t + phases[:, None]).sum(axis=0)
            wave /= np.max(np.abs(wave))
        ramp = 0.05 * self.seconds
        gate = np.clip(np.minimum(t, self.seconds - t) / ramp, 0.0, 1.0)
        return self.level * wave * np.sin(0.5 * np.pi * gate) ** 2


def limits_of(data: Data) -> Limits:
    """The largest force, displacement and band that were recorded; the band spans the resonance at least."""
    natural = data.scales.omega / (2 * np.pi)
    bands = [band for recording in data.recordings if (band := band_of(recording)) is not None]
    low = min([_AROUND[0] * natural, *(band[0] for band in bands)])
    high = max([_AROUND[1] * natural, *(band[1] for band in bands)])
    driven = any(segment.force is not None for segment in data.segments)
    return Limits(data.scales.force if driven else 0.0, data.scales.length, (low, high))


def candidates(limits: Limits, natural: float) -> list[Excitation]:
    """What may be played within the limits and moderately beyond; ``natural`` in Hz."""
    excitations = []
    seconds = CYCLES / natural
    low, high = max(limits.band_hz[0], _WIDEST[0] * natural), min(limits.band_hz[1], _WIDEST[1] * natural)
    if limits.force > 0:
        for relative in DRIVE_LEVELS:
            level = relative * limits.force
            excitations.append(Excitation("sweep", level, relative, (low, high), seconds))
            excitations.append(Excitation("sweep", level, relative, (high, low), seconds))
            if relative > DRIVE_LEVELS[0]:
                excitations.append(Excitation("multisine", level, relative, (low, high), seconds))
                excitations.append(Excitation("sine", level, relative, (natural, natural), seconds))
        wide = low / BEYOND, high * BEYOND
        excitations.append(Excitation("sweep", limits.force, 1.0, wide, seconds))
        excitations.append(Excitation("sine", BEYOND * limits.force, BEYOND, (natural / 3, natural / 3), seconds))
    for relative in RELEASE_LEVELS:
        release = relative * limits.displacement
        excitations.append(Excitation("decay", release, relative, (natural, natural), seconds))
    return excitations

"""What an experiment may ask of a rig, and the excitations within that: sweeps, multisines, sines and releases."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...foresight.excitation import Excitation
from ...identify.motion.excitation import band_of
from ...identify.problem.data import Data
from ...identify.signals.registry import numerics
from ..limits import BEYOND, CYCLES, DRIVE_LEVELS, RELEASE_LEVELS

_AROUND = numerics((0.7, 1.4), "times the natural frequency", why="a resonance lies half an octave around")
_WIDEST = numerics((0.3, 3.0), "times the natural frequency", why="harmonics of third order lie within")


@dataclass(frozen=True)
class Limits:
    """What may be asked of a rig: largest force (0: none can be applied), largest displacement, band in Hz."""

    force: float
    displacement: float
    band_hz: tuple[float, float]


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

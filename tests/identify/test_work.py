"""How often identify simulates recordings of eleven kinds: counts, which no load of the machine changes.

The limits are a tenth above what was measured, so that nobody makes it worse unseen.
"""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.concealed.engine import Drive, simulate
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.recording import Recording

SWEEP = (1.0, 8.0, 18.0)


def sweep(quantity="displacement", seconds=8.0, **more):
    return recording_of(sweep=SWEEP, seconds=seconds, quantity=quantity, force_noise=1e-3, name="sweep", **more)


def decay(quantity="displacement", **more):
    return recording_of(begin=(9e-3, 0.0), seconds=4.0, quantity=quantity, noise=2e-6, name="decay", **more)


def driven(drive, begin=0.0, seed=0, fs=400.0, **parameters):
    """A recording of a rig of 8 Hz and 1 % damping, 0.5 kg, by the examples' own engine."""
    omega = 2 * np.pi * 8.0
    rig = {"omega": omega, "omega2": omega**2, "viscous": 0.02 * omega, "amplitude": 3e-3, "mass": 0.5}
    samples = round(drive.length * fs)
    response = simulate(rig | {"force": 2.0 * drive.peak} | parameters, drive, begin, fs, samples)
    x = response.x + 2e-6 * np.random.default_rng(seed).standard_normal(samples)
    return Recording(f"run {seed}", fs, x, None if drive.kind == "none" else response.force)


def releases(**parameters):
    return [driven(Drive("none", length=5.0), x, i, **parameters) for i, x in enumerate((3e-3, 2e-3, 1e-3))]


def sweeps():
    """Two through the resonance and a decay, with drag."""
    hard, soft = (Drive("linear", peak, 4.0, 14.0, 27.0) for peak in (1.0, 0.3))
    begun = ((hard, 0.0, 0), (soft, 0.0, 1), (Drive("none", length=10.0), 3e-3, 5))
    return [driven(drive, begin, seed, fs=1000.0, drag=20.0) for drive, begin, seed in begun]


KINDS = {
    "decay, displacement": (lambda: [decay()], 86),
    "decay, velocity": (lambda: [decay("velocity")], 96),
    "decay, acceleration": (lambda: [decay("acceleration")], 139),
    "sweep, displacement": (lambda: [sweep()], 50),
    "sweep, velocity": (lambda: [sweep("velocity")], 48),
    "sweep, acceleration": (lambda: [sweep("acceleration")], 121),
    "decay and sweep": (lambda: [decay(), sweep()], 45),
    "a sensor off zero": (lambda: [sweep(offset=3e-4)], 67),
    "three releases": (lambda: releases(dry=0.02), 26),
    "releases, drag concealed": (lambda: releases(drag=20.0), 245),
    "two sweeps and a decay, drag concealed": (sweeps, 335),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_recordings_are_simulated_no_more_often_than(kind):
    made, limit = KINDS[kind]
    recordings = made()
    found = identify(recordings)
    work = found.work
    assert work.recorded == sum(recording.n for recording in recordings)
    assert 0 < work.with_derivatives < work.simulated
    assert work.fits > 0
    assert work.times <= limit, work


def test_the_same_recordings_are_the_same_work():
    once, again = (identify([decay()]).work for _ in range(2))
    assert (once.simulated, once.with_derivatives, once.fits) == (again.simulated, again.with_derivatives, again.fits)

"""Velocity and acceleration serve as well as displacement, at any rate: Eq. 17 by the reference integrator."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify

NOISE = 2e-6


def rig(recorded, quantity, fs, values=TRUTH):
    more = {"quantity": quantity, "fs": fs, "noise": NOISE}
    decay = recorded(values, begin=(8e-3, 0.0), seconds=3.0, name="decay", **more)
    sweep = recorded(values, sweep=(1.0, 5.0, 20.0), seconds=10.0, name="sweep", seed=1, **more)
    return decay, replace(sweep, hold="smooth")


@pytest.fixture(scope="module")
def identified(recorded):
    """``identified("velocity", 500.0)``: recordings of that quantity and what was identified from them, made once."""

    @cache
    def make(quantity, fs):
        recordings = rig(recorded, quantity, fs)
        return recordings, identify(recordings)

    return make


def used(identification, index):
    return sum(s.segment.n for s in identification.fit.segments if s.segment.recording == index)


def scores(identification, values=TRUTH):
    return np.array([(p.value - values[name]) / p.std for name, p in identification.oscillator.parameters().items()])


def left_out(identification, name):
    """Seconds left out and of how many, as the note on a recording says."""
    for note in identification.notes:
        if note.startswith(f"{name}: ") and "hair decides" in note:
            out, of = note.removeprefix(f"{name}: ").split(" s were")[0].split(" of ")
            return float(out), float(of)
    return 0.0, 1.0


@pytest.mark.parametrize("fs", [500.0, pytest.param(5000.0, marks=pytest.mark.long)])
@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_a_decay_and_a_sweep(identified, quantity, fs):
    recordings, identification = identified(quantity, fs)
    assert np.all(np.abs(scores(identification)) < 4)
    assert used(identification, 1) >= 0.95 * recordings[1].n
    if quantity == "acceleration":
        out, of = left_out(identification, "decay")
        assert out <= 0.05 * of  # where friction brings it to rest
    assert left_out(identification, "sweep")[0] == 0.0
    assert all(s.over_noise < 1.1 for s in identification.fit.segments)


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_they_say_as_much_as_the_displacement(identified, quantity):
    """The same motion in white noise of the same size at resonance: errors alike, but for the weight of frequencies."""
    seen, plain = (identified(name, 500.0)[1].oscillator.parameters() for name in (quantity, "displacement"))
    for name in ("mass", "omega0", "viscous", "cubic"):
        assert 0.4 < seen[name].std / plain[name].std < 2.5, name


def test_an_accelerometer_without_friction_loses_nothing(recorded):
    values = TRUTH | {"dry": 0.0, "preload": 0.0}
    recordings = rig(recorded, "acceleration", 500.0, values)
    identification = identify(recordings)
    assert np.all(np.abs(scores(identification, values)) < 4)
    assert used(identification, 1) == recordings[1].n
    assert not any("hair decides" in note for note in identification.notes)


def test_an_accelerometer_over_a_rig_of_much_friction(recorded):
    """Its jumps are a twentieth of the motion's acceleration, ten times those of the reference rig."""
    values = TRUTH | {"dry": 0.3}
    recordings = rig(recorded, "acceleration", 500.0, values)
    identification = identify(recordings)
    assert np.all(np.abs(scores(identification, values)) < 4)
    assert used(identification, 1) >= 0.95 * recordings[1].n


def test_the_first_sample_of_a_decay_from_rest_is_no_rest(recorded):
    """x0 = -a / omega0²: a search that began at zero would find a mass that friction holds."""
    identification = identify(rig(recorded, "acceleration", 500.0)[:1])
    (fit,) = identification.fit.segments
    assert fit.initial[0] == pytest.approx(8e-3, rel=1e-3)
    assert fit.initial[1] == pytest.approx(0.0, abs=1e-3 * 8e-3 * TRUTH["omega0"])
    assert fit.nrmse < 0.01
    names = [name for name in identification.oscillator.parameters() if name != "mass"]
    assert len(names) == 5
    assert np.all(np.abs(scores(identification)) < 4)

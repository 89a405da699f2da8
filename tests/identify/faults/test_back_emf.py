"""A voltage in the force's place is named where free recordings say what the damping is without the shaker."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.lies import STANDS, Lie, of_another_rig, told
from dashpot.examples.measuring_chain import late, response_gain
from dashpot.examples.odd_chains import voltage_for_force
from dashpot.identify.faults.back_emf import back_emf
from dashpot.identify.faults.contradiction import contradiction
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.identification import identify
from dashpot.model import Oscillator
from dashpot.simulate.work import Meter

STAND = replace(STANDS["built-in"], cycles=60.0, fs=400.0)
#: Of the shaker, N s/m, and what it makes of the rig's viscous term.
BRAKE = 0.27
BRAKED = BRAKE / STAND.values["mass"]


def asked(recordings, stand=STAND):
    """What is said, and how often the recordings were simulated for it; None where nothing contradicts the rest."""
    fit = maximum_likelihood(Oscillator.from_values(stand.values), recordings, doubted=False, near=True)
    found, meter = contradiction(fit, recordings), Meter()
    said = None if found is None else back_emf(fit, recordings, found)
    return said, meter.read(sum(recording.n for recording in recordings)).times


def test_a_voltage_in_the_forces_place_is_named():
    said, _ = asked(told(STAND, Lie("", "", 2, voltage_for_force(BRAKE), driven=True)))
    assert set(said.words) == {1, 2}
    assert "back-EMF" in said.words[1]
    size = float(said.words[1].split("braked by ")[1].split()[0])
    assert size == pytest.approx(BRAKED, rel=0.02)
    np.testing.assert_allclose(said.shift(("mass", "viscous")), [0.0, BRAKED], rtol=0.02)


@pytest.mark.parametrize(
    ("change", "used"),
    [
        (lambda r: r, slice(None)),
        (voltage_for_force(-BRAKE), slice(None)),  # nothing drives by its damping
        (voltage_for_force(BRAKE), slice(1, None)),
        (of_another_rig(STAND, omega0=1.05), slice(None)),
        (of_another_rig(STAND, viscous=1.3, dry=1.5), slice(None)),
    ],
    ids=["honest", "pushed", "driven alone", "another spring", "another friction"],
)
def test_nothing_else_is(change, used):
    assert asked(told(STAND, Lie("", "", 2, change, driven=True))[used])[0] is None


@pytest.mark.parametrize("change", [response_gain(0.5, 0.8), late(0.06)], ids=["a gain", "a delay"])
def test_one_linearisation_says_that_it_is_something_else(change):
    said, times = asked(told(STAND, Lie("", "", 2, change)))
    assert said is None
    assert 0 < times < 4


@pytest.mark.long
def test_a_user_is_told():
    found = identify(told(STANDS["built-in"], Lie("", "", 2, voltage_for_force(BRAKE), driven=True)))
    assert [words.split(":")[0] for words in found.faults] == ["weak.csv", "strong.csv"]
    assert all("back-EMF" in words for words in found.faults)
    viscous = found.oscillator.viscous
    assert abs(viscous.value - STAND.values["viscous"]) < 2.0 * viscous.std


@pytest.mark.parametrize("seed", [2, 4])
def test_friction_that_stops_a_noisy_decay_hides_no_back_emf(seed):
    """The decay by itself ends in a minimum of one swing less, whose friction is nine errors off."""
    slow = replace(STANDS["slow"], noise=13 * STANDS["slow"].noise)
    brake = 0.2 * slow.values["viscous"] * slow.values["mass"]
    said, _ = asked(told(slow, Lie("", "", 2, voltage_for_force(brake), driven=True), seed), slow)
    assert said.size == pytest.approx(0.1, rel=0.03)

"""Recordings of displacement, velocity and acceleration fit one model together: Eq. 17 by the reference integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.problem.replay import replay
from dashpot.model.oscillator import Response

NOISE = 2e-6


def laser_sweep(recorded, quantity="displacement", name="laser"):
    return replace(
        recorded(sweep=(1.0, 5.0, 20.0), seconds=10.0, noise=NOISE, quantity=quantity, seed=1, name=name), hold="smooth"
    )


def accelerometer_decay(recorded):
    return recorded(begin=(8e-3, 0.0), seconds=3.0, noise=NOISE, quantity="acceleration", name="accelerometer")


def test_a_laser_sweep_and_an_accelerometer_decay(recorded):
    recordings = [laser_sweep(recorded), accelerometer_decay(recorded)]
    identification = identify(recordings)
    model = identification.oscillator
    assert model.response == Response("displacement", "m")  # of the recording that was named first
    assert {s.segment.quantity for s in identification.fit.segments} == {"displacement", "acceleration"}
    scores = [(p.value - TRUTH[name]) / p.std for name, p in model.parameters().items()]
    assert np.max(np.abs(scores)) < 4
    for recording in recordings:
        left = replay(model, recording) - recording.response
        size = NOISE * TRUTH["omega0"] ** (2 if recording.quantity == "acceleration" else 0)
        # towards the end of the decay small changes decide on which side of a jump an acceleration was taken
        across = np.abs(left) > 4 * size
        assert np.count_nonzero(across) <= (0.01 * left.size if recording.quantity == "acceleration" else 0)
        assert np.std(left[~across]) < 1.2 * size


def test_two_sensors_at_once_tell_more_than_one(recorded):
    laser = laser_sweep(recorded)
    second = replace(laser_sweep(recorded, "velocity", "vibrometer"), force=laser.force)
    one, both = identify([laser]).oscillator, identify([laser, second]).oscillator
    scores = [(p.value - TRUTH[name]) / p.std for name, p in both.parameters().items()]
    assert np.max(np.abs(scores)) < 4
    assert both.parameters()["viscous"].std < one.parameters()["viscous"].std


@pytest.mark.parametrize("order", [1, -1])
def test_the_model_is_of_the_quantity_named_first(recorded, order):
    recordings = [laser_sweep(recorded), accelerometer_decay(recorded)][::order]
    model = identify(recordings).oscillator
    assert (model.response.quantity, model.response.unit) == (recordings[0].quantity, recordings[0].unit)
    assert model.omega0.value == pytest.approx(TRUTH["omega0"], rel=1e-3)

"""Whether a response goes where its blows push: closed forms of a linear rig, whatever sensor shows it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.blows import answers_against
from dashpot.identify.motion.decay import Blow

PERIOD, N, LENGTH = 200, 4000, 12
OMEGA = 2 * np.pi / PERIOD
T = np.arange(N)


def force_at(*starts):
    force = np.zeros(N)
    for at in starts:
        force[at : at + LENGTH] = np.sin(np.pi * (np.arange(LENGTH) + 0.5) / LENGTH)
    return force


def response_to(force, quantity, omega=OMEGA, damping=0.02):
    """Half-way through each sample the momentum of one: the sum of the ringings that they set going."""
    fall, turned = np.exp(-damping * omega * T), omega * T
    ringing = {
        "displacement": fall * np.sin(turned) / omega,
        "velocity": fall * np.cos(turned),
        "acceleration": -fall * omega * np.sin(turned),
    }[quantity]
    x = np.convolve(force, ringing)[:N]
    return x + force if quantity == "acceleration" else x


def blows(*starts):
    return [Blow(at, at + LENGTH) for at in starts]


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
@pytest.mark.parametrize("offset", [0.0, 3.0])
@pytest.mark.parametrize("pace", [0.8, 1.25])
def test_a_turned_sensor(quantity, offset, pace):
    """A spring that is softer or stiffer at the amplitude of the blow changes the pace, and nothing of the sign."""
    force = force_at(500, 2200)
    x = response_to(force, quantity, pace * OMEGA)
    for sign, against in ((1.0, False), (-1.0, True)):
        shown = sign * x + offset
        assert answers_against(blows(500, 2200), force, shown, PERIOD, quantity) is against
        assert answers_against(blows(500, 2200), -force, shown, PERIOD, quantity) is not against


def test_the_first_of_a_recording_may_begin_it():
    force = force_at(0)
    x = response_to(force, "velocity")
    assert not answers_against(blows(0), force, x, PERIOD, "velocity")
    assert answers_against(blows(0), force, -x, PERIOD, "velocity")


@pytest.mark.parametrize(("correlation", "against"), [(-0.45, False), (-0.55, True), (0.0, False)])
def test_what_is_nearly_a_right_angle_away_decides_nothing(correlation, against):
    force = force_at(500)
    x = response_to(force, "displacement", damping=0.0)
    first = slice(500, 500 + (LENGTH - 1) // 2 + PERIOD)
    other = np.where((T >= 500) & (first.stop > T), np.cos(7 * OMEGA * T), 0.0)
    other -= x * (other[first] @ x[first]) / (x[first] @ x[first])
    other[:500] = 0.0
    other *= np.linalg.norm(x[first]) / np.linalg.norm(other[first])
    mixed = correlation * x + np.sqrt(1 - correlation**2) * other
    assert answers_against(blows(500), force, mixed, PERIOD, "displacement") is against


def test_a_contact_that_a_band_has_drawn_out():
    """Of a hardening spring the phase is half a turn off before the drawn out contact is over."""
    force = np.exp(-(((T - 800) / 40.0) ** 2)) * np.cos(OMEGA * (T - 800))
    x = response_to(force, "velocity", 1.06 * OMEGA)
    drawn = [Blow(200, 200 + 8 * PERIOD)]
    assert not answers_against(drawn, force, x, PERIOD, "velocity")
    assert answers_against(drawn, force, -x, PERIOD, "velocity")


def test_a_weak_blow_upon_what_still_rings_does_not_decide():
    """It moves the mass by a tenth of what it moves already: the other one tells."""
    force = force_at(500)
    force += 0.1 * force_at(900)
    x = response_to(force, "displacement", damping=1e-3)
    assert not answers_against(blows(500, 900), force, x, PERIOD, "displacement")
    assert answers_against(blows(500, 900), force, -x, PERIOD, "displacement")


def test_chance_is_no_sign():
    """Noise of a colour, no ringing at all: of two hundred records none is said to be turned."""
    random, force = np.random.default_rng(4), force_at(500, 2200)
    for _ in range(200):
        noise = np.convolve(random.standard_normal(N), np.ones(9))[:N]
        assert not answers_against(blows(500, 2200), force, noise, PERIOD, "acceleration")

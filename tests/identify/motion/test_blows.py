"""Blows of a hammer in a recorded force, and what they set going."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.blows import ContactForce, blows_of, contact_force, ringing, through
from dashpot.identify.motion.decay import Blow, Decay
from dashpot.identify.motion.envelope import Envelope
from dashpot.simulate.force import straight_lines

PERIOD, NOISE = 100, 0.01


def pulses(*hits, n=4000, offset=0.3):
    """Half sines upon white noise; each hit: where it begins, how long, how high."""
    force = NOISE * np.random.default_rng(0).standard_normal(n)
    for at, length, height in hits:
        force[at : at + length] += height * np.sin(np.pi * (np.arange(length) + 0.5) / length)
    return force + offset


def found(*hits, period=PERIOD, **more):
    return blows_of(pulses(*hits, **more), period)


# Which they are ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("offset", [0.0, 0.3, -5.0])
def test_a_blow_with_its_flanks(sign, offset):
    """Two hundredths of its peak are reached after 0.6 % of a half sine; an eighth of its length on either side."""
    (blow,) = found((1000, 40, sign * 50.0), offset=offset)
    assert (blow.start, blow.stop) == (995, 1045)
    assert (blow.clipped, blow.contacts) == (False, 1)


@pytest.mark.parametrize(("height", "count"), [(8.5, 0), (13.0, 1)])
def test_a_hammer_stands_out_of_its_noise(height, count):
    assert len(found((1000, 31, height * NOISE))) == count
    assert found() == ()


def test_a_contact_ends_at_the_noise():
    """Five deviations of it; where the blow is larger, a fiftieth of the peak."""
    low = found((1000, 41, 38 * NOISE))[0]  # sin = 5/38 in the second sample
    assert (low.start, low.stop) == (1002 - 4, 1040 + 4)
    triangle = np.interp(np.arange(4000), [1000, 1100, 1200], [0.0, 1000 * NOISE, 0.0])
    (high,) = blows_of(triangle + pulses(), 1000)
    core = 0.98 * 200
    assert high.stop - high.start == pytest.approx(core * 1.25, abs=4)


@pytest.mark.parametrize(("length", "count"), [(36, 1), (44, 0)])
def test_a_contact_is_over_within_half_a_cycle(length, count):
    """Its flanks counted with it."""
    assert len(found((1000, length, 50.0))) == count


def test_what_pushes_all_the_time_is_no_hammer():
    t = np.arange(4000)
    assert blows_of(np.sin(2 * np.pi * t / PERIOD), PERIOD) == ()


@pytest.mark.parametrize(("height", "count"), [(1.8, 1), (2.2, 2)])
def test_a_weak_blow_says_nothing_beside_the_strongest(height, count):
    assert len(found((500, 20, 50.0), (2500, 20, height))) == count


@pytest.mark.parametrize(("gap", "contacts"), [(2, 1), (12, 2)])
def test_a_contact_may_tremble(gap, contacts):
    """A twentieth of a cycle apart is one contact."""
    (blow,) = found((1000, 10, 50.0), (1010 + gap, 10, 50.0))
    assert blow.contacts == contacts
    assert (blow.start, blow.stop) == pytest.approx((999, 1021 + gap), abs=2)
    assert found((1000, 6, 50.0), (1008, 6, 50.0), period=45)[0].contacts == 1  # two samples at least
    assert found((1000, 6, 50.0), (1009, 6, 50.0), period=45)[0].contacts == 2


@pytest.mark.parametrize(("cycles", "count"), [(2.3, 1), (2.8, 2)])
def test_what_follows_before_a_few_cycles_is_one_blow(cycles, count):
    second = 1022 + round(cycles * PERIOD)
    blows = found((1000, 20, 50.0), (second, 20, 50.0))
    assert len(blows) == count
    assert [b.contacts for b in blows] == ([2] if count == 1 else [1, 1])
    assert blows[0].start == pytest.approx(998, abs=1)
    assert blows[-1].stop == pytest.approx(second + 22, abs=1)


def test_three_contacts_are_counted():
    (blow,) = found((1000, 20, 50.0), (1200, 20, 50.0), (1400, 20, 50.0))
    assert (blow.contacts, blow.clipped) == (3, False)
    assert (blow.start, blow.stop) == pytest.approx((998, 1422), abs=1)


@pytest.mark.parametrize(("cycles", "count"), [(2.4, 0), (2.8, 4)])
def test_a_train_of_pulses_is_a_drive(cycles, count):
    hits = [(500 + round(k * cycles * PERIOD), 20, 50.0) for k in range(4)]
    assert len(found(*hits)) == count


@pytest.mark.parametrize(("equal", "clipped"), [(2, False), (3, True)])
@pytest.mark.parametrize("sign", [1, -1])
def test_three_equal_samples_at_the_ends_of_the_range_are_clipped(equal, clipped, sign):
    force = pulses((1000, 20, 50.0), (2500, 20, 30.0), offset=0.0)
    force[1009 : 1009 + equal] = 60.0
    force[2509 : 2509 + equal] = 40.0  # a flat top below the range is none
    blows = blows_of(sign * force, PERIOD)
    assert [b.clipped for b in blows] == [clipped, False]


def test_one_clipped_contact_makes_a_clipped_blow():
    for first in (1009, 1209):
        force = pulses((1000, 20, 50.0), (1200, 20, 50.0))
        force[first : first + 4] = 70.0
        (blow,) = blows_of(force, PERIOD)
        assert blow.clipped


# What rings after them -----------------------------------------------------------------------------------------------


def envelope(size, floor=0.1):
    return Envelope(np.asarray(size, float), PERIOD, floor, 0.01)


def test_each_blow_rings_to_the_noise_or_the_next():
    size = np.full(4000, 0.05)
    size[1000:1800] = 1.0
    size[2000:] = 1.0
    blows = (Blow(1000, 1020), Blow(2000, 2020), Blow(3000, 3020))
    assert ringing(blows, envelope(size)) == [Decay(1020, 1800), Decay(2020, 3000), Decay(3020, 4000)]


def test_the_envelope_needs_a_cycle_to_rise():
    size = np.ones(4000)
    size[1020:1120] = 0.05
    assert ringing((Blow(1000, 1020),), envelope(size))[-1] == Decay(1020, 4000)
    size[1120] = 0.05
    assert ringing((Blow(1000, 1020),), envelope(size)) == [Decay(0, 1000)]
    assert ringing((Blow(100, 3950),), envelope(np.ones(4000))) == []


@pytest.mark.parametrize(("level", "count"), [(0.19, 0), (0.21, 1)])
def test_ringing_is_twice_above_its_end(level, count):
    size = np.full(4000, level)
    assert len(ringing((Blow(200, 220),), envelope(size))) == count


@pytest.mark.parametrize(("first", "count"), [(249, 0), (250, 1)])
def test_what_rang_before_the_first_blow(first, count):
    """Two and a half cycles of it, twice above its end."""
    blows = (Blow(first, first + 20),)
    size = np.ones(4000)
    assert ringing(blows, envelope(size))[:-1] == [Decay(0, first)] * count
    size[200:first] = 0.05
    assert ringing(blows, envelope(size))[:-1] == [Decay(0, 200)] * count
    size[0] = 0.19
    assert len(ringing(blows, envelope(size))) == 1


# The force of the contacts -------------------------------------------------------------------------------------------


def test_between_contacts_the_force_is_nothing():
    """About the median of a cycle before; after it where the record has less than five samples before."""
    n = 1000
    force = np.full(n, 7.0)
    force[200:300] = 2.0
    force[300:310] = 50.0
    force[310:] = 3.0
    alone = contact_force(force, (Blow(300, 310),), PERIOD)
    assert np.array_equal(alone, np.where((np.arange(n) >= 300) & (np.arange(n) < 310), 48.0, 0.0))
    assert contact_force(force, (Blow(300, 310),), 300)[305] == 43.0  # of which cycle, the period says
    late = force[292:]
    assert contact_force(late, (Blow(8, 18),), PERIOD)[10] == 48.0
    late = force[296:].copy()
    late[114:] = 9.0
    assert contact_force(late, (Blow(4, 14),), PERIOD)[10] == 47.0
    assert contact_force(np.full(10, 5.0), (Blow(0, 10),), PERIOD)[3] == 5.0


def test_noise_counts_during_contacts_alone():
    samples = np.zeros(400)
    samples[100:104] = [0.02, 1.0, 0.5, 0.021]
    made = straight_lines(samples, 1e-3)
    force = ContactForce(made.pieces, made.fine, made.hold)
    noisy = force.disturbed(0.1, np.random.default_rng(0), 1e-3)
    moved = np.flatnonzero(np.any(noisy.pieces != force.pieces, axis=1))
    assert moved.tolist() == [101, 102, 103]
    assert isinstance(noisy, ContactForce)
    drawn = [
        force.disturbed(0.1, np.random.default_rng(seed), 1e-3).pieces[101, 0] - force.pieces[101, 0]
        for seed in range(400)
    ]
    assert np.std(drawn) == pytest.approx(0.1, rel=0.15)
    assert force.coarser(3, 1e-3) is force


# What is simulated ---------------------------------------------------------------------------------------------------


def test_a_blow_goes_with_all_of_the_ringing():
    blow = Blow(1000, 1020)
    assert through((blow,), (Decay(1020, 3000),), PERIOD) == [(975, 3000, True)]
    assert through((Blow(10, 20),), (Decay(20, 3000),), PERIOD) == [(0, 3000, True)]


def test_a_clipped_blow_is_not_simulated():
    assert through((Blow(1000, 1020, clipped=True),), (Decay(1020, 3000),), PERIOD) == [(1020, 3000, False)]
    assert through((Blow(1000, 1020),), (Decay(0, 990), Decay(1030, 3000)), PERIOD) == [
        (0, 990, False),
        (1030, 3000, False),
    ]


def test_a_blow_goes_on_with_what_rang_before():
    blows = (Blow(1000, 1020), Blow(3000, 3020))
    whole = (Decay(0, 1000), Decay(1020, 3000), Decay(3020, 5000))
    assert through(blows, whole, PERIOD) == [(0, 5000, True)]
    rested = (Decay(0, 900), Decay(1020, 2000), Decay(3020, 5000))
    assert through(blows, rested, PERIOD) == [(0, 900, False), (975, 2000, True), (2975, 5000, True)]


# What is in them -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_the_momentum_below_a_level_is_in_the_contact(noise):
    """A soft tip lets go slowly: what lies below a fiftieth of the peak is a thousandth of the momentum."""
    t = np.arange(4000) - 1000.0
    force = np.exp(-0.5 * (t / 6.0) ** 2) + noise * np.random.default_rng(0).standard_normal(t.size)
    blows = blows_of(force, PERIOD)
    assert len(blows) == 1
    kept = np.sum(contact_force(force, blows, PERIOD)) / (6.0 * np.sqrt(2 * np.pi))
    assert kept == pytest.approx(1.0, abs=1e-5 + noise * 5 * np.sqrt(60) / 15)

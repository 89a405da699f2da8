"""Free decays by their fall alone. Where no turning points are given, the envelope alone decides."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decay import Decay
from dashpot.identify.motion.envelope import Envelope, envelope_of
from dashpot.identify.motion.falling import falling
from dashpot.identify.motion.swings import Swings, swings_of
from dashpot.recording import Recording

PERIOD, FLOOR, NOISE = 100, 0.02, 1e-3


def none(n):
    return Swings(np.zeros(0, int), np.zeros(0), NOISE, n)


def found(size, x=None, swings=None, **more):
    size = np.asarray(size, float)
    swings = swings or none(size.size)
    if x is None:
        x = np.interp(np.arange(size.size), swings.at, swings.value) if swings.at.size else np.zeros(size.size)
    return falling(x, Envelope(size, PERIOD, FLOOR, NOISE), swings, **more)


def fall(n, time, height=1.0):
    """(n,) exponential of a time constant in samples."""
    return height * np.exp(-np.arange(n) / time)


def held(before, n, time):
    """(before + n,) a steady amplitude of one, then an exponential."""
    return np.concatenate([np.ones(before), fall(n, time)])


def turns(size, every=50, n=None):
    """Turning points every so many samples, the swings between them of given sizes."""
    value = np.concatenate([[0.0], np.cumsum(np.asarray(size) * (-1.0) ** np.arange(len(size)))])
    at = every * np.arange(value.size)
    return Swings(at, value, 1e-6, int(at[-1]) + every if n is None else n)


# Its end -------------------------------------------------------------------------------------------------------------


def test_a_decay_ends_at_the_noise():
    size = fall(4000, 500.0)
    (decay,) = found(size)
    assert decay == Decay(0, int(np.ceil(500.0 * np.log(1 / FLOOR))))
    assert found(fall(1500, 500.0)) == [Decay(0, 1500)]


@pytest.mark.parametrize(("height", "count"), [(1.9, 0), (2.1, 1)])
def test_what_never_stands_out_of_the_noise_is_none(height, count):
    assert len(found(fall(4000, 800.0, height * FLOOR))) == count


@pytest.mark.parametrize(("cycles", "count"), [(4.9, 0), (5.1, 1)])
def test_five_cycles_at_least(cycles, count):
    time = cycles * PERIOD / np.log(1 / FLOOR)
    assert len(found(fall(2000, time))) == count
    assert len(found(fall(2000, time), shortest=3.0)) == 1
    assert len(found(fall(round(cycles * PERIOD), 300.0))) == count


@pytest.mark.parametrize(("level", "count"), [(0.52, 0), (0.48, 1)])
def test_what_falls_little_must_fall_swing_by_swing(level, count):
    n = 1000
    assert len(found(level ** (np.arange(n) / (n - 1)))) == count


def test_a_slow_fall_is_told_by_its_swings():
    """To 0.62 of itself, and to 0.85, at which no corner of the envelope shows."""
    for level in (0.62, 0.85):
        size = level ** (np.arange(2000) / 1999)
        assert found(size, swings=turns(2 * size[::50])) == [Decay(0, 2000)]
        assert found(size, swings=turns(2 * np.ones(40))) == []


@pytest.mark.parametrize(("rise", "parts"), [(1.2, 1), (1.3, 2)])
def test_a_rise_by_a_quarter_is_another_motion(rise, parts):
    down = fall(600, 600.0)
    size = np.concatenate([down, fall(2600, 600.0, rise * down[-1])])
    decays = sorted(found(size), key=lambda d: d.start)
    assert len(decays) == parts
    assert decays[0].start == 0
    assert decays[-1].stop == pytest.approx(600 + 600 * np.log(rise * down[-1] / FLOOR), abs=1)
    if parts == 2:
        assert decays[0].stop == 599
        assert decays[1].start == 700  # a cycle after its corner


def test_several_decays_left_and_right_of_the_highest():
    size = np.concatenate([fall(1500, 300.0, h) for h in (0.5, 1.0, 0.7)])
    decays = sorted(found(size), key=lambda d: d.start)
    ends = [k * 1500 + int(np.ceil(300.0 * np.log(h / FLOOR))) for k, h in enumerate((0.5, 1.0, 0.7))]
    assert [d.stop for d in decays] == ends
    assert [d.start for d in decays] == [0, 1600, 3100]


# Its beginning -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("before", [1000, 260])
def test_it_begins_a_cycle_after_its_corner(before):
    """The corner is where a cycle ahead holds half of the later fall: half a cycle before the fall begins."""
    (decay,) = found(held(before, 4000, 400.0))
    assert decay.start == pytest.approx(before - PERIOD / 2 + PERIOD, abs=2)


def test_the_corner_to_the_sample():
    """A fall by k / 400 + 1e-7 k²: its rate between four fifths and 1/e, half of which a cycle must fall."""
    k = np.arange(2500)
    loss = k / 400 + 1e-7 * k**2
    first, last = (int(np.flatnonzero(loss > np.log(1 / part))[0]) for part in (0.8, np.exp(-1.0)))
    rate = (loss[last] - loss[first]) / (last - first)
    ahead = int(np.flatnonzero(loss >= 0.5 * rate * PERIOD)[0])
    (decay,) = found(np.exp(-np.append(np.zeros(1000), loss)))
    assert decay.start == 1000 - (PERIOD - ahead) + PERIOD


@pytest.mark.parametrize("before", [100, 190])
def test_a_record_that_begins_with_its_decay(before):
    (decay,) = found(held(before, 4000, 400.0))
    assert decay.start == 0


def test_the_later_rate_is_that_from_four_fifths_to_a_time_constant():
    """A slow fall before a fast one is a part of the decay where it is at half its rate."""
    k = int(np.log(1 / 0.7) / 1e-3)
    for first, starts_late in ((1e-3, True), (2.3e-3, False)):
        level = np.concatenate([np.full(300, 0.0), -first * np.arange(k), -first * k - 4e-3 * np.arange(2000)])
        (decay,) = found(np.exp(level))
        assert (decay.start > 300 + PERIOD) is starts_late


def test_no_corner_within_a_fall_that_ends_at_once():
    size = np.concatenate([np.ones(800), np.full(800, 0.25)])
    assert all(d.stop - d.start >= 5 * PERIOD for d in found(size))
    assert found(np.concatenate([np.linspace(0.5, 1.0, 800), np.full(1, 0.7)])) == []


# A blow at its beginning ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("moves", "start"), [(0, 0), (24, 0), (26, 76), (150, 200), (299, 349), (301, 0)])
def test_a_blow_in_the_first_cycles_is_left_out(moves, start):
    """A turning point dwells for a quarter of a cycle; a contact lasts half of one."""
    x = np.full(4000, 0.3)
    x[moves:] += 7 * NOISE
    x[:1] = 0.3
    (decay,) = found(fall(4000, 500.0), x)
    assert decay.start == (start if moves else 0)


@pytest.mark.parametrize(("noises", "start"), [(4.9, 0), (5.1, 150)])
def test_noise_is_no_blow(noises, start):
    x = np.where(np.arange(4000) < 100, 0.0, -noises * NOISE)
    assert found(fall(4000, 500.0), x)[0].start == start


# With the turning points of a motion ---------------------------------------------------------------------------------


def measured(x):
    recording = Recording("run", 100.0, x + 1e-4 * np.random.default_rng(0).standard_normal(x.size))
    envelope = envelope_of(recording)
    assert envelope is not None
    x = np.asarray(recording.response)
    return falling(x, envelope, swings_of(x, envelope)), envelope.period


def swinging(n, time, period=40):
    t = np.arange(n)
    return np.exp(-t / time) * np.cos(2 * np.pi * t / period)


def test_what_is_let_go_is_free_from_its_first_turn_back():
    x = np.concatenate([np.full(800, 1.0), swinging(3000, 300.0)])
    (decay,), period = measured(x)
    assert period == 40
    assert decay.start == pytest.approx(800 + period / 2, abs=3)
    assert decay.stop == pytest.approx(800 + 300 * np.log(1 / (2 * np.sqrt(2) * 1e-4)), rel=0.05)


def test_a_hand_that_stops_it_ends_it():
    """Let go, and stopped after thirty cycles with two thirds of the amplitude left."""
    x = np.concatenate([np.full(800, 1.0), swinging(1200, 3000.0), np.zeros(800)])
    (decay,), period = measured(x)
    assert decay.start == pytest.approx(800 + period / 2, abs=3)
    assert 2000 - 2 * period < decay.stop <= 2000


def test_what_a_drive_lets_sink_is_none():
    """It falls by a fifth and grows again at once."""
    t = np.arange(3000)
    x = (1.0 - 0.1 * np.cos(2 * np.pi * t / 1500) + 0.1) * np.cos(2 * np.pi * t / 40)
    assert measured(x)[0] == []


@pytest.mark.parametrize(("cycles", "grown", "count"), [(2.5, 1.3, 0), (2.5, 1.2, 1), (3.5, 1.3, 1)])
def test_what_has_died_away_does_not_grow_again(cycles, grown, count):
    """A slow fall, told by its swings: where it grows by a quarter within three cycles, a drive comes and goes."""
    n = 1500
    size = np.concatenate([0.65 ** (np.arange(n) / (n - 1)), np.full(1000, 0.65)])
    size[n + round(cycles * PERIOD) :] *= grown
    size[n + 500 :] = 0.65 * 1.3
    swings = turns(np.concatenate([2 * size[:n:50], np.full(19, 4.0)]), n=size.size)
    assert found(size, swings=swings) == [Decay(0, n - 1)] * count

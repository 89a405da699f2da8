"""The equation of motion along a recording: what is missing in it, and the motion that it is missing along."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.limits import LEAST_EVIDENCE
from dashpot.diagnose.place.equation_error import BLOCK_CYCLES, _stretch, equation_error
from dashpot.diagnose.place.smoother import _NONE, Smoother
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator

LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
PERIOD = 2 * np.pi / LINEAR["omega0"]
SWEEP = (0.5, 9.0, 16.0)


@pytest.fixture(scope="module")
def sweep(recorded):
    return recorded(LINEAR, sweep=SWEEP, name="sweep", seconds=5.0, noise=2e-6)


def errors(model, *recordings):
    return equation_error(model, data_of(recordings, model))


def test_nothing_is_missing_in_the_right_model(sweep):
    (stretch,), evidence = errors(Oscillator.from_values(LINEAR), sweep)
    assert evidence < LEAST_EVIDENCE
    assert np.std(stretch.missing) < 3e-3 * LINEAR["omega0"] ** 2 * np.std(stretch.x)


def test_a_spring_that_is_too_soft_is_missing_along_the_displacement(sweep):
    """The missing force is the spring's difference times x, and it is told in evidence."""
    soft = Oscillator.from_values(LINEAR | {"omega0": 0.98 * LINEAR["omega0"]})
    (stretch,), evidence = errors(soft, sweep)
    lack = (1 - 0.98**2) * LINEAR["omega0"] ** 2
    assert evidence > 0.1
    loud = np.abs(stretch.x) > 0.2 * np.max(np.abs(stretch.x))
    assert stretch.missing @ stretch.x / (stretch.x @ stretch.x) == pytest.approx(lack, rel=0.05)
    assert stretch.missing[loud] == pytest.approx(lack * stretch.x[loud], abs=0.15 * lack * np.max(np.abs(stretch.x)))


def test_the_motion_and_the_force_along_it_are_those_of_the_recording(sweep):
    (stretch,), _ = errors(Oscillator.from_values(LINEAR), sweep)
    assert stretch.name == "sweep"
    assert stretch.driven
    place = np.searchsorted(sweep.time, stretch.time - 1e-9)
    assert stretch.x == pytest.approx(np.asarray(sweep.response)[place], abs=1e-5)
    assert stretch.drive == pytest.approx(np.asarray(sweep.force)[place] / LINEAR["mass"], rel=1e-9, abs=1e-9)
    # sixteen samples a cycle; the last derivative of each column is the next column
    assert np.median(np.diff(stretch.time)) == pytest.approx(PERIOD / 16, rel=0.25)
    t, turn = stretch.time, 2 * np.pi * (9.0 * stretch.time + 0.7 * stretch.time**2)
    pace = 2 * np.pi * (9.0 + 1.4 * t)
    level = 0.5 / LINEAR["mass"]
    assert stretch.drive == pytest.approx(level * np.sin(turn), abs=0.02 * level)
    assert stretch.drive_rate == pytest.approx(level * pace * np.cos(turn), abs=0.1 * level * 100.0)
    assert stretch.drive_bend == pytest.approx(-level * pace**2 * np.sin(turn), abs=0.2 * level * 100.0**2)
    force = stretch.drive - LINEAR["viscous"] * stretch.v - LINEAR["omega0"] ** 2 * stretch.x
    assert stretch.a == pytest.approx(force, abs=0.03 * np.max(np.abs(stretch.a)))
    inside = slice(20, -20)  # an envelope has ends
    assert stretch.amplitude[inside] * np.cos(stretch.phase[inside]) == pytest.approx(
        stretch.x[inside], abs=0.02 * np.max(stretch.amplitude)
    )
    assert np.median(stretch.frequency_hz) == pytest.approx(12.5, abs=1.0)
    assert np.array_equal(np.unique(stretch.block), np.arange(stretch.block[0], stretch.block[-1] + 1))
    assert np.max(stretch.block) == int(stretch.time[-1] / (BLOCK_CYCLES * PERIOD))


def test_a_free_decay_has_no_drive(recorded):
    decay = recorded(LINEAR, begin=(5e-3, 0.0), seconds=2.0, name="decay")
    (stretch,), _ = errors(Oscillator.from_values(LINEAR), decay)
    assert not stretch.driven
    assert not np.any(stretch.drive)
    assert stretch.n == stretch.time.size == stretch.x.size
    # of its two seconds a cycle at each end is left out
    assert (stretch.time[0], stretch.time[-1]) == pytest.approx((PERIOD, 2.0 - PERIOD), abs=0.1 * PERIOD)


@pytest.mark.parametrize(("cycles", "told"), [(3.0, 0), (8.0, 1)])
def test_a_stretch_of_too_few_cycles_is_left_out(cycles, told, sweep, recorded):
    """A cycle at each end goes, and of the rest at least two must remain."""
    model = Oscillator.from_values(LINEAR)
    data = data_of([sweep], model)
    n = round(cycles * PERIOD * sweep.fs)
    short = replace(data, segments=(data.segments[0].part(1000, 1000 + n),))
    assert len(equation_error(model, short)[0]) == told


def test_one_prior_for_all_so_that_quiet_and_loud_compare(sweep, recorded):
    """The quiet recording lacks as much per displacement, though by itself it would show less."""
    soft = Oscillator.from_values(LINEAR | {"omega0": 0.98 * LINEAR["omega0"]})
    quiet = recorded(LINEAR, sweep=(0.1, *SWEEP[1:]), name="quiet", seconds=5.0, noise=2e-6, seed=1)
    (loud, low), _ = errors(soft, sweep, quiet)
    per = [s.missing @ s.x / (s.x @ s.x) for s in (loud, low)]
    assert per[1] == pytest.approx(per[0], rel=0.1)


def test_evidence_is_counted_a_sample_and_the_strongest_gives_the_prior(monkeypatch):
    """Of each segment where it is loudest: 200 samples that gain 30, 600 that gain 2."""
    loudest = {0: (100, 300, 0.5, 30.0), 1: (400, 1000, 2.0, 2.0)}
    priors = []

    class Found:
        def __init__(self, model, data, index):
            self.first, self.last, self.strength, self.gain = loudest[index]

        def loudest(self):
            return self.first, self.last

        def most_likely(self, first, last):
            assert (first, last) == (self.first, self.last)
            return self.strength, 1.0

        def evidence(self, strength, memory, first, last):
            assert (strength, memory, first, last) == (self.strength, 1.0, self.first, self.last)
            return self.gain

        def smooth(self, prior):
            priors.append(prior)
            return "smoothed"

    segments = [SimpleNamespace(recording=i, force=force) for i, force in enumerate((None, np.ones(3)))]
    data = SimpleNamespace(segments=segments, recordings=[SimpleNamespace(name=name) for name in "ab"])
    module = "dashpot.diagnose.place.equation_error"
    monkeypatch.setattr(f"{module}.Smoother", Found)
    monkeypatch.setattr(f"{module}._stretch", lambda name, driven, *_: (name, driven) if name == "b" else None)
    stretches, evidence = equation_error(Oscillator.from_values(LINEAR), data)  # pyright: ignore[reportArgumentType]
    assert evidence == pytest.approx(32.0 / 800.0)
    assert priors == [(2.0, 1.0)] * 2
    assert stretches == [("b", True)]


@pytest.mark.parametrize(("a_cycle", "kept", "span"), [(60, 3, 11), (12, 1, 5)])
def test_the_rate_of_a_force_is_that_of_a_cubic_over_a_sixth_of_a_cycle(a_cycle, kept, span):
    """Or over five samples (Savitzky and Golay 1964); sixteen samples a cycle stay, or all."""
    dt, n = 1e-3, 20 * a_cycle
    turn = 2 * np.pi * np.arange(n) / a_cycle
    drive = np.random.default_rng(0).standard_normal(n)
    smoothed = SimpleNamespace(
        time=np.arange(n) * dt,
        displacement=np.cos(turn),
        velocity=-np.sin(turn),
        force=np.zeros(n),
        noise=np.zeros(n),
        drive=drive,
        moving=np.arange(n) != 5 * a_cycle,
        strength=1.0,
        memory=1.0,
    )
    stretch = _stretch("run", True, smoothed, SimpleNamespace(dt=dt, period=a_cycle * dt))  # type: ignore[arg-type]
    assert stretch is not None
    place = np.arange(a_cycle, 19 * a_cycle, kept)
    place = place[place != 5 * a_cycle]  # where the mass rests
    assert stretch.time == pytest.approx(place * dt)
    i, half = place[40], span // 2
    near = np.arange(-half, half + 1)
    cubic = np.polyfit(near * dt, drive[i + near], 3)
    assert stretch.drive_rate[40] == pytest.approx(cubic[-2])
    assert stretch.drive_bend[40] == pytest.approx(2 * cubic[-3])
    assert np.array_equal(stretch.block, place // (4 * a_cycle))


def test_a_force_of_next_to_nothing_is_as_likely_with_every_memory(sweep):
    model = Oscillator.from_values(LINEAR)
    smoother = Smoother(model, data_of([sweep], model), 0)
    weakest = smoother.scale * _NONE
    likely = [smoother.log_likelihood(weakest, memory, 0, smoother.n) for memory in np.linspace(1.5, 1.5001, 9)]
    assert np.ptp(likely) < 0.5

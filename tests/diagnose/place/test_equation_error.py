"""The equation of motion along a recording: what is missing in it, and the motion that it is missing along."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.equation_error import BLOCK_CYCLES, equation_error
from dashpot.examples.truth import TRUTH
from dashpot.identify.data import data_of
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
    assert evidence < 0.01
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

"""What a sensor shows at zero: found where it is there and not where it is not; by closed forms and exact motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.fit.offsets import response_offsets
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.offset import Offset, centre, drift_of, zero_of_load_cell
from dashpot.identify.problem.output_error import State
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.recording import Recording

OFFSET = 25e-3
W, H = TRUTH["omega0"], TRUTH["viscous"] / 2
N, FS, NOISE = 400, 400.0, 5e-6
LINEAR = {"mass": None, "omega0": W, "viscous": 2 * H, "cubic": 0.0, "preload": 0.0, "dry": 0.0}
FIXED = ("cubic", "preload", "dry")
#: Of the mean of so much white noise; the motion has next to no part in it.
ERROR = NOISE / np.sqrt(N)


def decay(seed, offset=0.0):
    """A linear decay in closed form, a second of it."""
    t, damped = np.arange(N) / FS, np.sqrt(W**2 - H**2)
    x = 5e-3 * np.exp(-H * t) * (np.cos(damped * t) + H / damped * np.sin(damped * t))
    noise = NOISE * np.random.default_rng(seed).standard_normal(N)
    return Recording(f"decay {seed}", FS, x + offset + noise, free=True)


def offsets_of(*recordings):
    return maximum_likelihood(Oscillator.from_values(LINEAR), recordings, FIXED).offsets


def good(identification, names=TRUTH):
    known = identification.oscillator.parameters()
    return [
        abs(known[name].value - TRUTH[name]) < 4 * known[name].std
        for name in names
        if name in known and known[name].std is not None
    ]


@pytest.mark.parametrize("offset", [OFFSET, -OFFSET])
def test_an_offset_five_times_the_decay(recorded, offset):
    identification = identify([recorded(begin=(5e-3, 0.0), seconds=3.0, offset=offset)])
    (shown,) = identification.fit.offsets
    assert (shown.recording, shown.channel) == (0, "response")
    assert abs(shown.value - offset) < 4 * shown.std < 1e-3 * abs(offset)
    assert len(good(identification)) == 5
    assert all(good(identification))
    assert identification.oscillator.amplitude.max == pytest.approx(5e-3, rel=0.01)  # of the motion


@pytest.mark.parametrize("offset", [OFFSET, -OFFSET])
def test_the_same_on_a_sweep_beside_a_decay_without_one(recorded, offset):
    sweep = recorded(sweep=(1.0, 5.0, 20.0), seconds=10.0, offset=offset, name="sweep")
    identification = identify([recorded(begin=(5e-3, 0.0), seconds=3.0, name="decay"), sweep])
    (shown,) = identification.fit.offsets
    assert shown.recording == 1
    assert abs(shown.value - offset) < 4 * shown.std < 1e-3 * abs(offset)
    assert len(good(identification)) == 6
    assert all(good(identification))
    # it is in there
    assert identification.fit.segments[1].simulated == pytest.approx(np.asarray(sweep.response), abs=2e-5)


def test_no_offset_is_kept_where_there_is_none():
    """By chance one in five thousand (3.7 standard errors); the spectrum's own error makes that one in some hundred."""
    assert sum(len(offsets_of(decay(seed))) for seed in range(30)) <= 1


def test_an_offset_of_two_of_its_errors_is_not_kept_and_one_of_eight_is():
    for seed in range(10):
        assert offsets_of(decay(100 + seed, 2 * ERROR)) == ()
        (shown,) = offsets_of(decay(100 + seed, 8 * ERROR))
        assert shown.value == pytest.approx(8 * ERROR, abs=4 * ERROR)


def test_its_standard_error_is_that_of_a_mean():
    offsets = [offsets_of(decay(200 + seed, OFFSET))[0] for seed in range(25)]
    assert np.sqrt(np.mean([o.std**2 for o in offsets])) == pytest.approx(ERROR, rel=0.2)
    scores = np.array([(o.value - OFFSET) / o.std for o in offsets])
    assert np.sqrt(np.mean(scores**2)) == pytest.approx(1.0, abs=0.45)  # of 25: 3 times sqrt(1 / 50)


def test_each_recording_has_its_own():
    offsets = offsets_of(decay(0), decay(1, OFFSET), decay(2), decay(3, -OFFSET))
    assert [o.recording for o in offsets] == [1, 3]
    assert [o.value for o in offsets] == pytest.approx([OFFSET, -OFFSET], abs=5 * ERROR)


@pytest.mark.parametrize("effect", ["sensor-offset", "constant-force"])
def test_beside_a_law_that_moves_the_zero_there_is_none(with_law, effect):
    model = with_law(effect)
    data = data_of([decay(0)], model)
    assert response_offsets(data, [decay(0)], model) == ()
    (offset,) = response_offsets(data, [decay(0)], with_law("quadratic-drag"))
    assert (offset.recording, offset.channel) == (0, "response")


@pytest.mark.parametrize("cycles", [0.5, 3.3, 40.0])
def test_the_centre_of_a_motion(cycles):
    """Of whole cycles their mean, whatever part of one is left over; of less than one the mean of all."""
    n = round(cycles * 2 * np.pi / W * 1000)
    x = np.cos(W * np.arange(n) / 1000.0)
    if cycles < 1:
        assert centre(x + 3.0, 1000.0, W) == pytest.approx(np.mean(x) + 3.0)
    else:
        assert centre(x + 3.0, 1000.0, W) == pytest.approx(3.0, abs=0.01)


@pytest.mark.parametrize(("shift", "drift"), [(2e-4, 0.0), (0.0, 5e-5)])
def test_what_follows_the_motions_size_is_no_drift(shift, drift):
    """A spring that is stiffer on one side moves the middle with the square of the amplitude, a sensor with time."""
    n = 4 * N
    t, damped = np.arange(n) / FS, np.sqrt(W**2 - H**2)
    swing = np.exp(-H * t)
    x = 5e-3 * swing * np.cos(damped * t) + shift * swing**2 + drift * t
    noise = NOISE * np.random.default_rng(3).standard_normal(n)
    drifts = [o for o in offsets_of(Recording("decay", FS, x + noise, free=True)) if o.channel == "drift"]
    assert len(drifts) == (drift > 0)
    for offset in drifts:
        assert offset.value == pytest.approx(drift, rel=0.05)


@pytest.mark.parametrize("memory", [FREE, 8.0])
def test_what_a_sensor_shows_has_a_derivative_written_down_but_for_what_a_prediction_corrects_by_it(memory):
    """Against differences: in a free simulation ones, and a straight line."""
    recordings = [decay(0), decay(1)]
    model = Oscillator.from_values(LINEAR)
    channels = [Offset(0, "response", 1e-4), Offset(1, "response", 1e-4), Offset(1, "drift", 1e-4, middle=0.3)]
    problem = Structure(model, replace(data_of(recordings, model), offsets=tuple(channels)), FIXED).problem
    problem = problem.predicting(memory)
    state = State(np.array([*model.values().values()]), np.array([[5e-3, 0.0]] * 2), np.zeros(3))
    residuals, first = problem.residuals(state), len(problem.free)
    made = problem.derivatives(state, residuals)
    for k in range(3):
        moved = problem.residuals(replace(state, offsets=1e-4 * np.eye(3)[k]))
        for rows, before, after in zip(made, residuals, moved, strict=True):
            assert rows[first + k] == pytest.approx((before - after) / 1e-4, rel=1e-6, abs=1e-6)
    if memory == FREE:
        assert [np.ptp(made[1][first + k]) for k in range(3)] == pytest.approx([0.0, 0.0, (N - 1) / FS])


@pytest.mark.parametrize(("times", "kept"), [(3.71, False), (3.72, True), (-3.72, True)])
def test_a_zero_stands_out_at_odds_of_a_thousand(monkeypatch, times, kept):
    """Half the square of 3.717 errors is the logarithm of a thousand."""
    monkeypatch.setattr("dashpot.identify.problem.offset.zero_of", lambda *_: (2e-3 * times, 2e-3))
    assert zero_of_load_cell(np.zeros(100), 100.0, 10.0) == (2e-3 * times if kept else 0.0)


@pytest.mark.parametrize(("cycles", "told"), [(4, False), (5, True)])
def test_four_means_do_not_show_their_own_scatter(cycles, told):
    """Three unknowns, the size of the motion among them, leave one of four."""
    n = cycles * 50
    response = np.linspace(1.0, 2.0, n) * np.cos(2 * np.pi * np.arange(n) / 50)
    drift = drift_of([(0.0, 0.02, response, 3.0 * 0.02 * np.arange(n))], 2 * np.pi)
    assert (drift is not None) is told
    assert drift is None or drift == pytest.approx(3.0, rel=1e-3)


def test_a_slide_has_no_zero():
    """No place is its middle: 0.23 m from the sensor's zero it is as it is elsewhere; by the closed form from rest."""
    mass, c, fs, place = 90.0, 2.0, 200.0, 0.23
    t = np.arange(4000) / fs
    force, x = np.zeros(t.size), np.full(t.size, place)
    for level, w in ((60.0, 2.0), (40.0, 5.0), (30.0, 9.0)):
        force += level * np.sin(w * t)
        size = level / mass / (c**2 + w**2)
        x += size * (c * (1 - np.cos(w * t)) / w - np.sin(w * t) + w * (1 - np.exp(-c * t)) / c)
    x += 2e-6 * np.random.default_rng(0).standard_normal(t.size)
    recording = Recording("slide", fs, x, force, hold="smooth")
    start = Oscillator.from_values({**LINEAR, "mass": 80.0, "omega0": 0.05, "viscous": 1.5})
    assert data_of([recording], start).segments[0].slide
    assert response_offsets(data_of([recording], start), [recording], start) == ()
    fit = maximum_likelihood(start, [recording], FIXED)
    assert fit.offsets == ()
    found = fit.oscillator.parameters()
    assert found["mass"].value == pytest.approx(mass, rel=1e-3)
    assert found["viscous"].value == pytest.approx(c, rel=1e-2)

"""A rig seen from its base: derivatives against closed forms, and whether a response is relative, by the signals."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import recordings_of
from dashpot.recording.base_motion import denoised, derivative, driven_through, highest_of, seen_from_base
from dashpot.recording.recording import DAMPER, SPRING, WHOLE
from scipy.integrate import solve_ivp

FS, SECONDS, OMEGA, VISCOUS, CUBIC = 200.0, 20.0, 2 * np.pi * 5.0, 1.0, 2e5
T = np.arange(round(FS * SECONDS)) / FS


def base(order, t=T):
    """A sweep of 2 mm, 3 to 7 Hz, and its derivatives."""
    turn, pace, rise = 2 * np.pi * (3.0 * t + 0.1 * t**2), 2 * np.pi * (3.0 + 0.2 * t), 2 * np.pi * 0.2
    swept = (np.sin(turn), np.cos(turn) * pace, np.cos(turn) * rise - np.sin(turn) * pace**2)
    return 2e-3 * swept[order]


def rates(t, y):
    return [y[1], -VISCOUS * y[1] - OMEGA**2 * y[0] - CUBIC * y[0] ** 3 - base(2, t)]


@pytest.fixture(scope="module")
def motion():
    """(3, n) of the mass relative to its base: displacement, velocity, acceleration, by an independent integrator."""
    y = solve_ivp(rates, (0.0, T[-1]), [0.0, -base(1, 0.0)], t_eval=T, rtol=1e-10, atol=1e-13, max_step=0.01).y
    return np.array([*y, rates(T, y)[1]])


def noisy(signal, seed, part=1e-3):
    return signal + part * np.std(signal) * np.random.default_rng(seed).standard_normal(signal.size)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_a_derivative_is_that_of_the_closed_form(order):
    assert derivative(base(0), FS, order, 7.0 / FS) == pytest.approx(
        base(order), abs=1e-3 * np.max(np.abs(base(order)))
    )


def test_noise_is_amplified_no_more_than_the_motion_asks():
    shown = noisy(base(0), 1)
    highest = highest_of(shown)
    assert 7.0 < highest * FS < 9.0
    inside = slice(600, -600)
    smooth, seen = (
        np.std((derivative(*of) - base(2))[inside])
        for of in ((shown, FS, 2, highest), (denoised(shown, highest), FS, 2, highest))
    )
    assert seen < 0.1 * smooth
    assert seen < 2e-3 * np.std(base(2))


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
@pytest.mark.parametrize("over_ground", [True, False])
def test_the_signals_tell_whether_a_response_is_relative(motion, quantity, over_ground):
    order = ("displacement", "velocity", "acceleration").index(quantity)
    shown = noisy(motion[order] + (base(order) if over_ground else 0.0), 2)
    moved = noisy(base(order), 3)
    seen = seen_from_base("a.csv", FS, shown, quantity, moved, quantity, None)
    assert ("over the ground" in seen.said) == over_ground
    assert np.std(seen.response - motion[order]) < 4e-3 * np.std(motion[order])
    inside = slice(50, -50)
    assert np.std((seen.force + base(2))[inside]) < 0.02 * np.std(base(2))


def test_what_is_stated_is_taken(motion):
    stated = (seen_from_base("a", FS, motion[0], "displacement", base(0), "displacement", r) for r in (True, False))
    relative, absolute = (seen.response for seen in stated)
    assert np.array_equal(relative, motion[0])
    assert absolute == pytest.approx(motion[0] - base(0), abs=1e-7)


@pytest.mark.parametrize(
    ("response", "quantity", "moved", "of_base", "words"),
    [
        (np.sin(T), "displacement", np.ones(T.size), "displacement", "the base does not move"),
        (base(0), "displacement", base(0), "displacement", "the response is the motion of the base"),
        (0.0 * T, "displacement", 1e200 * base(0), "displacement", "larger than any motion"),
        (np.sin(30 * T), "displacement", np.sin(0.6 * T), "displacement", "state --relative or --absolute"),
        (np.sin(T), "displacement", np.full(T.size, np.nan), "displacement", "values that are not a number"),
        (base(0), "displacement", base(2), "acceleration", "over the ground give the base's displacement"),
        (np.sin(OMEGA * T + 1.0), "displacement", np.sin(OMEGA * T), "displacement", "state --relative or --absolute"),
    ],
)
def test_what_cannot_be_told_is_refused(response, quantity, moved, of_base, words):
    with pytest.raises(BadInput, match=words):
        seen_from_base("a.csv", FS, response, quantity, moved, of_base, None)


def arrays(motion, **more):
    return {"time_s": T, "x_mm": 1e3 * (motion[0] + base(0)), "base_mm": 1e3 * base(0)} | more


def test_a_base_is_found_by_its_name(motion):
    (recording,) = recordings_of(arrays(motion))
    assert recording.base == WHOLE
    assert recording.force_unit == "m/s2"
    assert recording.response == pytest.approx(motion[0], abs=1e-9)
    assert recording.force == pytest.approx(-base(2), abs=1e-3 * np.max(np.abs(base(2))))
    assert recording.slice(5, 50).base == WHOLE
    assert any("tells no mass" in note for note in recording.notes)


def test_it_is_left_out_where_that_is_said(motion):
    (recording,) = recordings_of(arrays(motion), base="none")
    assert not recording.base
    assert recording.force is None


@pytest.mark.parametrize(
    ("more", "options", "words"),
    [
        ({"force_N": np.sin(T)}, {}, "holds a force, 'force_N', and a moving base, 'base_mm'"),
        ({}, {"force": "base_mm", "base": "base_mm"}, "--force and --base were both given"),
        ({"base_rad": base(0)}, {"base": "base_rad"}, "the base is in rad and the response in mm"),
        ({}, {"base": "x_mm"}, "no column for the response"),
        ({}, {"base": "x_mm", "response": "x_mm"}, "--base and --response name the same column|--response and --base"),
        ({"base_N": base(0)}, {"base": "base_N"}, "measures force"),
        ({"base_2_mm": base(0)}, {}, "all look like the base; choose one with --base"),
    ],
)
def test_a_file_that_does_not_say_which_is_refused(motion, more, options, words):
    with pytest.raises(BadInput, match=words):
        recordings_of(arrays(motion, **more), **options)


def test_a_force_that_is_named_is_taken_beside_a_base(motion):
    (recording,) = recordings_of(arrays(motion, force_N=np.sin(T)), force="force_N")
    assert not recording.base
    assert recording.force_unit == "N"


def test_too_short_a_recording_is_refused_as_any_other():
    with pytest.raises(BadInput, match="sample"):
        recordings_of({"time_s": T[:6], "x_mm": np.sin(T[:6]), "base_mm": np.cos(T[:6])}, relative=True)


def test_a_base_without_a_unit_is_taken_for_metres_and_that_is_said(motion):
    arrays = {"time_s": T, "x_m": motion[0] + base(0), "base": base(0)}
    (recording,) = recordings_of(arrays, base="base")
    assert any("no unit is given for the base, m is assumed" in note for note in recording.notes)


@pytest.mark.parametrize("n", [9, T.size])
def test_a_dead_sensor_or_a_few_samples_end_in_a_sentence(n):
    with pytest.raises(BadInput, match=r"sample|throughout|--relative"):
        recordings_of({"time_s": T[:n], "x_m": 0.0 * T[:n], "base_m": base(0)[:n]})


@pytest.fixture(scope="module")
def through_a_spring():
    """Displacement of a mass over the ground whose spring, one of two, is moved at its other end."""

    def rates(t, y):
        return [y[1], 0.4 * OMEGA**2 * base(0, t) - VISCOUS * y[1] - OMEGA**2 * y[0] - CUBIC * y[0] ** 3]

    return solve_ivp(rates, (0.0, T[-1]), [0.0, 0.0], t_eval=T, rtol=1e-10, atol=1e-13, max_step=0.01).y[0]


def test_the_signals_tell_a_base_that_moves_one_end_of_a_spring_alone(through_a_spring):
    shown, moved = noisy(through_a_spring, 2), noisy(base(0), 3)
    seen = seen_from_base("a.csv", FS, shown, "displacement", moved, "displacement", None)
    assert seen.base == SPRING
    assert np.array_equal(seen.response, shown)
    assert np.array_equal(seen.force, moved)
    (recording,) = recordings_of({"time_s": T, "x_mm": 1e3 * shown, "base_mm": 1e3 * moved})
    assert (recording.base, recording.force_unit, recording.rides) == (SPRING, "m", False)
    stated = seen_from_base("a.csv", FS, shown, "displacement", moved, "displacement", False)
    assert stated.base == WHOLE  # what is stated is taken


@pytest.mark.parametrize(("of_base", "order"), [("displacement", 0), ("velocity", 1)])
def test_a_damper_passes_on_the_velocity_of_its_end(of_base, order):
    seen = driven_through("a.csv", FS, np.sin(T), noisy(base(order), 4), of_base, DAMPER)
    assert (seen.base, seen.per_time) == (DAMPER, "/s")
    inside = slice(50, -50)
    assert np.std((seen.force - base(1))[inside]) < 0.02 * np.std(base(1))


@pytest.mark.parametrize(
    ("arrays", "options", "words"),
    [
        ({"base_m_s2": base(2)}, {"through": "spring"}, "a spring passes on the displacement of its end"),
        ({"base_m_s2": base(2)}, {"through": "damper"}, "its displacement or its velocity with --base"),
        ({"base_m": base(0)}, {"through": "spring", "relative": True}, "--through and --relative were both given"),
        ({"base_m": base(0)}, {"through": "rope"}, "it can be a spring or a damper"),
        ({"base_m": np.ones(T.size)}, {"through": "spring"}, "the base does not move"),
        ({}, {"through": "spring"}, "no column is one; name it with --base"),
    ],
)
def test_what_drives_through_nothing_is_refused(arrays, options, words):
    with pytest.raises(BadInput, match=words):
        recordings_of({"time_s": T, "x_m": np.sin(30 * T), **arrays}, **options)

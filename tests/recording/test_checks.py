"""Every check with a recording it must stop and one it must let pass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.recording import Problem, Recording, check
from scipy.signal import chirp, lsim

FS = 1000.0
N = 20_000
TIME = np.arange(N) / FS
RNG = np.random.default_rng(42)
NOISE = 1e-6 * RNG.standard_normal(N)
SWEEP = 0.3 * chirp(TIME, 5, TIME[-1], 20)
MASS, OMEGA, DECAY_RATE = 0.27, 2 * np.pi * 12.67, 2.5


def rig(force: np.ndarray, released: float = 0.0) -> np.ndarray:
    system = ([[0, 1], [-(OMEGA**2), -2 * DECAY_RATE]], [[0], [1 / MASS]], [[1, 0]], [[0]])
    return lsim(system, force, TIME[: len(force)], X0=[released, 0])[1] + NOISE[: len(force)]


DECAY = Recording("decay.csv", FS, rig(np.zeros(N), released=5e-3))
FORCED = Recording("sweep.csv", FS, rig(SWEEP), force=SWEEP + 3e-4 * RNG.standard_normal(N))


def errors(recording: Recording) -> list[str]:
    return [problem.sentence for problem in check(recording) if problem.severity == "error"]


def the_error(recording: Recording) -> str:
    sentences = errors(recording)
    assert len(sentences) == 1, sentences
    assert "\n" not in sentences[0]
    return sentences[0]


def test_sound_recordings_have_no_problem():
    assert check(DECAY) == []
    assert check(FORCED) == []


def test_zero_force_is_a_free_decay():
    assert check(replace(DECAY, force=np.zeros(N))) == []


def test_not_a_number():
    response = DECAY.response.copy()
    response[[500, 501]] = np.nan
    sentence = the_error(replace(DECAY, response=response, start=10.0))
    assert "response has 2 value(s) that are not a number, the first at 10.5 s" in sentence
    force = np.where(np.arange(N) == 7, np.inf, SWEEP)
    assert "the force has 1 value(s)" in the_error(replace(FORCED, force=force))


@pytest.mark.parametrize("level", [0.0, 3.7])
def test_constant_response(level):
    assert "throughout" in the_error(replace(DECAY, response=np.full(N, level)))


# --- clipping


@pytest.mark.parametrize("share", [0.8, 0.6, 0.4])
@pytest.mark.parametrize("resolution", [0.0, 1e-5])
@pytest.mark.parametrize("recording", [DECAY, FORCED], ids=lambda recording: recording.name)
def test_clipped_response(recording, share, resolution):
    rail = share * np.abs(recording.response).max()
    response = np.clip(recording.response, -rail, rail)
    response = np.round(response / resolution) * resolution if resolution else response
    sentence = the_error(replace(recording, response=response))
    assert "response is clipped" in sentence
    assert "measuring range" in sentence
    at = recording.start + np.flatnonzero(np.abs(response) >= np.max(np.abs(response)))[[0, -1]] / recording.fs
    assert f"from {at[0]:.4g} to {at[1]:.4g} s; use a part without it" in sentence


def test_one_rail_is_enough():
    rail = 0.6 * FORCED.response.max()
    sentence = the_error(replace(FORCED, response=np.minimum(FORCED.response, rail)))
    assert f"exactly at {rail:.4g} m" in sentence


@pytest.mark.parametrize("bits", [6, 8, 10, 12])
@pytest.mark.parametrize("recording", [DECAY, FORCED], ids=lambda recording: recording.name)
def test_coarse_resolution_is_not_clipping(recording, bits):
    step = np.ptp(recording.response) / 2**bits
    assert errors(replace(recording, response=np.round(recording.response / step) * step)) == []


def test_rest_before_and_after_is_not_clipping():
    response = np.round(np.concatenate((np.zeros(N // 2), DECAY.response[: N // 2])) / 1e-5) * 1e-5
    assert errors(replace(DECAY, response=response)) == []
    assert errors(replace(DECAY, response=np.maximum(response, -1.0))) == []


def test_clipped_force_sensor_but_not_a_commanded_limit():
    assert FORCED.force is not None
    measured = np.clip(FORCED.force, -0.25, 0.25)
    assert "the force is clipped" in the_error(replace(FORCED, force=measured))
    commanded = check(replace(FORCED, force=np.clip(SWEEP, -0.25, 0.25)))
    assert [problem.severity for problem in commanded] == ["note"]
    assert "commanded" in commanded[0].sentence


def test_square_force_is_not_clipped():
    square = 0.3 * np.sign(np.sin(2 * np.pi * 3.1 * TIME))
    assert check(replace(FORCED, force=square, response=rig(square))) == []


# --- cycles and samples


def test_few_cycles_are_no_reason():
    # what the cycles tell is asked, not how many they are
    assert errors(FORCED.slice(0, 300)) == errors(DECAY.slice(0, 90)) == []


def test_a_force_whose_answer_is_hidden_in_noise_does_not_reach_it():
    noise = DECAY.response.max() * 0.2 * RNG.standard_normal(N)
    hidden = replace(FORCED, response=rig(0 * TIME) + noise)
    assert "does not reach the response" in the_error(hidden)


def test_few_cycles_are_noted():
    (problem,) = check(DECAY.slice(0, 600))
    assert problem == Problem("note", problem.sentence)
    assert "10 or more" in problem.sentence


def test_undersampled():
    coarse = Recording("decay.csv", 40.0, DECAY.response[::25])
    assert "only 3.2 samples a cycle" in the_error(coarse)
    swept = Recording("sweep.csv", 1000 / 38, FORCED.response[::38])
    assert "only 2.1 samples a cycle" in the_error(swept)
    quarter = Recording("sweep.csv", 50.0, FORCED.response[::20])
    assert "only 3.9 samples a cycle" in the_error(quarter)
    (note,) = check(Recording("decay.csv", 100.0, DECAY.response[::10]))
    assert note.severity == "note"
    assert "only 7.9 samples a cycle" in note.sentence


# --- decay


@pytest.mark.parametrize("rate", [0.02, 0.2, 2.0, 6.0])
@pytest.mark.parametrize("noise", [1e-4, 1e-2])
def test_slow_and_fast_decays_pass(rate, noise):
    response = np.exp(-rate * TIME) * np.cos(2 * np.pi * 13 * TIME) + noise * RNG.standard_normal(N)
    assert errors(replace(DECAY, response=1e-3 * response)) == []


def test_a_decay_after_a_burst_passes():
    burst = 0.3 * np.sin(2 * np.pi * 13 * TIME) * (TIME % 5 < 2)
    assert errors(replace(DECAY, response=rig(burst))) == []


# --- unit


@pytest.mark.parametrize(
    ("unit", "quantity", "factor", "probable"),
    [
        ("m", "displacement", 1e3, "mm"),
        ("m", "displacement", 1e6, "um"),
        ("m/s", "velocity", 1e5, "mm/s"),
        ("rad", "displacement", 5e3, "deg"),
        ("strain", "displacement", 1e5, "microstrain"),
    ],
)
def test_unit_wrong_by_orders_of_magnitude(unit, quantity, factor, probable):
    wrong = replace(DECAY, response=factor * DECAY.response, unit=unit, quantity=quantity)
    assert f"pass --unit {probable} if so" in the_error(wrong)


def test_wrong_unit_states_the_acceleration():
    sentence = the_error(replace(DECAY, response=1e3 * DECAY.response))
    assert "m at 12.7 Hz is a peak of" in sentence
    assert "g and" in sentence


def test_absurdly_small_response():
    for factor in (1e-8, 1e-12):
        assert "less than any sensor resolves; state the right unit" in the_error(
            replace(DECAY, response=factor * DECAY.response)
        )
    gauge = replace(DECAY, response=1e-9 * DECAY.response, unit="strain")
    assert "less than any gauge resolves" in the_error(gauge)


@pytest.mark.parametrize(
    ("amplitude", "frequency", "unit", "quantity"),
    [
        (30e-6, 20e3, "m", "displacement"),  # an ultrasonic horn
        (5e-9, 300.0, "m", "displacement"),  # laser vibrometer on a chip
        (0.3, 0.2, "m", "displacement"),  # a tower in the wind
        (50.0, 10.0, "V", "displacement"),
        (1.2, 0.5, "rad", "displacement"),  # a pendulum
        (500.0, 800.0, "m/s2", "acceleration"),
        (1e-3, 42.0, "strain", "displacement"),
    ],
)
def test_what_vibrates_in_earnest_passes(amplitude, frequency, unit, quantity):
    response = amplitude * DECAY.response / np.abs(DECAY.response).max()
    fast = Recording("decay.csv", FS * frequency / 12.67, response, unit=unit, quantity=quantity)
    assert check(fast) == []


# --- reach


def unrelated() -> dict[str, np.ndarray]:
    return {
        "noise": 1e-4 * RNG.standard_normal(N),
        "another release": DECAY.response,
        "another run": rig(3.0 * RNG.standard_normal(N)),
    }


@pytest.mark.parametrize(
    ("force", "name"),
    # random beside a release is missing: that is an idle sensor, tested with read()
    [*(("sweep", name) for name in unrelated()), ("random", "noise"), ("random", "another run")],
)
def test_force_that_does_not_reach(name, force):
    cause = {"sweep": SWEEP + 3e-4 * RNG.standard_normal(N), "random": RNG.standard_normal(N) * (TIME > 1)}[force]
    sentences = errors(replace(FORCED, force=cause, response=unrelated()[name] * 0.1))
    says = {"sweep": "does not reach the response", "random": "nothing but white noise"}[force]
    assert any(says in sentence for sentence in sentences), sentences


@pytest.mark.parametrize("shift", [N // 4, N // 2])
def test_force_of_another_moment(shift):
    assert FORCED.force is not None
    assert "does not reach" in the_error(replace(FORCED, force=np.roll(FORCED.force, shift)))


def test_shuffled_force_is_not_taken_for_an_idle_sensor():
    assert FORCED.force is not None
    assert "nothing but white noise" in the_error(replace(FORCED, force=RNG.permutation(FORCED.force)))


def test_a_force_shifted_by_little_still_reaches():
    assert FORCED.force is not None
    assert errors(replace(FORCED, force=np.roll(FORCED.force, 50))) == []


def causes() -> dict[str, np.ndarray]:
    lines = np.arange(100, 400)
    multisine = np.cos(2 * np.pi * np.outer(TIME, lines / 20) + RNG.uniform(0, 2 * np.pi, len(lines))).sum(axis=1)
    return {
        "down": SWEEP[::-1],
        "random": RNG.standard_normal(N),
        "multisine": 0.02 * multisine,
        "tone": 0.3 * np.sin(2 * np.pi * 13 * TIME),
        "bursts": 0.3 * np.sin(2 * np.pi * 13 * TIME) * (TIME % 5 < 1),
        "blow": 10.0 * (TIME < 0.005),
        "release of a pull": 1.0 * (TIME < 3),
    }


@pytest.mark.parametrize("name", list(causes()))
@pytest.mark.parametrize("noise", [0.001, 0.03])
def test_force_that_reaches(name, noise):
    force = causes()[name]
    response = rig(force)
    response = response + noise * response.std() * RNG.standard_normal(N)
    force = force + 1e-4 * np.abs(force).max() * RNG.standard_normal(N)
    assert errors(Recording("r.csv", FS, response, force=force)) == []


def test_a_strongly_nonlinear_response_is_still_reached():
    response = FORCED.response**3 / np.max(FORCED.response**2) + 0.3 * np.abs(FORCED.response)
    assert errors(replace(FORCED, response=response)) == []


def test_an_angle_that_was_wrapped_is_refused_with_what_to_do():
    t = np.arange(3000) / 100.0
    angle = np.pi + 1.0 * np.exp(-0.05 * t) * np.cos(2 * np.pi * t)
    shown = (angle + np.pi) % (2 * np.pi) - np.pi
    (sentence,) = [found for found in errors(Recording("p", 100.0, shown, unit="rad")) if "turn" in found]
    assert "at 0.26 s" in sentence
    assert "unwrap" in sentence
    assert not any("leaps" in found for found in errors(Recording("p", 100.0, shown, unit="rad")))
    # a length has no turns, and the angle itself runs on
    assert not any("turn" in found for found in errors(Recording("p", 100.0, shown)))
    assert not any("turn" in found for found in errors(Recording("p", 100.0, angle, unit="rad")))


def test_a_displacement_that_leaps_is_refused_with_the_place():
    lost = np.delete(FORCED.response, range(6000, 6030)), np.delete(FORCED.force, range(6000, 6030))
    sentence = the_error(replace(FORCED, response=lost[0], force=lost[1]))
    assert "jumps by" in sentence
    assert "within one sample at 5.999 s" in sentence
    assert "samples are missing" in sentence
    assert "--part" in sentence
    velocity = replace(FORCED, response=np.gradient(lost[0], 1 / FS), force=lost[1], quantity="velocity", unit="m/s")
    assert not any("leaps" in found for found in errors(velocity))


def test_a_single_wrong_sample_is_said_to_be_one():
    response = FORCED.response.copy()
    response[5000] += 20 * np.std(response)
    assert any(
        "and back" in found and "mend that sample" in found for found in errors(replace(FORCED, response=response))
    )


def test_a_block_that_was_written_twice_is_refused():
    twice = [np.concatenate([signal[:6000], signal[5950:]]) for signal in (FORCED.response, FORCED.force)]
    found = errors(replace(FORCED, response=twice[0], force=twice[1]))
    assert any("the 50 samples from 6 s on are those from 5.95 s on once more" in sentence for sentence in found)


@pytest.mark.parametrize(("steps", "told"), [(0.45, True), (0.6, False)])
def test_a_repeat_is_told_of_noise_that_shows_in_the_converters_steps(steps, told):
    """Noise of two steps and more; of less a rounded signal may well be the same again."""
    twice = [np.concatenate([signal[:6000], signal[5950:]]) for signal in (FORCED.response, FORCED.force)]
    step = steps * np.std(NOISE)
    rounded = replace(FORCED, response=np.round(twice[0] / step) * step, force=twice[1])
    assert any("once more" in sentence for sentence in errors(rounded)) is told


@pytest.mark.parametrize(("levels", "told"), [(250, True), (262, False)])
def test_rounding_to_fewer_levels_than_eight_bits_is_told(levels, told):
    step = np.ptp(FORCED.response) / levels
    problems = check(replace(FORCED, response=np.round(FORCED.response / step) * step))
    assert [problem.severity for problem in problems if "levels" in problem.sentence] == ["note"] * told


@pytest.mark.parametrize(("times", "noise", "found"), [(100.0, 0.0, True), (-2.0, 0.0, True), (100.0, 1e-3, False)])
def test_one_signal_in_both_columns_is_refused(times, noise, found):
    t = np.arange(2000) / 500.0
    response = 1e-3 * chirp(t, 6.0, t[-1], 20.0)
    force = times * (response + noise * 1e-3 * np.random.default_rng(0).standard_normal(t.size))
    said = [
        p.sentence for p in check(Recording("r", 500.0, response, force)) if "one signal stands in both" in p.sentence
    ]
    assert (len(said) == 1) == found
    if found:
        assert f"the force is the response times {times:g} N/m" in said[0]


@pytest.mark.parametrize("lag", [0.05, 1.0, 1.5])
def test_a_steady_tone_with_a_lag_is_no_force_that_takes_work_out(lag):
    """Its response is known from its own past, so that a model of both says nothing of the sign."""
    tone = np.sin(2 * np.pi * 9.0 * TIME)
    response = 1e-3 * np.sin(2 * np.pi * 9.0 * TIME - lag) + 1e-5 * np.random.default_rng(3).standard_normal(N)
    driven = replace(FORCED, response=response, force=tone + 1e-2 * np.random.default_rng(4).standard_normal(N))
    assert not any("takes work out" in problem.sentence for problem in check(driven))


def test_a_force_of_noise_alone_is_no_force():
    quiet = replace(FORCED, force=0.5 + 1e-9 * np.random.default_rng(3).standard_normal(N))
    sentence = the_error(quiet)
    assert "the force column holds nothing but white noise, 1e-09 N rms," in sentence
    assert "of the response it explains no more than chance would" in sentence

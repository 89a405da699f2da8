"""Free motion in the recordings that people bring, from an integrator of its own: held, caught, pushed, struck."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify import identify
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.problem.segments import cut
from dashpot.recording import Recording, check
from scipy.integrate import solve_ivp

FS = 200.0
NOISE = 1e-5
W = 2 * np.pi * 5.0


def free(acceleration, x0, seconds, fs=FS):
    t = np.arange(round(seconds * fs)) / fs
    run = solve_ivp(lambda _, y: (y[1], acceleration(*y)), (0, t[-1]), (x0, 0.0), t_eval=t, rtol=1e-7, atol=1e-10)
    return run.y[0]


def recorded(x, fs=FS, noise=NOISE, **more):
    return Recording("run", fs, x + noise * np.random.default_rng(0).standard_normal(x.size), **more)


def linear(x, v):
    return -W * W * x - 0.02 * W * v


def spans(recording):
    return [(d.start / recording.fs, d.stop / recording.fs) for d in find_free_motion(recording).decays]


RINGING = free(linear, 5e-3, 8.0)


@pytest.mark.parametrize("angle", [2.8, 3.1])
def test_a_pendulum_held_up_and_let_go_on_a_coarse_encoder(angle):
    """The slow first swing lasts three times as long as the last: the motion is free from its first turning point."""
    w = 2 * np.pi * 0.8
    swing = free(lambda x, v: -w * w * np.sin(x) - 0.08 * v - 0.15 * np.tanh(v / 1e-2), angle, 50.0, 150.0)
    step = 2 * np.pi / 2000
    held = np.round(np.concatenate([np.full(225, angle), swing]) / step) * step
    recording = Recording("pendulum", 150.0, held, unit="rad")
    ((start, stop),) = spans(recording)
    first_turn = 1.5 + int(np.argmin(swing[:600])) / 150.0
    assert start == pytest.approx(first_turn, abs=0.05)
    still = 1.5 + np.flatnonzero(np.abs(np.diff(swing)) > 1e-5)[-1] / 150.0
    assert still - 2.0 < stop < still + 1.0
    assert "at rest or held" in find_free_motion(recording).notes[0]
    assert not [problem for problem in check(recording) if problem.severity == "error"]


def test_a_hand_that_lets_go_catches_and_pushes_again():
    ramp, caught = 5e-3 * np.sin(np.linspace(0, np.pi / 2, 200)) ** 2, np.linspace(RINGING[900], 1e-3, 12)
    push = 1e-3 + 3e-3 * np.sin(np.linspace(0, np.pi / 2, 60)) ** 2
    parts = [np.zeros(400), ramp, np.full(160, 5e-3), RINGING[:900], caught, np.full(300, 1e-3), push, 0.8 * RINGING]
    recording = recorded(np.concatenate(parts))
    (first, second) = spans(recording)
    assert 3.8 < first[0] < 3.95  # half a cycle after it was let go
    assert 8.2 < first[1] <= 8.305  # the last turning point before it was caught
    assert 10.14 < second[0] < 10.22
    assert second[1] == pytest.approx(recording.duration, abs=0.1)
    (note,) = find_free_motion(recording).notes
    assert "stopped" in note
    assert "not recorded" in note


@pytest.mark.parametrize("cycles", [6.5, 500])
def test_few_cycles_and_many(cycles):
    seconds = cycles / 5
    x = free(lambda x, v: -W * W * x - (0.4 if cycles < 10 else 0.01) * v, 5e-3, seconds)
    assert spans(recorded(x)) == [(0.0, pytest.approx(seconds, abs=0.1))]


def test_a_steady_tone_of_few_cycles_is_no_decay():
    x = 5e-3 * np.cos(W * np.arange(260) / FS)
    assert spans(recorded(x)) == []


@pytest.mark.parametrize("offset", [25e-3, -25e-3])
def test_an_offset_and_a_drift_of_the_sensor_are_no_motion(offset):
    t = np.arange(RINGING.size) / FS
    for drift in (0 * t, 1e-3 * t, 2e-3 * np.sin(2 * np.pi * t / 9)):
        assert spans(recorded(RINGING + offset + drift)) == [(0.0, 8.0)]
    held = recorded(np.concatenate([np.full(800, 5e-3), RINGING]) + offset)
    ((start, stop),) = spans(held)
    assert 4.0 <= start < 4.05  # it was let go at 4 s
    assert stop == 12.0
    assert not [problem for problem in check(held) if problem.severity == "error"]


def test_a_recording_that_begins_within_the_decay():
    assert spans(recorded(RINGING[530:] + 1e-3)) == [(0.0, pytest.approx(5.35, abs=0.01))]


def test_a_dozen_steps_of_the_converter():
    step = 5e-3 / 6
    ((start, stop),) = spans(Recording("steps", FS, np.round(RINGING / step) * step))
    assert start == 0.0
    assert stop > 6.0  # half a step is reached after 7.9 s


def test_dry_friction_after_a_hold():
    """Let go at 0.5 s it swings for 12 cycles, each 0.4 mm smaller than the one before, and rests."""
    x = free(lambda x, v: -W * W * x - 0.1 * np.tanh(v / 1e-4), 5e-3, 4.0)
    ((start, stop),) = spans(recorded(np.concatenate([np.full(100, 5e-3), x, np.full(600, x[-1])])))
    assert start == pytest.approx(0.5, abs=0.02)
    assert 2.8 < stop < 4.0  # a second in which friction holds it is the same rig's


def test_two_close_modes_beat_and_yet_decay():
    t = np.arange(7500) / 500.0
    x = np.exp(-0.2 * t) * (5e-3 * np.cos(2 * np.pi * 10 * t) + 3e-3 * np.cos(2 * np.pi * 11.3 * t))
    beating = recorded(x, 500.0)
    ((start, stop),) = spans(beating)
    assert start < 1.0
    assert stop == pytest.approx(15.0, abs=0.1)
    assert [mode.frequency for mode in find_free_motion(beating).modes] == pytest.approx([10.0, 11.3], rel=1e-4)
    assert find_free_motion(recorded(RINGING)).modes == ()


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_velocity_and_acceleration_after_rest(quantity):
    order = {"velocity": 1, "acceleration": 2}[quantity]
    y = RINGING
    for _ in range(order):
        y = np.gradient(y, 1 / FS)
    y = np.concatenate([np.zeros(300), y])
    ((start, stop),) = spans(
        recorded(y, noise=1e-4 * np.max(y), quantity=quantity, unit="m/s" if order == 1 else "m/s2")
    )
    assert 1.5 <= start < 1.75
    assert stop > 9.0


def test_a_known_piece_of_a_decay_is_taken_as_one():
    piece = replace(recorded(RINGING).slice(300, 420), free=True)
    ((start, stop),) = spans(piece)
    assert (start, stop) == (0.0, pytest.approx(0.6))


# --- hammer


MASS, HITS, WIDTH = 0.8, (0.5, 4.5, 8.5), 0.02


def struck(offset=0.0, noise=0.05, twice=False, rail=np.inf):
    """A linear rig hit three times, its ringing in closed form of convolution."""
    n = round(12.5 * FS * 5)
    t = np.arange(n) / (FS * 5)
    hits = [*zip(HITS, (60.0, 40.0, 80.0), strict=True), *([(4.75, 25.0)] if twice else [])]
    force = np.zeros(n)
    for at, peak in hits:
        on = (t >= at) & (t < at + WIDTH)
        force[on] += peak * np.sin(np.pi * (t[on] - at) / WIDTH) ** 2
    answer = np.exp(-0.05 * W * t) * np.sin(W * t) / (MASS * W)
    x = np.convolve(force, answer)[:n] / (FS * 5)
    random = np.random.default_rng(1)
    measured = np.minimum(force, rail) + offset + noise * random.standard_normal(n) * (force < rail)
    return Recording("hits", FS * 5, x + 1e-6 * random.standard_normal(n), measured)


@pytest.mark.parametrize("offset", [0.0, 1.5, -1.5])
def test_each_blow_is_found_and_the_ringing_after_it(offset):
    motion = find_free_motion(struck(offset))
    assert [blow.start / 1000 for blow in motion.blows] == pytest.approx(HITS, abs=0.004)
    assert [decay.start for decay in motion.decays] == [blow.stop for blow in motion.blows]
    assert [blow.stop / 1000 for blow in motion.blows] == pytest.approx([at + WIDTH for at in HITS], abs=0.004)
    assert motion.notes == ()


def test_a_double_hit_is_told():
    motion = find_free_motion(struck(twice=True))
    assert [blow.contacts for blow in motion.blows] == [1, 2, 1]
    (note,) = motion.notes
    assert "more than once at 4.5" in note


def test_blows_go_with_what_they_set_going_and_their_zero_is_the_sensors():
    recording = struck(offset=1.5)
    (segment,) = cut([recording], W)  # each strikes what still rings
    assert segment.rests
    assert segment.force is not None
    assert segment.coarse_force is segment.force  # a contact is shorter than the motion's pieces
    pushed = np.sum(segment.force.pieces[:, 0]) * segment.dt / segment.force.fine
    assert pushed == pytest.approx(0.5 * WIDTH * (60.0 + 40.0 + 80.0), rel=0.005)
    noisy = segment.force.disturbed(1.0, np.random.default_rng(2), segment.dt)
    changed = np.any(noisy.pieces != segment.force.pieces, axis=1)
    assert 0 < np.mean(changed) < 0.1  # in the air its noise is no force


def test_a_model_from_blows_is_valid_where_it_rang_and_not_as_far_as_the_blow_reaches():
    identification = identify([struck()])
    covered = identification.oscillator.frequency
    assert covered is not None
    assert 0.5 * W < 2 * np.pi * covered.min <= 2 * np.pi * covered.max < 2 * W
    mass = identification.oscillator.parameters()["mass"]
    assert abs(mass.value - MASS) < 4 * mass.std < 0.02 * MASS


def test_a_clipped_blow_is_left_out_and_its_ringing_used():
    recording = struck(rail=70.0)
    motion = find_free_motion(recording)
    assert [blow.clipped for blow in motion.blows] == [False, False, True]
    assert "s is clipped" in motion.notes[0]
    assert [segment.force is not None for segment in cut([recording], W)] == [True, False]


def test_where_the_response_goes_against_its_blows_the_ringing_alone_is_used():
    """A sensor turned round: all but the mass is known as if it were not."""
    right = struck()
    turned = replace(right, response=-np.asarray(right.response))
    motion = find_free_motion(turned)
    assert [blow.answered for blow in motion.blows] == [False] * 3
    assert all(blow.answered for blow in find_free_motion(right).blows)
    assert "--calibration response=-1" in motion.notes[0]
    assert all(segment.force is None for segment in cut([turned], W))
    found = identify([turned])
    assert found.oscillator.mass is None
    assert "goes against" in " ".join(found.notes)
    assert found.oscillator.omega0.value == pytest.approx(W * np.hypot(1.0, 0.05), rel=1e-4)
    assert found.oscillator.viscous.value == pytest.approx(0.1 * W, rel=1e-2)


def test_a_drive_in_pulses_is_no_hammer():
    t = np.arange(10000) / 1000.0
    force = np.where(np.mod(t, 0.21) < 0.02, 10.0, 0.0)
    x = np.convolve(force, np.exp(-1.5 * t) * np.sin(W * t))[: t.size] / (1000 * MASS * W)
    assert find_free_motion(Recording("pulses", 1000.0, x, force)).blows == ()


@pytest.mark.parametrize("offset", [0.0, -0.04])
@pytest.mark.parametrize("cycles", [2.2, 3.3])
def test_a_decay_of_few_cycles_gives_a_frequency_and_a_damping_with_their_errors(cycles, offset):
    """A wheel on a rate gyro: the recording was stopped after three swings."""
    omega, viscous, fs = 2 * np.pi * 0.7, 0.06, 500.0
    t = np.arange(round(cycles / 0.7 * fs)) / fs
    speed = solve_ivp(
        lambda _, y: (y[1], -(omega**2) * y[0] - viscous * y[1]),
        (0, t[-1]),
        (0.0, 0.65),
        t_eval=t,
        rtol=1e-10,
        atol=1e-12,
    ).y[1]
    noisy = speed + offset + 7e-3 * np.random.default_rng(3).standard_normal(t.size)
    wheel = Recording("wheel", fs, noisy, quantity="velocity", unit="rad/s")
    assert not [problem for problem in check(wheel) if problem.severity == "error"]
    identification = identify([wheel])
    (only,) = identification.fit.segments
    assert only.segment.n == t.size
    assert only.nrmse < 0.02
    model = identification.oscillator
    spread = 4 * np.hypot(model.omega0.std, 1e-6)
    assert abs(model.omega0.value - omega) < spread
    assert abs(model.viscous.value - viscous) < 4 * model.viscous.std
    assert model.omega0.std < 0.2 * omega


@pytest.mark.parametrize("zeta", [0.06, 0.2])
@pytest.mark.parametrize("cycles", [2.15, 3.2])
def test_a_hand_that_stops_a_swing_at_once_is_not_in_the_decay(cycles, zeta):
    """Within half a cycle: the envelope falls on as if the motion were free."""
    t, k = np.arange(700) / 400.0, round(cycles * 80)
    rate, turn = zeta * W, W * np.sqrt(1 - zeta**2)
    x = 5e-3 * np.exp(-rate * t) * (np.cos(turn * t) + rate / turn * np.sin(turn * t))
    s = np.clip((np.arange(700) - k) / 40, 0, 1)
    x = np.where(s > 0, x[k] * (1 - s) ** 3 * (1 + 3 * s), x)
    ((start, stop),) = spans(recorded(np.concatenate([np.full(300, 5e-3), x]), 400.0, 1e-6))
    assert start == pytest.approx(0.75, abs=0.02)
    assert stop == pytest.approx(0.75 + k / 400, abs=0.02)

"""Free pieces that the modes of one rig explain: linear motion of known truth, and what is no free motion."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.motion.free_motion import modes_of_response, periods_of
from dashpot.identify.motion.shared_modes import SharedModes, shared_modes
from dashpot.identify.signals.signals import Signal
from dashpot.recording import Recording

FS = 200.0


def ringing(seconds: float, *modes: tuple[float, float, float]) -> np.ndarray:
    """(n,) let go at rest, of modes (size, Hz, damping ratio)."""
    t, total = np.arange(round(seconds * FS)) / FS, 0.0
    for size, hertz, zeta in modes:
        omega = 2 * np.pi * hertz
        turn = omega * np.sqrt(1 - zeta**2)
        total = total + size * np.exp(-zeta * omega * t) * (np.cos(turn * t) + zeta * omega / turn * np.sin(turn * t))
    return np.asarray(total)


def way(a: float, b: float, seconds: float) -> np.ndarray:
    s = np.linspace(0, 1, round(seconds * FS))
    return a + (b - a) * s**3 * (10 - 15 * s + 6 * s**2)


def found(*parts: np.ndarray, noise: float = 1e-3, drift: float = 0.0) -> SharedModes | None:
    x = np.concatenate(parts)
    x = x + noise * np.random.default_rng(4).standard_normal(x.size) + drift * np.arange(x.size)
    return shared_modes(x, FS, noise, periods_of(x))


@pytest.mark.parametrize("zeta", [0.01, 0.1, 0.3, 0.6])
@pytest.mark.parametrize("cycles", [1.0, 6.0])
def test_releases_begin_and_end_where_they_do(zeta, cycles):
    """Few cycles or many, much damping or little: every release is found, and frequency and fall are right."""
    sizes, seconds = (1.0, -0.7, 0.9), cycles / 1.5
    parts = [p for a in sizes for p in (way(0, a, 0.8), np.full(60, a), ringing(seconds, (a, 1.5, zeta)), np.zeros(5))]
    modes = found(*parts)
    assert modes is not None
    begun = 220 + (225 + round(seconds * FS)) * np.arange(3)
    assert len(modes.pieces) >= 2  # of a cycle with much damping the smallest tells least
    cycle = FS / 1.5
    assert all(np.any((start >= begun) & (start < begun + cycle / 6)) for start, _, _ in modes.pieces)
    assert all(np.min(np.abs(stop - begun - seconds * FS)) < cycle / 6 for _, stop, _ in modes.pieces)
    assert modes.omega == pytest.approx([3 * np.pi], rel=0.01)
    assert modes.rate == pytest.approx(zeta * 3 * np.pi, abs=4 * modes.rate_std)


def test_parts_of_a_cycle_between_a_hand_s_ways_are_found():
    """No piece is a cycle long, and the hand's ways between them are as long: the rig is in what the pieces share."""
    sizes = (1.0, -0.8, 0.6, 0.9)
    rung = [ringing(0.5, (a, 1.5, 0.02)) for a in sizes]
    parts = [p for a, own in zip(sizes, rung, strict=True) for p in (way(0, a, 0.7), np.full(40, a), own)]
    joined = [np.concatenate([part, way(part[-1], 0, 0.6)]) if len(part) == 100 else part for part in parts]
    modes = found(*joined, noise=1e-4)
    assert modes is not None
    begun = 180 + 400 * np.arange(4)
    assert len(modes.pieces) >= 3
    assert all(np.any((start >= begun) & (stop <= begun + 102)) for start, stop, _ in modes.pieces)
    assert modes.omega == pytest.approx([3 * np.pi], rel=2e-3)
    assert modes.rate == pytest.approx(0.06 * np.pi, abs=4 * modes.rate_std)


def test_modes_three_per_cent_apart_are_two_modes_of_each_piece():
    pulled = [ringing(3.0, (a, 1.5, 0.004), (b, 1.545, 0.006)) for a, b in ((1.0, 0.5), (0.8, -0.5), (0.6, 0.4))]
    modes = found(np.full(50, 1.5), pulled[0], np.full(40, 0.3), pulled[1], np.full(40, 1.0), pulled[2])
    assert modes is not None
    assert len(modes.pieces) == 3
    assert modes.omega / (2 * np.pi) == pytest.approx([1.5, 1.545], rel=2e-3)


def test_a_drift_of_the_sensor_is_no_motion():
    modes = found(np.zeros(100), ringing(3.0, (1.0, 1.5, 0.3)), ringing(3.0, (0.8, 1.5, 0.3)), drift=5e-5)
    assert modes is not None
    assert len(modes.pieces) == 2
    assert modes.rate == pytest.approx(0.9 * np.pi, abs=4 * modes.rate_std)


STEADY = np.sin(3 * np.pi * np.arange(2000) / FS)


@pytest.mark.parametrize(
    "x",
    [
        pytest.param(np.zeros(2000), id="noise"),
        pytest.param(STEADY, id="tone"),
        pytest.param(np.exp(0.3 * np.arange(2000) / FS) * STEADY, id="growth"),
        pytest.param(np.concatenate([way(0, 1, 2.0), np.ones(300), way(1, -1, 1.3), np.full(300, -1.0)]), id="hand"),
    ],
)
def test_what_does_not_fall_by_itself_is_no_free_motion(x):
    assert found(x) is None
    with pytest.raises(BadInput, match=r"no free decay that is|grows swing by swing from .* was the force recorded\?"):
        identify(Recording("still", FS, 1e-3 * (x + 1e-3 * np.random.default_rng(4).standard_normal(x.size))))


def test_a_beat_is_no_reason_to_refuse():
    x = np.concatenate([ringing(6.0, (1.0, 10.0, 0.002), (0.8, 10.6, 0.003))] * 2)
    x = x + 1e-3 * np.random.default_rng(5).standard_normal(x.size)
    decays = find_free_motion(Recording("beating", FS, 1e-3 * x)).decays
    assert [(decay.start <= 1200 * k + 4, decay.stop) for k, decay in enumerate(decays)] == [(True, 1199), (True, 2400)]


@pytest.mark.parametrize("times", [(0.4, 1.5, 2.6, 3.7), (0.4, 1.5, 3.3, 4.4)])
def test_plucks_to_a_beat_or_not_are_the_same(times):
    """Each pluck moves the velocity at once: what rings on and what begins are two pieces."""
    x, fs = np.zeros(round(5.4 * 532.48)), 532.48
    for place, size in zip(times, (12.0, 10.8, 9.6, 8.4), strict=True):
        first = round(place * fs)
        t = np.arange(x.size - first) / fs
        x[first:] += size * np.exp(-0.04 * 42 * np.pi * t) * np.cos(42 * np.pi * t)
    x += 0.02 * np.random.default_rng(2).standard_normal(x.size) - 0.93
    decays = find_free_motion(Recording("plucks", fs, x, quantity="acceleration", unit="m/s2")).decays
    assert len(decays) == 4
    assert all(abs(d.start / fs - place) < 0.02 for d, place in zip(decays, times, strict=True))


@pytest.mark.parametrize("zeta", [0.1, 0.35])
def test_the_plain_answer_of_a_held_release_is_right(zeta):
    x = np.concatenate([np.ones(200), ringing(5.0, (1.0, 1.5, zeta))])
    x = x + 1e-3 * np.random.default_rng(1).standard_normal(x.size)
    values = identify(Recording("held", FS, 3e-3 * x)).oscillator.parameters()
    for name, true in (("omega0", 3 * np.pi), ("viscous", 2 * zeta * 3 * np.pi)):
        parameter = values[name]
        assert parameter.std is not None
        assert parameter.value == pytest.approx(true, abs=3.5 * parameter.std)


def test_a_hold_before_few_cycles_is_left_out():
    x = 1e-3 * np.concatenate([np.ones(200), ringing(8.0, (1.0, 0.484, 0.35))])
    (decay,) = find_free_motion(
        Recording("held", FS, x + 1e-6 * np.random.default_rng(6).standard_normal(x.size))
    ).decays
    assert 200 <= decay.start < 230


def test_what_rings_on_behind_a_piece_is_no_release():
    """A sample that is off cuts the ringing in two; the noise behind it is no motion."""
    t = np.arange(4000) / 1000.0
    x = 2e-3 * np.exp(-2.5 * t) * np.cos(80.0 * t) + 1e-4 * np.random.default_rng(4).standard_normal(t.size)
    x[300:306] += 1.5e-3
    found = modes_of_response(Signal(x, 1000.0))
    assert found is not None
    ((start, _, audible),) = found.pieces
    assert start < 320
    assert audible < 2000


@pytest.mark.parametrize(("glide", "fall", "noise"), [(0.02, 0.25, 3e-2), (0.03, 0.4, 3e-3)])
def test_three_cycles_of_a_gliding_frequency_are_one_decay(glide, fall, noise):
    """As a wheel on its spokes turns faster while it comes down: a damped sine explains a part of it."""
    t = np.arange(2300) / 500.0
    x = np.exp(-fall * t) * np.cos(2 * np.pi * (0.6 * t + glide * t**2))
    x += noise * np.random.default_rng(2).standard_normal(t.size)
    found = find_free_motion(Recording("wheel", 500.0, x)).decays
    assert [(decay.start, decay.stop) for decay in found] == [(0, t.size)]


@pytest.mark.parametrize("seed", [0, 1, 4])
def test_the_last_held_sample_before_a_pluck_is_no_mode(seed: int) -> None:
    omega, zeta, noise, n = 2 * np.pi / 25, 0.04, 0.2, 700
    x = noise * np.random.default_rng(seed).standard_normal(n)
    for begun, stop, size in ((60, 325, 100.0), (331, n, 70.0)):
        t = np.arange(stop - begun) + 0.3
        x[begun:stop] += size * np.exp(-zeta * omega * t) * np.cos(omega * np.sqrt(1 - zeta**2) * t)
    shared = shared_modes(x, 1.0, noise, [25.0])
    assert shared is not None
    assert shared.omega == pytest.approx([omega], rel=1e-4)
    assert shared.zeta == pytest.approx([zeta], rel=2e-3)
    assert [60 <= start <= 62 or 331 <= start <= 333 for start, _, _ in shared.pieces] == [True, True]


def test_a_fall_that_drag_bends_is_not_two_modes():
    """Two exponentials of one frequency follow it nearly to the noise; two modes at different ones stay two."""
    fs, t = 400.0, np.arange(2000) / 400.0
    noise = 1e-3 * np.random.default_rng(4).standard_normal(t.size)
    bent = 2 * np.exp(-0.5 * t) / (1 + 0.6 * (1 - np.exp(-0.5 * t))) * np.cos(16 * np.pi * t) + noise
    assert find_free_motion(Recording("drag", fs, bent, None)).modes == ()
    near = np.exp(-0.5 * t) * np.cos(16 * np.pi * t) + 0.2 * np.exp(-1.5 * t) * np.cos(16.3 * np.pi * t) + noise
    assert len(find_free_motion(Recording("two", fs, near, None)).modes) == 2

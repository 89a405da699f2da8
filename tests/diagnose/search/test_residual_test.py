"""What is left over: noise of any colour is none of it physics, what moves with the rig is."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search import residual_test as module
from dashpot.diagnose.search.residual_test import Leftover, _reached, expected, in_step, leftovers, sentence
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.segments import Segment
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator
from dashpot.model.law import Scales
from dashpot.simulate.force import straight_lines
from scipy.signal import lfilter
from scipy.stats import chi2

MODEL = Oscillator.from_values(TRUTH)
OMEGA = TRUTH["omega0"]
PER_CYCLE = 40
DT = 2 * np.pi / OMEGA / PER_CYCLE
NOISE = 1e-5


def motion_of(cycles, size=1e-3):
    """A motion that swells twice from a tenth to its size, and its phase."""
    turn = 2 * np.pi * np.arange(round(cycles * PER_CYCLE)) / PER_CYCLE
    swell = 0.55 - 0.45 * np.cos(4 * np.pi * np.arange(turn.size) / turn.size)
    return size * swell * np.cos(turn + 0.2), turn + 0.2


def left_by(*pairs, sensor=NOISE, driven=False, force_noise=0.0, begin=0.0):
    """What is left where a simulation shows each motion and the recording that plus a residual."""
    segments = tuple(
        Segment(
            i,
            0,
            y.size,
            y + np.where(np.isfinite(r), r, 0.0),
            straight_lines(np.cos(y), DT) if driven else None,
            DT,
            begin,
            OMEGA,
        )
        for i, (y, r) in enumerate(pairs)
    )
    recordings = tuple(SimpleNamespace(name=f"run{i}") for i in range(len(pairs)))
    scales = Scales(length=1e-3, omega=OMEGA, force=1.0, response=1e-3, duration=1.0, mass=0.27, lines=())
    count = len(pairs)
    data = Data(recordings, segments, (sensor,) * count, (force_noise,) * count, scales)  # type: ignore[arg-type]
    fit = Fitted(MODEL, np.zeros((count, 2)), tuple(r for _, r in pairs), 0.0, ())
    return fit, data


def white(n, seed=0):
    return NOISE * np.random.default_rng(seed).standard_normal(n)


# --- what is more than noise


def left(ratio, *, motion=0.0, step=0.0, burst=None, short=False):
    return Leftover("run", ratio, motion, step, burst, short)


@pytest.mark.parametrize("sign", [{"motion": 0.3}, {"step": 0.06}, {"burst": 0.0}])
def test_a_mismatch_exceeds_the_noise_by_a_tenth_and_moves_with_the_rig(sign):
    assert left(1.11, **sign).is_mismatch
    assert not left(1.09, **sign).is_mismatch
    assert not left(50.0).is_mismatch


def test_a_short_stretch_is_judged_by_its_size_alone():
    assert left(10.1, short=True).is_mismatch
    assert left(np.nan, short=True).is_mismatch
    assert not left(9.9, short=True).is_mismatch
    assert left(9.9, step=1.0, short=True).is_mismatch  # it shows all the same


# --- windows of six cycles


@pytest.mark.parametrize(("cycles", "short"), [(11.9, True), (12.1, False), (35.9, False), (36.1, False)])
def test_six_windows_of_two_cycles_are_the_fewest(cycles, short):
    motion, _ = motion_of(cycles)
    (leftover,) = leftovers(*left_by((motion, white(motion.size))))
    assert leftover.short == short
    assert not leftover.is_mismatch


@pytest.mark.parametrize(("per_cycle", "n", "width"), [(2.0, 25, 4), (0.5, 32, 4), (1.0, 36, 6)])
def test_a_window_has_four_samples_at_least(per_cycle, n, width):
    """Of fewer no power can be told; a recording that coarse says little else."""
    fit, data = left_by((np.cos(np.arange(n) * 1.0), np.where(np.arange(n) == 9, 50 * NOISE, white(n))))
    coarse = replace(data.segments[0], dt=2 * np.pi / OMEGA / per_cycle)
    (leftover,) = leftovers(fit, replace(data, segments=(coarse,)))
    assert leftover.burst_s == pytest.approx((9 // width + 0.5) * width * coarse.dt)


@pytest.mark.parametrize(("cycles", "width"), [(35.0, 2.0), (37.0, 6.0), (120.0, 6.0)])
def test_a_burst_is_placed_in_the_middle_of_its_window(cycles, width):
    motion, _ = motion_of(cycles)
    residual = white(motion.size)
    place = 14.5  # cycles
    here = slice(round(place * PER_CYCLE), round((place + 1) * PER_CYCLE))
    residual[here] += 40 * NOISE
    (leftover,) = leftovers(*left_by((motion, residual), begin=3.0))
    middle = (np.floor(place / width) + 0.5) * width * 2 * np.pi / OMEGA
    assert leftover.burst_s == pytest.approx(3.0 + middle, rel=1e-9)
    assert leftover.span == pytest.approx((3.0, 3.0 + motion.size * DT))
    assert leftover.is_mismatch


@pytest.mark.parametrize(("times", "bursts"), [(27.0, False), (33.0, True)])
def test_a_burst_has_thirty_times_the_usual_power(times, bursts):
    motion, _ = motion_of(120)
    residual = np.sign(white(motion.size)) * NOISE  # all windows alike but for one
    residual[480:720] *= np.sqrt(times)
    (leftover,) = leftovers(*left_by((motion, residual)))
    assert (leftover.burst_s is not None) == bursts


def test_the_ratio_is_rms_over_that_of_the_noise():
    motion, _ = motion_of(60)
    residual = np.sign(white(motion.size)) * 3 * NOISE
    assert leftovers(*left_by((motion, residual)))[0].ratio == pytest.approx(3.0)


def test_noise_of_the_force_is_expected_through_the_resonance():
    motion, _ = motion_of(60)
    quiet = left_by((motion, white(motion.size)), driven=True)
    loud = left_by((motion, white(motion.size)), driven=True, force_noise=0.05)
    assert expected(*quiet, 0) == pytest.approx(NOISE)
    assert expected(*loud, 0) > 2 * NOISE
    assert expected(*left_by((motion, white(motion.size)), force_noise=0.05), 0) == pytest.approx(NOISE)  # a decay
    assert leftovers(*loud)[0].ratio == pytest.approx(leftovers(*quiet)[0].ratio * NOISE / expected(*loud, 0))


def test_power_that_grows_with_the_motion_is_a_mismatch():
    motion, _ = motion_of(120)
    random = np.random.default_rng(1)
    swell = np.abs(0.55 - 0.45 * np.cos(4 * np.pi * np.arange(motion.size) / motion.size))
    growing = 3 * NOISE * swell * random.standard_normal(motion.size)  # keeps step with nothing
    (leftover,) = leftovers(*left_by((motion, growing)))
    assert leftover.with_motion > 0.7
    assert leftover.in_step == 0.0
    falling = 3 * NOISE * (1.1 - swell) * random.standard_normal(motion.size)
    assert leftovers(*left_by((motion, falling)))[0].with_motion == 0.0


def test_a_rank_correlation_by_chance_once_in_two_thousand_counts_for_none():
    """Ten windows in perfect order are one in 3.6 million; with three pairs of neighbours exchanged it is still clear,
    with the halves exchanged it is not."""
    windows = np.arange(10)
    motion = np.concatenate([(1 + k) * np.cos(2 * np.pi * np.arange(240) / PER_CYCLE) for k in windows]) * 1e-4
    signs = np.sign(white(2400))
    for order, significant in (([1, 0, 3, 2, 5, 4, 6, 7, 8, 9], True), ([3, 1, 0, 6, 2, 4, 9, 5, 7, 8], False)):
        residual = np.concatenate([(20 + k) * np.ones(240) for k in order]) * signs * 1e-6
        (leftover,) = leftovers(*left_by((motion, residual)))
        assert (leftover.with_motion > 0) == significant


def test_a_motion_or_a_residual_of_one_size_grows_with_nothing():
    steady = 1e-3 * np.cos(2 * np.pi * np.arange(4800) / PER_CYCLE)
    random = np.random.default_rng(0)
    swelling, _ = motion_of(120)
    assert leftovers(*left_by((np.zeros(4800), white(4800))))[0].with_motion == 0.0
    assert leftovers(*left_by((steady, NOISE * random.standard_normal(4800))))[0].with_motion == 0.0
    assert leftovers(*left_by((swelling, np.tile([NOISE, -NOISE], 2400))))[0].with_motion == 0.0


@pytest.mark.parametrize("value", [np.inf, np.nan])
def test_what_does_not_simulate_is_a_mismatch(value):
    motion, _ = motion_of(60)
    residual = white(motion.size)
    residual[-1] = value
    (leftover,) = leftovers(*left_by((motion, residual)))
    assert leftover.with_motion == 1.0
    assert not leftover.short
    short, _ = motion_of(5)
    (leftover,) = leftovers(*left_by((short, np.full(short.size, value))))
    assert leftover.short
    assert leftover.is_mismatch


# --- in step with the motion


@pytest.mark.parametrize("order", range(1, 6))
def test_what_repeats_with_the_cycles_is_in_step(order):
    motion, turn = motion_of(120)
    amplitude = np.abs(motion / np.cos(turn))
    for residual in (np.cos(order * turn + 0.7), amplitude * np.cos(order * turn + 0.7)):
        assert in_step(motion + 1e-2, residual + 1e-9)[0] == pytest.approx(1.0, abs=0.02)


def test_beyond_the_fifth_harmonic_nothing_is_looked_for():
    motion, turn = motion_of(120)
    assert in_step(motion, np.cos(6 * turn))[0] == 0.0
    assert in_step(motion, np.cos(2.5 * turn))[0] == 0.0


@pytest.mark.parametrize(("part", "seen"), [(0.04, False), (0.06, True)])
def test_a_twentieth_of_the_power_is_the_least(part, seen):
    motion, turn = motion_of(800)
    residual = np.sqrt(2 * part) * np.cos(3 * turn) + np.sqrt(1 - part) * white(turn.size) / NOISE
    share = in_step(motion, residual)[0]
    assert share == pytest.approx(part, abs=0.01) if seen else share == 0.0


def test_a_short_record_has_as_much_by_chance():
    """Of 200 samples twenty columns take a tenth: a share of a tenth says nothing there."""
    motion, turn = motion_of(5)
    for seed in range(20):
        assert in_step(motion, white(turn.size, seed))[0] == 0.0
    motion, turn = motion_of(60)
    assert in_step(motion, np.cos(2 * turn) + 0.3 * white(turn.size) / NOISE)[0] > 0.7


def test_noise_keeps_step_with_nothing():
    motion, _ = motion_of(60)
    random = np.random.default_rng(8)
    for _ in range(40):
        assert in_step(motion, random.standard_normal(motion.size))[0] == 0.0
        assert in_step(motion, coloured(random, motion.size))[0] == 0.0


def test_noise_along_one_direction_reaches_the_limit_once_in_two_thousand():
    """The worst that a spectrum can do: all its power lies along one of the directions (chi-square of one degree)."""
    assert 1 / 2500 < chi2.sf(_reached(np.array([1.0])), 1) < 1 / 2000


@pytest.mark.parametrize(("by_chance", "short"), [(0.49, False), (0.51, True)])
def test_where_noise_may_have_half_of_it_keeping_step_tells_nothing(monkeypatch, by_chance, short):
    monkeypatch.setattr(module, "in_step", lambda *_: (0.0, 0, by_chance))
    (left,) = leftovers(*left_by((motion_of(60)[0], white(60 * PER_CYCLE))))
    assert left.short is short


def test_nothing_is_in_step_with_nothing():
    motion, turn = motion_of(20)
    assert in_step(motion, np.zeros(turn.size))[0] == 0.0
    assert in_step(np.full(turn.size, 2.0), np.cos(turn))[0] == 0.0


def test_noise_of_any_colour_is_no_mismatch():
    random = np.random.default_rng(3)
    for noise in (coloured, stepped):
        pairs = [(motion_of(cycles)[0], 5 * NOISE * noise(random, cycles * PER_CYCLE)) for cycles in (60, 200)]
        remaining = leftovers(*left_by(*pairs))
        assert max(leftover.ratio for leftover in remaining) > 2
        assert sentence(remaining) is None


def test_the_part_of_the_motion_that_is_left():
    motion, _ = motion_of(60)
    residual = np.sign(white(motion.size)) * 3 * NOISE
    (leftover,) = leftovers(*left_by((motion, residual)))
    assert leftover.part == pytest.approx(3 * NOISE / np.std(motion + residual))
    (short,) = leftovers(*left_by((motion[:200], residual[:200])))
    assert short.short
    assert short.part == pytest.approx(3 * NOISE / np.std((motion + residual)[:200]))


@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_the_strongest_order_of_what_keeps_step(order):
    motion, turn = motion_of(60)
    swell = 0.55 - 0.45 * np.cos(4 * np.pi * np.arange(turn.size) / turn.size)
    residual = 1e-4 * (swell * np.cos(order * turn) + 0.4 * np.cos(4 * turn))
    assert in_step(motion, residual + white(turn.size))[1] == order
    assert in_step(motion, white(turn.size))[:2] == (0.0, 0)


def coloured(random, n):
    return lfilter([1.0], [1.0, -0.95], random.standard_normal(n))


def stepped(random, n):
    return np.round(random.standard_normal(n)) * 1.0


# --- the same on a whole rig, identified


@pytest.fixture(scope="module")
def fitted(rig):
    case = rig("none")
    data = data_of(case.training, case.model)
    return data, Structure(case.model, data).fit(settle=True)


def with_residuals(data, fit, residuals):
    """The same simulation of recordings that leave these residuals."""
    segments = [
        replace(s, response=s.response - old + new)
        for s, old, new in zip(data.segments, fit.residuals, residuals, strict=True)
    ]
    return replace(fit, residuals=tuple(residuals)), replace(data, segments=tuple(segments))


@pytest.mark.parametrize("noise", [coloured, stepped])
def test_noise_of_any_colour_is_no_mismatch_of_a_rig(fitted, noise):
    data, fit = fitted
    random = np.random.default_rng(3)
    residuals = tuple(5 * np.std(r) * noise(random, r.size) for r in fit.residuals)
    left = leftovers(*with_residuals(data, fit, residuals))
    assert max(leftover.ratio for leftover in left) > 2
    assert sentence(left) is None


def test_what_grows_with_the_motion_is_a_mismatch_of_a_rig(fitted):
    data, fit = fitted
    residuals = tuple(
        r + 0.02 * (segment.response - r) for r, segment in zip(fit.residuals, data.segments, strict=True)
    )
    said = sentence(leftovers(replace(fit, residuals=residuals), data))
    assert said is not None
    assert "growing with the motion" in said


def test_what_keeps_step_with_a_rig_is_a_mismatch_however_large_the_motion_is(fitted):
    data, fit = fitted
    residuals = []
    for segment, r in zip(data.segments, fit.residuals, strict=True):
        speed = np.gradient(segment.response - r)
        residuals.append(r + 1.5 * np.std(r) * np.sign(speed))  # as of play in the sensor
    left = leftovers(*with_residuals(data, fit, residuals))
    assert all(leftover.in_step > 0.3 and leftover.is_mismatch for leftover in left)
    assert "in step with the motion" in (sentence(left) or "") or any(leftover.with_motion for leftover in left)


def test_noise_keeps_step_with_no_rig(fitted):
    data, fit = fitted
    random = np.random.default_rng(8)
    for segment, r in zip(data.segments, fit.residuals, strict=True):
        motion = segment.response - r
        for _ in range(20):
            assert in_step(motion, random.standard_normal(r.size))[0] == 0.0
            assert in_step(motion, coloured(random, r.size))[0] == 0.0


def test_a_burst_is_a_mismatch_of_a_rig(fitted):
    data, fit = fitted
    first = fit.residuals[0].copy()
    first[5000:5200] += 50 * np.std(first)
    left = leftovers(replace(fit, residuals=(first, *fit.residuals[1:])), data)
    assert left[0].burst_s == pytest.approx(data.segments[0].time + 5100 * data.segments[0].dt, rel=0.05)


@pytest.mark.parametrize(("cycles", "told"), [(8, False), (400, True)])
def test_a_steady_motion_of_few_cycles_does_not_tell_what_keeps_step(cycles, told):
    """Noise as narrow as the line would repeat with it too."""
    turn = 2 * np.pi * np.arange(cycles * PER_CYCLE) / PER_CYCLE
    amplitude = 1.0 + 0.5 * np.cos(turn / cycles)
    share, _, by_chance = in_step(np.cos(turn), NOISE * amplitude * np.cos(turn + 1.0))
    assert (share > 0.0) is told
    assert (by_chance > 0.5) is not told


def test_what_rings_with_the_rig_is_a_mismatch_also_out_of_step():
    """Unlike in_step's, its phase is lost within a few cycles; unlike noise of another colour, it has a hump."""
    motion, _ = motion_of(300)
    pole = np.exp(complex(-0.02, 1.0) * OMEGA * DT)
    rung = lfilter([1.0], np.poly([pole, pole.conjugate()]).real, white(2 * motion.size, 7))[motion.size :]
    for share, rings in ((0.03, False), (0.5, True)):
        size = NOISE * np.sqrt(share / (1 - share)) / np.std(rung)
        (leftover,) = leftovers(*left_by((motion, white(motion.size, 8) + size * rung), sensor=0.5 * NOISE))
        assert leftover.in_step == leftover.with_motion == 0.0
        assert leftover.burst_s is None
        assert (leftover.resonant > 0) == leftover.is_mismatch == rings
        assert leftover.resonant == pytest.approx(share if rings else 0.0, abs=0.1)
        if rings:
            assert "around the rig's own frequency" in str(sentence([leftover]))


def test_also_in_a_few_cycles_what_rings_is_a_mismatch():
    motion, _ = motion_of(6)
    assert not leftovers(*left_by((motion, 3 * white(motion.size))))[0].is_mismatch
    turn = np.arange(motion.size) * OMEGA * DT
    rung = np.sin(np.pi * turn / turn[-1]) * np.cos(1.05 * turn)  # nothing where the fit begins, and where all has died
    (leftover,) = leftovers(*left_by((motion, white(motion.size) + 8 * NOISE * rung)))
    assert leftover.short
    assert leftover.resonant > 0.5
    assert leftover.is_mismatch

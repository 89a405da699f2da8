from __future__ import annotations

import numpy as np
import pytest
from dashpot.simulate import force as forces
from dashpot.simulate.force import force_between, smooth_force, staircase, straight_lines, upsample
from scipy.interpolate import CubicSpline


def values(force, dt, points=5):
    step = dt / force.fine
    tau = np.arange(points) * step / points
    return (force.pieces @ np.vander(tau, 4, increasing=True).T).ravel(), step / points


def test_straight_lines_pass_through_the_samples():
    samples = np.array([0.0, 1.0, -1.0, 3.0])
    force = straight_lines(samples, 0.5)
    ends = force.pieces @ np.vander([0.5], 4, increasing=True).T
    assert force.pieces[:, 0] == pytest.approx(samples[:-1])
    assert ends.ravel() == pytest.approx(samples[1:])


@pytest.mark.parametrize(("per_cycle", "limit"), [(77, 1e-6), (30, 2e-5), (9, 1e-3)])
def test_a_sine_is_restored_between_its_samples(per_cycle, limit):
    dt, n = 1e-3, 3000
    frequency = 1 / (per_cycle * dt)
    force = smooth_force(np.sin(2 * np.pi * frequency * np.arange(n) * dt), dt, frequency)
    restored, spacing = values(force, dt)
    inner = slice(restored.size // 4, -restored.size // 4)
    error = restored - np.sin(2 * np.pi * frequency * np.arange(restored.size) * spacing)
    assert np.max(np.abs(error[inner])) < limit


def test_up_sampling_keeps_the_samples_and_their_number():
    samples = np.random.default_rng(0).standard_normal(400)
    fine = upsample(samples, 4)
    assert fine.size == 399 * 4 + 1
    assert fine[::4][50:-50] == pytest.approx(samples[50:-50], abs=1e-9)


def test_disturbing_a_force_moves_its_samples_by_the_stated_noise():
    force = straight_lines(np.zeros(20_000), 1e-3)
    noisy = force.disturbed(0.3, np.random.default_rng(1), 1e-3)
    assert np.std(noisy.pieces[:, 0]) == pytest.approx(0.3, rel=0.03)
    ends = noisy.pieces[:-1, 0] + noisy.pieces[:-1, 1] * 1e-3
    assert ends == pytest.approx(noisy.pieces[1:, 0], abs=1e-12)


def test_a_held_force_stays_until_the_next_sample():
    samples = np.array([0.0, 1.0, -1.0, 3.0])
    force = staircase(samples)
    assert force.pieces[:, 0] == pytest.approx(samples)  # the last one too: it acts at the last sample
    assert not np.any(force.pieces[:, 1:])


@pytest.mark.parametrize("hold", ["zero", "linear", "smooth"])
def test_every_hold_passes_through_the_samples_and_parts_keep_it(hold):
    samples = np.sin(np.arange(400) / 7.0)
    force = force_between(samples, 1e-3, hold, 1.0)
    assert force.hold == hold
    assert force.pieces[:: force.fine, 0][:399] == pytest.approx(samples[:399], abs=1e-12)
    part = force.part(100, 200)
    assert part.hold == hold
    assert part.pieces[: 99 * part.fine] == pytest.approx(force.pieces[100 * force.fine : 199 * force.fine])


def test_noise_on_a_held_force_is_held():
    noisy = staircase(np.zeros(20_000)).disturbed(0.3, np.random.default_rng(1), 1e-3)
    assert np.std(noisy.pieces[:, 0]) == pytest.approx(0.3, rel=0.03)
    assert not np.any(noisy.pieces[:, 1:])
    assert noisy.hold == "zero"


@pytest.mark.parametrize(("times", "fine"), [(3, 2), (2, 3), (6, 1), (4, 2), (1, 6)])
def test_a_coarser_force_has_the_values_and_slopes_of_the_finer(times, fine):
    dt, n = 1e-2, 500
    force = smooth_force(np.sin(2 * np.pi * 2.0 * np.arange(n) * dt), dt, 20.0)  # six pieces a sample
    assert force.fine == 6
    coarse = force.coarser(times, dt)
    assert coarse.fine == fine
    assert coarse.pieces.shape[0] == (n - 1) * fine
    assert coarse.pieces[:, :2] == pytest.approx(force.pieces[:: 6 // fine, :2])
    ends = coarse.pieces @ (dt / fine) ** np.arange(4)
    assert ends[:-1] == pytest.approx(coarse.pieces[1:, 0], abs=1e-12)


def test_thirty_samples_a_cycle_are_enough_for_a_coarser_force():
    """Hermite's error: the fourth power of the turn between two points, over 384."""
    dt, n = 1e-3, 3000
    frequency = 1 / (30 * dt)
    force = smooth_force(np.sin(2 * np.pi * frequency * np.arange(n) * dt), dt, 3 * frequency)
    assert force.fine == 3
    restored, spacing = values(force.coarser(3, dt), dt)
    inner = slice(restored.size // 4, -restored.size // 4)
    error = restored - np.sin(2 * np.pi * frequency * np.arange(restored.size) * spacing)
    assert np.max(np.abs(error[inner])) < 2e-5


def test_a_held_force_is_as_coarse_as_it_can_be():
    force = staircase(np.array([0.0, 1.0, -1.0, 3.0]))
    assert force.coarser(3, 0.5) is force


def test_a_long_spline_is_made_in_parts_and_is_one():
    samples = np.cumsum(np.random.default_rng(0).standard_normal(150_001))
    pieces = smooth_force(samples, 1.0, 0.01).pieces
    whole = CubicSpline(np.arange(samples.size), samples).c[::-1].T
    assert np.max(np.abs(pieces - whole)) < 1e-12 * np.max(np.abs(samples))


def test_a_long_force_is_up_sampled_in_parts_and_is_one(monkeypatch):
    samples = np.sin(np.cumsum(0.3 + 0.2 * np.sin(np.arange(150_001) / 3000.0)))  # 13 to 60 samples a cycle
    whole = upsample(samples, 3)
    monkeypatch.setattr(forces, "_LONG", 1000)
    monkeypatch.setattr(forces, "_AT_ONCE", 2**14)
    parts = upsample(samples, 3)
    assert parts[::3] == pytest.approx(samples, abs=1e-12)
    assert np.max(np.abs(parts - whole)[2000:-2000]) < 1e-6

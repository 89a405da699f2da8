"""The most noise that response and force can hold: near what was put on them, and never below."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.signals.signals import noise_levels
from dashpot.identify.signals.unexplained import unexplained
from dashpot.recording.recording import Recording

FS, F0, MASS = 200.0, 4.0, 0.5


def driven(damping, quantity="displacement", *, noise=0.0, force_noise=0.0, n=8000, seed=1):
    """A rig under white force that is held, step by step in closed form, with its sensors' noise."""
    from scipy.linalg import expm

    random = np.random.default_rng(seed)
    omega = 2 * np.pi * F0
    rates = np.zeros((3, 3))
    rates[:2] = [[0.0, 1.0, 0.0], [-(omega**2), -2 * damping * omega, 1.0 / MASS]]
    step = expm(rates / FS)
    force, states = random.standard_normal(n), np.zeros((n, 2))
    for k in range(n - 1):
        states[k + 1] = step[:2, :2] @ states[k] + step[:2, 2] * force[k]
    acceleration = states @ rates[1, :2] + force / MASS
    motion = {"displacement": states[:, 0], "velocity": states[:, 1], "acceleration": acceleration}[quantity]
    size = float(np.std(motion))
    shown = motion + noise * size * random.standard_normal(n)
    recorded = force + force_noise * random.standard_normal(n)
    return Recording("random", FS, shown, recorded, quantity=quantity), size


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
@pytest.mark.parametrize("damping", [0.02, 0.3])
def test_a_random_command_is_no_noise_of_its_sensor(damping, quantity):
    recording, size = driven(damping, quantity, noise=1e-3)
    assert unexplained(recording).response == pytest.approx(1e-3 * size, rel=0.05)
    response, force = noise_levels(recording)
    assert 0.95e-3 * size < response < 1.55e-3 * size  # by itself it may look half as much again
    assert force < 2e-3  # of a force of one


@pytest.mark.parametrize("seed", range(6))
def test_noise_that_is_there_has_room(seed):
    recording, _ = driven(0.1, noise=1e-4, force_noise=0.05, seed=seed)
    assert 0.05 / 1.5 < unexplained(recording).force < 0.2
    assert noise_levels(recording)[1] > 0.05 / 1.5


def test_what_does_not_answer_the_force_bounds_nothing():
    recording, _ = driven(0.1)
    other = Recording("other", FS, np.random.default_rng(9).standard_normal(recording.n), recording.force)
    assert unexplained(other).force == np.inf
    assert unexplained(other).response == pytest.approx(1.0, rel=0.1)


def test_without_a_force_or_with_few_samples_nothing_is_told():
    recording, _ = driven(0.1, n=60)
    for one in (recording, Recording("free", FS, recording.response)):
        assert unexplained(one).response == unexplained(one).force == np.inf

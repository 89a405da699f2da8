"""Modes of short windows, against exact sums of damped modes."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.subspace import poles_of_windows


def window(*modes: tuple[float, float], n: int = 48, constant: float = 0.4) -> np.ndarray:
    t = np.arange(n)
    waves = [np.exp(-zeta * omega * t) * np.cos(omega * np.sqrt(1 - zeta**2) * t + omega) for omega, zeta in modes]
    return np.sum(waves, axis=0) + constant


@pytest.mark.parametrize("modes", [[(0.3, 0.02)], [(0.2, 0.35)], [(0.3, 0.01), (0.5, 0.03)]])
def test_modes_of_a_window_without_noise_are_exact(modes):
    ((omega, zeta),) = poles_of_windows(window(*modes)[None], 1e-9, [0.0])[0]
    assert omega == pytest.approx([mode[0] for mode in modes], rel=1e-5)
    assert zeta == pytest.approx([mode[1] for mode in modes], abs=1e-5)


def test_a_window_across_a_release_and_one_of_noise_show_none():
    released = np.concatenate([np.full(20, 1.4), window((0.3, 0.02), n=28)])
    noise = 1e-3 * np.random.default_rng(1).standard_normal((20, 48))
    assert poles_of_windows(released[None], 1e-3, [0.0]) == [[]]
    assert len(poles_of_windows(noise, 1e-3, [0.0])[0]) <= 2


def test_noise_adds_no_mode():
    windows = window((0.3, 0.02)) + 0.01 * np.random.default_rng(2).standard_normal((50, 48))
    (found,) = poles_of_windows(windows, 0.01, [0.0])
    assert sum(omega.size == 1 for omega, _ in found) >= 45
    assert np.median([omega[0] for omega, _ in found]) == pytest.approx(0.3, rel=1e-3)

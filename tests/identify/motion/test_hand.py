"""A hand's ways: what they leave of a piece, and what that costs, against fits of the same polynomials."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.hand import hand_leaves, to_place, to_state

N = 120


def by_fits(piece: np.ndarray, price: float) -> float:
    """The same by a fit of each polynomial before and after each place."""

    def cost(part: np.ndarray, most: int) -> float:
        at = np.linspace(-1, 1, max(part.size, 2))[: part.size]
        return min(
            float(np.sum((part - np.polynomial.legendre.Legendre.fit(at, part, k - 1)(at)) ** 2)) + k * price
            for k in range(1, min(most, part.size) + 1)
        )

    places = range(1, piece.size)
    stopped = [cost(piece[:k], 6) + cost(piece[k:], 2) for k in places]
    began = [cost(piece[:k], 2) + cost(piece[k:], 6) for k in places]
    return min(cost(piece, 6), min(stopped + began) + 2 * np.log(piece.size))


def way(n: int, size: float) -> np.ndarray:
    s = np.linspace(0, 1, n)
    return np.asarray(size * s**3 * (10 - 15 * s + 6 * s**2))


@pytest.mark.parametrize("held", [0, 50])
@pytest.mark.parametrize("size", [3.0, 1e4])
def test_what_a_hand_leaves_is_the_least_of_all_fits(held, size):
    piece = np.concatenate([np.zeros(held), way(N - held, size)]) + np.random.default_rng(held).standard_normal(N)
    assert hand_leaves(piece) == pytest.approx(by_fits(piece, to_state(piece)), rel=1e-8)


@pytest.mark.parametrize("cycles", [0.5, 0.7])
def test_half_a_cycle_far_above_the_noise_is_no_way_of_a_hand(cycles):
    """A polynomial of six parameters follows half a cycle to 1e-4 of it; three of a damped sine do at less cost."""
    sine = 1e4 * np.cos(2 * np.pi * cycles * np.arange(N) / N + 0.3) + np.random.default_rng(1).standard_normal(N)
    assert hand_leaves(sine) > N + 3 * to_state(sine) + 2 * to_place(N)


def test_part_of_a_hand_s_way_takes_no_more_parameters_than_suffice():
    part = way(8 * N, 1e4)[3 * N : 4 * N] + np.random.default_rng(2).standard_normal(N)
    assert hand_leaves(part) < 1.2 * N + 4 * to_state(part)


def test_a_parameter_costs_what_tells_it():
    assert to_state(np.ones(N)) == pytest.approx(np.log(N))  # no less than one of unit information
    swing = 1e3 * np.sin(np.arange(N))
    assert to_state(10 * swing) == pytest.approx(to_state(swing) + 2 * np.log(10))

"""The noise on a force that leaps: as much as was put on it, and none on an exact command."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.signals.noise_beside_edges import noise_beside_edges
from dashpot.identify.signals.signals import Signal

N = 2000
TIME = np.arange(N)


def steps(dwell: float, levels: int) -> np.ndarray:
    """A command that holds each of some levels, or of any, for about as many samples."""
    random = np.random.default_rng(3)
    edges = np.cumsum(random.uniform(0.4, 1.6, N) * max(dwell, 2.5)).astype(int)
    values = random.uniform(-1, 1, N) if not levels else random.integers(0, levels, N) * 2.0 / (levels - 1) - 1
    return values[np.searchsorted(edges, TIME, side="right")]


def tone(cycle: float, on: int) -> np.ndarray:
    """A sine that is switched on and off every so many samples."""
    return np.where(TIME // on % 2 == 0, np.sin(2 * np.pi * TIME / cycle), 0.0)


FORCES = {
    "two levels": steps(3.0, 2),
    "clocked binary": np.random.default_rng(5).choice([-1.0, 1.0], N),
    "any levels": steps(20.0, 0),
    "one step": np.where(TIME > 700, 1.0, 0.0),
    "bursts of five samples a cycle": tone(5.3, 400),
    "bursts of forty samples a cycle": tone(40.0, 150),
    "sweep": np.sin(2 * np.pi * (TIME / 100.0 + TIME**2 / (2 * N) / 6.0)),
    "saw": TIME / 90.0 % 1.0,
    "constant": np.full(N, 3.0),
}


@pytest.mark.parametrize("name", FORCES)
def test_an_exact_command_has_no_noise(name):
    assert noise_beside_edges(FORCES[name]) < 1e-6


@pytest.mark.parametrize("level", [1e-4, 1e-2])
@pytest.mark.parametrize("name", FORCES)
def test_noise_on_a_force_is_found_beside_its_edges(name, level):
    noisy = Signal(FORCES[name] + level * np.random.default_rng(1).standard_normal(N), 500.0)
    assert noisy.noise == pytest.approx(level, rel=0.12)


def test_noise_while_a_force_is_on_counts_where_it_is_off_exactly():
    noise = np.where(TIME % 1000 < 500, 1e-3, 0.0) * np.random.default_rng(2).standard_normal(N)
    assert noise_beside_edges(tone(30.0, 500) + noise) == pytest.approx(1e-3 / np.sqrt(2), rel=0.15)


def test_white_noise_alone_is_all_noise():
    assert noise_beside_edges(np.random.default_rng(4).standard_normal(N)) == pytest.approx(1.0, rel=0.1)


def test_parts_and_thinned_signals_are_measured_beside_their_edges_too():
    whole = Signal(FORCES["two levels"], 500.0)
    assert whole.noise == whole.part(100, 900).noise == whole.thinned(2).noise == 0.0


def test_few_samples_show_nothing():
    assert noise_beside_edges(np.array([1.0, 2.0, 5.0])) == np.inf

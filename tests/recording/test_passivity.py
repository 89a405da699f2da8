"""Whether a force makes the motion, and with which sign: of linear rigs in closed form and of unrelated signals."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.recording.passivity import driven

FS, N = 200.0, 2400
OMEGA = 2 * np.pi * 8.0
RIG = {"mass": 2.0, "omega0": OMEGA, "cubic": 0.0, "preload": 0.0, "viscous": 0.02 * OMEGA, "dry": 0.0}
QUANTITIES = ["displacement", "velocity", "acceleration"]


def steps(seed: int, dwell: float) -> np.ndarray:
    """(N,) a force of random levels, each for about so many samples."""
    random = np.random.default_rng(seed)
    edges = np.cumsum(random.uniform(0.5, 1.5, N) * dwell).astype(int)
    return random.uniform(-1.0, 1.0, N)[np.searchsorted(edges, np.arange(N), side="right")]


def shown(force: np.ndarray, quantity: str, begin: tuple[float, float] = (0.0, 0.0), **other: float) -> np.ndarray:
    """(N,) what a sensor with noise of a thousandth shows of the rig under a held force."""
    rig = RIG | other
    x, v = (y[:N] for y in integrate_pieces(rig, force[:, None], 1 / FS, *begin))
    spring = rig["omega0"] ** 2 * x + rig["cubic"] * x**3
    acceleration = force / rig["mass"] - spring - rig["viscous"] * v - rig["dry"] * np.sign(v)
    signal = [x, v, acceleration][QUANTITIES.index(quantity)]
    return signal + 1e-3 * np.std(signal) * np.random.default_rng(1).standard_normal(N)


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("dwell", [5.0, 40.0, 700.0])
def test_a_force_in_steps_makes_the_motion_whatever_is_stored_before_and_shown(dwell, quantity):
    force = steps(3, dwell)
    for begin in [(0.0, 0.0), (-2e-3, 0.05)]:
        found = driven(force, shown(force, quantity, begin), FS, 8.0, quantity)
        assert found is not None
        assert found.cosine > 0.0
        assert found.is_related()


def test_a_hardening_spring_with_friction_answers_to_its_force_too():
    force = steps(4, 30.0)
    found = driven(force, shown(force, "velocity", cubic=4e9, dry=0.02), FS, 8.0, "velocity")
    assert found is not None
    assert found.is_related()


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_turned_round_the_force_takes_work_out(quantity):
    force = steps(3, 20.0)
    found = driven(-force, shown(force, quantity), FS, 8.0, quantity)
    assert found is not None
    assert found.cosine < -0.5
    assert not found.is_related()


@pytest.mark.parametrize("seed", range(8))
def test_the_force_of_another_run_is_unrelated(seed):
    found = driven(steps(50 + seed, 30.0), shown(steps(20 + seed, 30.0), "displacement"), FS, 8.0, "displacement")
    assert found is not None
    assert not found.is_related()


@pytest.mark.parametrize(("force", "response"), [(np.zeros(500), np.arange(500.0)), (np.arange(20.0), np.ones(20))])
def test_of_constant_signals_and_of_few_samples_nothing_is_said(force, response):
    assert driven(force, response, FS, 8.0, "displacement") is None

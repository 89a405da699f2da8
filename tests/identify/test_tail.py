"""What a decay says below its noise, and where nothing is to be taken for it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.decays import find_free_motion
from dashpot.identify.tail import with_tails
from dashpot.recording import Recording

FS, N, NOISE = 1000.0, 3500, 1e-5
CLEAN = integrate(TRUTH, np.zeros(N), 1 / FS, 8e-3, 0.0)[0][:N]


def disturbed(clean, force=None, seed=0):
    return Recording("decay", FS, clean + NOISE * np.random.default_rng(seed).standard_normal(clean.size), force)


def ends(recording):
    motion = find_free_motion(recording)
    return [
        (before.stop, after.stop) for before, after in zip(motion.decays, with_tails(recording, motion), strict=True)
    ]


@pytest.mark.parametrize("seed", range(4))
def test_it_goes_on_until_friction_has_ended_the_motion(seed):
    [(before, after)] = ends(disturbed(CLEAN, seed=seed))
    assert np.max(np.abs(CLEAN[before:])) > 2 * NOISE
    assert np.max(np.abs(CLEAN[after:])) < 0.05 * NOISE
    assert after < N  # what lies at rest says nothing


@pytest.mark.parametrize("seed", range(4))
def test_dry_friction_is_known_better_by_it(seed):
    recordings = [disturbed(CLEAN, seed=10 * seed + k) for k in range(2)]
    dry = identify(recordings).oscillator.parameters()["dry"]
    cut = [Recording("cut", FS, r.response[: ends(r)[0][0]]) for r in recordings]
    assert abs(dry.value - TRUTH["dry"]) < 4 * dry.std
    assert dry.std < 0.8 * identify(cut).oscillator.parameters()["dry"].std


def test_what_was_stopped_under_the_noise_has_none():
    """A louder motion of less friction, stopped where it can no longer be seen."""
    values = TRUTH | {"dry": 0.0, "preload": 0.0}
    clean = integrate(values, np.zeros(N), 1 / FS, 8e-3, 0.0)[0][:N]
    [(before, after)] = ends(disturbed(clean))
    assert after > before + 200
    clean[before:] = 0.0
    for seed in range(5):
        [(end, stop)] = ends(disturbed(clean, seed=seed))
        assert stop <= before < end + 100


def test_it_ends_where_something_moves_again():
    again = 2000
    moved = CLEAN.copy()
    moved[again:] = 0.1 * CLEAN[: N - again]
    [(before, after), *_] = ends(disturbed(moved))
    assert before <= after < again


def test_motion_of_the_floor_is_no_noise_to_look_under():
    t = np.arange(N) / FS
    floor = 2e-5 * np.sin(2 * np.pi * 3.1 * t)
    [(before, after)] = ends(disturbed(CLEAN + floor))
    assert after == before


def test_it_ends_where_a_force_comes_on():
    force = np.zeros(2 * N)
    force[:1500] = np.sin(80 * np.arange(1500) / FS)
    x = integrate(TRUTH, force, 1 / FS, 0.0, 0.0)[0][: 2 * N]
    [(before, after), *_] = ends(disturbed(x, force))
    begin = (before + after) // 2
    assert before + 100 < begin < after - 100
    force[begin:] = 5e-2 * np.sin(80 * np.arange(2 * N - begin) / FS)  # the motion shows it only later
    [(before, after), *_] = ends(disturbed(integrate(TRUTH, force, 1 / FS, 0.0, 0.0)[0][: 2 * N], force))
    assert before <= after <= begin

"""The way from prediction to simulation: its stages in figures, and where it ends for an exact rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify.fit.from_prediction import (
    from_prediction,
    growing,
    keeps_step,
    keeps_step_throughout,
    memories,
    simulates,
)
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.segments import Segment
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator, Response
from dashpot.recording import Recording
from dashpot.simulate.force import straight_lines

W, PER_CYCLE = 31.4, 40
DT = 2 * np.pi / W / PER_CYCLE


def decay(cycles, noise=0.0, driven=False):
    """A motion that falls to a hundredth, in closed form."""
    n = cycles * PER_CYCLE
    t = np.arange(n) * DT
    y = np.exp(-np.log(100.0) * t / t[-1]) * np.cos(W * t) + noise * np.random.default_rng(0).standard_normal(n)
    return Segment(0, 0, n, y, straight_lines(np.cos(W * t), DT) if driven else None, DT, 0.0, W)


@pytest.mark.parametrize(
    ("cycles", "expected"), [(5, [1.0]), (8, [1.0]), (9, [1.0, 8.0]), (65, [1.0, 8.0, 64.0]), (60, [1.0, 8.0])]
)
def test_memories_go_from_a_cycle_to_the_longest_segment(cycles, expected):
    assert memories([decay(5), decay(cycles)]) == expected


def test_free_decays_grow_and_what_is_driven_is_whole():
    stages = growing([decay(100), decay(20), decay(100, driven=True)])
    assert [[round(s.n / PER_CYCLE) for s in stage] for stage in stages] == [
        [12, 12, 100],
        [48, 20, 100],
        [100, 20, 100],
    ]
    assert len(growing([decay(12)])) == 1
    assert len(growing([decay(100, driven=True)])) == 1


@pytest.mark.parametrize(("part", "keeps"), [(0.29, True), (0.31, False), (np.nan, False), (np.inf, False)])
def test_a_simulation_keeps_step_up_to_three_tenths_of_the_motion(part, keeps):
    segment = decay(60)
    residual = np.full(segment.n, part * np.std(segment.response))
    assert keeps_step([segment], [residual]) == keeps
    assert not keeps_step([segment, segment], [residual, np.full(segment.n, np.inf)])
    twice = np.sqrt(2.0) * residual  # all motion together: what one tells well another may tell worse
    assert keeps_step([segment, segment], [np.zeros(segment.n), twice]) == keeps


def test_a_phase_of_three_tenths_is_where_it_ends():
    """The rms of a sine turned by phi over its own is 2 sin(phi / 2)."""
    segment = decay(60)
    t = np.arange(segment.n) * DT
    envelope = np.exp(-np.log(100.0) * t / t[-1])
    for phase, keeps in ((0.25, True), (0.35, False)):
        assert keeps_step([segment], [segment.response - envelope * np.cos(W * t + phase)]) == keeps


def test_a_quiet_end_that_lost_its_phase_is_seen_in_stretches_alone():
    """... unless it is in the noise there."""
    segment, noisy = decay(64), decay(64, noise=0.05)
    late = np.arange(segment.n) > 0.8 * segment.n
    residual = np.where(late, 2 * segment.response, 0.0)
    assert keeps_step([segment], [residual])
    assert not keeps_step_throughout([segment], [residual])
    assert keeps_step_throughout([noisy], [residual])


# --- the search


def problem(recorded, **changed):
    values = TRUTH | changed
    recordings = [replace(recorded(begin=(8e-3, 0.0), seconds=2.0, name="decay"), free=True)]
    model = Oscillator.from_values(values | {"mass": None})
    structure = Structure(model, data_of(recordings, model, coarse=False))
    return structure.problem, structure.state(None)


@pytest.mark.parametrize(("slower", "first"), [(0.85, 0.125), (0.97, 1.0)])
def test_from_far_off_it_ends_in_step_by_way_of_predictions(recorded, slower, first):
    """Over a cycle where that leads, else over a shorter part of one."""
    search, start = problem(recorded, omega0=slower * TRUTH["omega0"], viscous=1.0, cubic=0.0)
    assert not keeps_step(search.segments, search.residuals(start))
    state, rungs, steps = from_prediction(search, start)
    assert keeps_step_throughout(search.segments, search.residuals(state))
    assert list(rungs)[:1] == [first]
    assert steps > 1
    assert state.values == pytest.approx([v for k, v in TRUTH.items() if k != "mass"], rel=0.05)


@pytest.mark.parametrize("hair", [0.0, 1e-7, 2e-7, 3e-7])
def test_no_hair_decides_where_a_large_pendulum_ends(hair):
    """Eq. 17 is a bad model of a pendulum from 2.7 rad: it ends at its best all the same, from the pace at its tip."""
    from scipy.integrate import solve_ivp

    t = np.arange(6000) / 150.0
    motion = solve_ivp(
        lambda _, z: [z[1], -0.06 * z[1] - 30.25 * np.sin(z[0])], (0, t[-1]), [2.7, 0.0], t_eval=t, rtol=1e-9
    ).y[0]
    motion = (1.0 + hair) * motion + 1e-3 * np.random.default_rng(2).standard_normal(t.size)
    decay = Recording("pendulum", 150.0, motion, None, "displacement", "rad", free=True)
    values = {"omega0": 3.3, "cubic": 0.0, "preload": 0.0, "viscous": 0.05, "dry": 0.0}
    model = Oscillator.from_values(values, response=Response("displacement", "rad"))
    structure = Structure(model, data_of([decay], model, coarse=False))
    state, _, _ = from_prediction(structure.problem, structure.state(None))
    (left,) = structure.problem.residuals(state)
    assert np.std(left) < 0.12 * np.std(motion)
    assert state.values[0] == pytest.approx(5.53, rel=0.02)


def test_in_step_from_the_first_no_prediction_is_asked(recorded):
    search, start = problem(recorded)
    state, rungs, _ = from_prediction(search, start)
    assert rungs == {}
    assert keeps_step(search.segments, search.residuals(state))


def test_what_does_not_even_predict_is_refused(recorded):
    search, start = problem(recorded, viscous=-1e6)
    assert not simulates(search, start)
    with pytest.raises(BadInput, match="check signs and units"):
        from_prediction(search, start)

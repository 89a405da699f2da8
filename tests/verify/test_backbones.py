"""Backbones must lie within the band that noise and the model's own errors make, whatever fraction that is."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.replay import Replay
from dashpot.model import Oscillator
from dashpot.verify.backbones import AMPLITUDE_PART, Backbone, Compared, compared
from dashpot.verify.chance import Run
from dashpot.verify.model_inside import twin_of
from dashpot.verify.noise_floor import pieces

NOISE = 1e-5
MODEL = Oscillator.from_values(TRUTH)


def run_of(record, reference):
    """The piece of a decay, the response that a model of it gives taken from another recording without noise."""
    (piece,) = pieces(record)
    response = np.asarray(reference.response)[: piece.recording.n]
    replay = Replay(np.array([8e-3, 0.1]), response)
    twin = twin_of(MODEL, piece.recording, None, replay, 1.0)
    assert twin is not None
    return Run(piece, replay, twin)


def decay(recorded, noise, seed=0, **changed):
    return recorded(TRUTH | changed, begin=(8e-3, 0.1), fs=1000.0, seconds=4.0, noise=noise, seed=seed)


@pytest.mark.parametrize("times", [0.1, 1.0, 10.0])
def test_the_band_is_as_wide_as_the_noise_makes_it_and_holds_a_right_model(recorded, times):
    clean = decay(recorded, 0.0)
    for seed in range(3):
        (pair,) = compared(run_of(decay(recorded, times * NOISE, seed), clean), 0)
        assert pair.recorded.method == "FREEVIB"
        assert pair.over < 1.0
        assert np.median(pair.limit) == pytest.approx(0.006 * times, rel=0.7)


def test_a_frequency_that_is_wrong_by_twice_the_band_is_out_of_it_and_one_by_half_of_it_is_not(recorded):
    record, clean = decay(recorded, NOISE), decay(recorded, 0.0)
    (right,) = compared(run_of(record, clean), 0)
    least = float(np.min(right.limit)) * 2 * np.pi
    (half,) = compared(run_of(record, decay(recorded, 0.0, omega0=TRUTH["omega0"] + 0.2 * least)), 0)
    (twice,) = compared(run_of(record, decay(recorded, 0.0, omega0=TRUTH["omega0"] + 3.0 * least)), 0)
    assert half.over < 1.0 < twice.over
    assert twice.distance[twice.worst] > twice.limit[twice.worst]


def test_backbones_are_compared_from_a_thirtieth_of_the_largest_amplitude(recorded):
    (pair,) = compared(run_of(decay(recorded, 1e-8), decay(recorded, 0.0)), 0)
    largest = max(pair.recorded.amplitude)
    lowest = max(AMPLITUDE_PART * largest, min(pair.recorded.amplitude), min(pair.simulated.amplitude))
    assert pair.amplitude[0] == pytest.approx(lowest)
    assert pair.amplitude[-1] <= largest


def test_where_chance_has_no_backbone_nothing_is_out_of_its_band():
    one = Backbone("FREEVIB", np.array([1.0, 2.0]), np.array([10.0, 11.0]))
    other = Backbone("FREEVIB", np.array([2.0, 1.0]), np.array([13.0, 10.0]))
    grid = np.array([1.0, 1.5, 2.0])
    pair = Compared(one, other, grid, np.full(3, np.inf))
    assert pair.distance == pytest.approx([0.0, 1.0, 2.0])
    assert pair.over == 0.0
    assert Compared(one, other, grid, np.array([1.0, 0.5, 4.0])).worst == 1

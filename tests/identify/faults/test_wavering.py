"""A recorder whose speed goes up and down: what it shows of a response and what it does to a force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.identify.faults.wavering import Wavering
from dashpot.identify.problem.segments import Segment
from dashpot.simulate.force import force_between

N, DT, BEGIN, WAVE = 2000, 0.002, 1.0, 0.5
TIME = BEGIN + np.arange(N) * DT
SIZES = np.array([2e-3, -1e-3])


def motion(t: np.ndarray) -> np.ndarray:
    return np.sin(2 * np.pi * 6.0 * t)


def wavering(t: np.ndarray) -> np.ndarray:
    """Times at which a recorder was that takes them for ``t``."""

    def tone(t: np.ndarray) -> np.ndarray:
        return SIZES[0] * np.sin(2 * np.pi * WAVE * t) + SIZES[1] * np.cos(2 * np.pi * WAVE * t)

    return t + tone(t) - tone(np.array(BEGIN))


def segment() -> Segment:
    force = force_between(motion(wavering(TIME)), DT, "smooth", 60.0)
    return Segment(0, 0, N, motion(wavering(TIME)), force, DT, BEGIN, 2 * np.pi * 6.0)


def test_a_response_is_shown_as_the_recorder_ran():
    shown = Wavering(0, WAVE).shown(motion(TIME), segment(), SIZES)
    inner = slice(20, -20)  # beyond its ends nothing is known of a motion
    np.testing.assert_allclose(shown[inner], motion(wavering(TIME))[inner], atol=1e-5)


def test_the_force_is_meant_as_it_was_at_even_times():
    meant = Wavering(0, WAVE).meant(segment(), SIZES).force
    samples = meant.pieces[:: meant.fine, 0]
    inner = slice(20, samples.size - 20)
    np.testing.assert_allclose(samples[inner], motion(TIME)[: samples.size][inner], atol=1e-4)
    assert np.max(np.abs(motion(wavering(TIME)) - motion(TIME))) > 0.05


def test_a_decay_has_no_force_to_waver():
    free = replace(segment(), force=None)
    assert Wavering(0, WAVE).meant(free, SIZES) is free


def test_kind_size_and_pace_are_told():
    words = Wavering(0, WAVE).in_words(np.array([3e-3, 4e-3]), np.array([1e-5, 1e-5]), "m", "N")
    assert f"{100 * 2 * np.pi * WAVE * 5e-3:.4g} ±" in words
    assert words.startswith("its clock wavers")
    assert words.count(f"{WAVE:.3g} times a second") == pytest.approx(1)

"""What drives the FMU and what is noise: a force where there is one, none where the motion is free."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.signals.signals import noise_levels
from dashpot.model import Oscillator
from dashpot.recording import Recording
from dashpot.verify.noise_floor import floor_of_model, pieces

FS, FREE = 1000.0, 1500
LEVEL = 1e-2


def burst(zero=0.0):
    """A burst and its ringing; the load cell has noise all the way and shows ``zero`` at zero."""
    force = np.zeros((5000, 11))
    force[:FREE] = chirp(1.15, 13.0, 0.0, np.arange(FREE) / FS, 1 / FS)
    x = integrate_pieces(TRUTH, force[:-1], 1 / FS)[0]
    random = np.random.default_rng(1)
    shown = force[:, 0] + zero + LEVEL * random.standard_normal(x.size)
    return Recording(name="burst.csv", fs=FS, response=x + 1e-5 * random.standard_normal(x.size), force=shown)


def test_a_free_decay_is_run_without_the_noise_of_the_force_channel():
    (piece,) = pieces(burst())
    (decay,) = piece.decays
    free = slice(decay.start, decay.stop)
    assert abs(decay.start - FREE) < 20
    assert not np.any(piece.recording.force[free])
    assert not np.any(piece.force[free])
    assert piece.recording.force[: decay.start] == pytest.approx(burst().force[: decay.start])
    assert piece.force[: decay.start] == pytest.approx(LEVEL, rel=0.1)


def test_what_a_model_leaves_has_the_noise_in_it():
    (piece,) = pieces(burst())
    model = Oscillator.from_values(TRUTH)
    floor = floor_of_model(model, piece)
    assert floor > 1.02 * piece.sensor
    assert floor_of_model(model, piece, 0.8 * floor) == floor  # which may be chance
    assert floor_of_model(model, replace(piece, force=30.0 * piece.force), floor) == floor
    assert floor_of_model(model, replace(piece, force=30.0 * piece.force), 0.1 * floor) == piece.sensor


def test_where_the_load_cell_shows_something_at_zero_a_free_decay_keeps_that():
    (piece,) = pieces(burst(zero=0.5))
    (decay,) = piece.decays
    assert piece.recording.force[decay.start : decay.stop] == pytest.approx(0.5, abs=1e-3)
    assert np.ptp(piece.recording.force[decay.start : decay.stop]) == 0.0


def test_a_column_that_holds_only_noise_drives_nothing(recorded):
    decay = recorded(begin=(8e-3, 0.1), noise=1e-5)
    noisy = replace(decay, force=LEVEL * np.random.default_rng(5).standard_normal(decay.n))
    (piece,) = pieces(noisy)
    assert piece.recording.force is None
    assert piece.disturbed(np.random.default_rng(0)) is None


def test_the_noise_of_a_decay_is_that_of_its_whole_recording(recorded):
    decay = recorded(begin=(8e-3, 0.1), fs=1000.0, seconds=5.0, noise=2e-5)
    (piece,) = pieces(decay)
    assert piece.recording.n < 0.6 * decay.n
    assert piece.sensor == noise_levels(decay)[0] == pytest.approx(2e-5, rel=0.05)


def test_a_sweep_is_one_piece_with_noise_on_all_of_its_force(recorded):
    sweep = recorded(sweep=(1.0, 8.0, 18.0), force_noise=LEVEL)
    (piece,) = pieces(sweep)
    assert piece.recording is sweep
    assert piece.force == pytest.approx(LEVEL, rel=0.1)
    again = piece.disturbed(np.random.default_rng(0))
    samples = again.pieces[:: again.fine, 0]
    assert np.std(samples - sweep.force[: samples.size]) == pytest.approx(LEVEL, rel=0.15)


PERIOD, HITS = 0.2, (0.5, 4.5)


def hammered(turned=False, rail=np.inf):
    """Two blows, the second the harder one; the sensor may be turned round, the force cut off at a rail."""
    t = np.arange(9000) / FS
    force = np.zeros(t.size)
    for at, peak in zip(HITS, (40.0, 80.0), strict=True):
        on = (t >= at) & (t < at + 0.02)
        force[on] = peak * np.sin(np.pi * (t[on] - at) / 0.02) ** 2
    ringing = np.exp(-1.5 * t) * np.sin(2 * np.pi / PERIOD * t)
    x = np.convolve(force, ringing)[: t.size] / FS * (-1e-2 if turned else 1e-2)
    random = np.random.default_rng(1)
    shown = np.minimum(force, rail) + LEVEL * random.standard_normal(t.size) * (force < rail)
    return Recording("hits.csv", FS, x + 1e-6 * random.standard_normal(t.size), shown)


def test_blows_that_are_known_are_run_in_one_go():
    (piece,) = pieces(hammered())
    assert piece.recording.n == hammered().n
    assert len(piece.decays) == 2


def test_blows_that_nothing_answers_leave_their_ringing():
    free = pieces(hammered(turned=True))
    assert [piece.recording.force for piece in free] == [None, None]
    assert [piece.recording.start for piece in free] == pytest.approx([at + 0.02 for at in HITS], abs=0.004)


def test_a_clipped_blow_leaves_its_ringing_and_the_other_one_as_it_is():
    first, second = pieces(hammered(rail=70.0))
    assert second.recording.force is None
    assert second.recording.start == pytest.approx(HITS[1] + 0.02, abs=0.004)
    (decay,) = first.decays
    struck = first.recording
    assert struck.start == pytest.approx(HITS[0] - PERIOD / 4, abs=0.006)
    assert struck.start + struck.n / FS < HITS[1]
    assert not np.any(struck.force[decay.start :])
    assert not np.any(first.force[decay.start :])
    assert np.max(struck.force[: decay.start]) == pytest.approx(40.0, rel=0.01)

"""Which recordings can carry a diagnosis, and what is said of the others."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.diagnose.recordings import carries, split, why_unused
from dashpot.errors import BadInput
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.signals.hilbert import noise_level
from dashpot.model import Oscillator, Response
from dashpot.model.terms import with_term
from dashpot.recording import Recording


def noise(n: int, fs: float = 500.0, **more) -> Recording:
    return Recording(name="noise", fs=fs, response=1e-6 * np.random.default_rng(0).standard_normal(n), **more)


def test_a_recording_that_is_too_quiet_is_named(rig):
    model = rig("none").model
    quiet = noise(20000)
    assert not carries(quiet, model)
    assert why_unused(quiet, model).startswith("noise: too quiet")


def test_a_recording_that_is_too_short_is_named(rig):
    case = rig("none")
    few = case.training[0].slice(0, 40)
    assert not carries(few, case.model)
    assert "too short" in why_unused(few, case.model)
    assert "cycles" in why_unused(few, case.model)


def test_a_driven_recording_needs_a_mass(rig):
    case = rig("none")
    free = replace(case.model, mass=None)
    assert carries(case.training[0], case.model)
    assert not carries(case.training[0], free)
    assert "no mass" in why_unused(case.training[0], free)


def test_recordings_of_which_none_can_be_used_are_refused_one_by_one(rig):
    case = rig("none")
    few = replace(case.training[0].slice(0, 40), name="few")
    with pytest.raises(BadInput, match=r"few: too short.*noise: too quiet"):
        diagnose(case.model, [few, noise(20000)], case.holdout)


def test_one_that_cannot_be_used_among_others_is_left_out_and_named(rig):
    case = rig("none")
    diagnosis = diagnose(case.model, [*case.training, noise(20000)], case.holdout)
    assert any("noise: too quiet" in note and "left out" in note for note in diagnosis.notes)
    assert "noise" not in {record.file for record in diagnosis.records}
    assert diagnosis.effects == ()


def test_split_keeps_whole_what_cannot_spare_a_stretch(rig):
    case = rig("none")
    whole = case.training[0]
    training, ends = split([whole], case.model)
    assert [r.n for r in (*training, *ends)] == [whole.n * 2 // 3, whole.n - whole.n * 2 // 3]
    decay = case.training[2]
    training, held = split([decay], case.model)
    assert held
    assert all(piece.free for piece in (*training, *held))
    loudest = [float(np.max(np.abs(piece.response))) for piece in (*training, *held)]
    assert min(loudest[: len(training)]) < min(loudest[len(training) :])  # the quiet end is learnt from
    assert max(loudest[: len(training)]) > max(loudest[len(training) :])
    assert max(loudest[len(training) :]) > 5 * noise_level(decay.response, decay.fs)
    short = replace(whole.slice(0, round(4 * 2 * np.pi / case.model.omega0.value * whole.fs)), name="short")
    assert carries(short, case.model)
    assert split([short], case.model) == ([short], [])


def test_a_pendulum_whose_gravity_is_a_law_of_its_own_is_split_as_one_whose_is_not():
    """What a spring is made of is no matter of how long a recording is against its cycles."""
    t = np.arange(9000) / 150.0
    decay = Recording(name="decay", fs=150.0, response=np.exp(-0.05 * t) * np.cos(5.5 * t), unit="rad", free=True)
    values = {"omega0": 5.5, "cubic": 0.0, "preload": 0.0, "viscous": 0.1, "dry": 0.0}
    whole = Oscillator.from_values(values, response=Response("displacement", "rad"))
    part = Oscillator.from_values(values | {"omega0": 0.1}, response=Response("displacement", "rad"))
    sine = with_term(part, "softening-stiffness/sine", {"stiffness": 5.5**2, "width": 1.0})
    names = [[r.name for r in group] for group in split([decay], sine)]
    assert names == [[r.name for r in group] for group in split([decay], whole)]
    assert len(names[1]) >= 2
    assert carries(decay, sine)


def struck(*hits: float, seconds: float = 8.0) -> Recording:
    """A linear rig of 8 Hz and 0.8 kg, hit at rest and while it rings, its motion in closed form."""
    fs, w, width = 1000.0, 50.0, 0.02
    t = np.arange(round(seconds * fs)) / fs
    force = np.zeros(t.size)
    for at in hits:
        force += 60 * np.sin(np.pi * (t - at) / width) ** 2 * ((t >= at) & (t < at + width))
    x = np.convolve(force, np.exp(-0.5 * t) * np.sin(w * t) / (0.8 * w))[: t.size] / fs
    random = np.random.default_rng(1)
    noises = random.standard_normal((2, t.size))
    return Recording("hit", fs, x + 1e-6 * noises[0], force + 0.02 * noises[1])


@pytest.mark.parametrize("hits", [(0.5,), (0.5, 4.0)])
def test_the_ringing_after_few_blows_is_cut_and_each_blow_is_learnt_from(hits):
    recording = struck(*hits)
    values = {"mass": 0.8, "omega0": 50.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.0, "dry": 0.0}
    training, held = split([recording], Oscillator.from_values(values))
    assert len(held) == 3
    assert all(piece.free and piece.force is None for piece in held)
    forced = [piece for piece in training if not piece.free]
    assert [len(find_free_motion(piece).blows) for piece in forced] == [1] * len(hits)
    assert [piece.start <= at for piece, at in zip(forced, hits, strict=True)] == [True] * len(hits)
    covered = sorted((piece.start, piece.start + piece.n / piece.fs) for piece in (*training, *held))
    assert all(a[1] <= b[0] + 1.5 / recording.fs + 0.5 * 2 * np.pi / 50 for a, b in pairwise(covered))
    loudest = [max(float(np.max(np.abs(piece.response))) for piece in group) for group in (training, held)]
    assert loudest[0] > loudest[1] > 0.5 * loudest[0]


def test_no_blow_is_left_out_whose_ringing_is_too_short_to_be_cut():
    recording = struck(0.5, 7.0)
    values = {"mass": 0.8, "omega0": 50.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.0, "dry": 0.0}
    training, held = split([recording], Oscillator.from_values(values))
    assert sum(len(find_free_motion(piece).blows) for piece in (*training, *held)) == 2


def test_three_blows_are_held_out_whole():
    recording = struck(0.5, 3.0, 5.5)
    values = {"mass": 0.8, "omega0": 50.0, "cubic": 0.0, "preload": 0.0, "viscous": 1.0, "dry": 0.0}
    training, held = split([recording], Oscillator.from_values(values))
    assert [len(find_free_motion(piece).blows) for piece in (*training, *held)] == [1, 1, 1]

"""Blocks that no law explains: decays of a known rig, one of which is knocked amid its motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.diagnose.odd_blocks import odd_blocks, without
from dashpot.diagnose.search.weigh import judged
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.verify.noise_floor import pieces

FS, OMEGA, TOP = 100.0, 2 * math.pi * 2.0, 1e-2
VALUES = {"omega0": OMEGA, "viscous": 0.4, "dry": 0.0, "cubic": 2e5, "preload": 0.0}
TRUE = Oscillator.from_values(VALUES)
LINEAR = Oscillator.from_values(VALUES | {"cubic": 0.0})
CYCLES = 30


def decay(seed: int, start: float, knocks: Sequence[float] = ()) -> Recording:
    """A decay of thirty cycles with a thousandth as noise; each knock adds a third of its speed, at a time in s."""
    core, values = core_of(TRUE), np.array(list(TRUE.values().values()))
    step, n = internal_step(TRUE, TRUE.values(), TOP), round(CYCLES * 2 * math.pi / OMEGA * FS)
    edges = [0, *(round(time * FS) for time in knocks), n]
    x, parts = np.array([start, 0.0]), []
    for a, b in pairwise(edges):
        made = core.record(values, x, None, b - a + 2, 1 / FS, step)
        parts.append(made[: b - a])
        speed = 0.5 * FS * (made[b - a + 1] - made[b - a - 1])
        x = np.array([made[b - a], speed + 0.3 * OMEGA * float(np.max(np.abs(parts[-1][-50:])))])
    noise = 1e-3 * TOP * np.random.default_rng(seed).standard_normal(n)
    return Recording(f"decay {seed}", FS, np.concatenate(parts) + noise)


def found(model: Oscillator, recordings: Sequence[Recording]) -> Any:
    """What a search ends with, as far as it matters here."""
    data = data_of(recordings, model)
    return SimpleNamespace(fitted=judged(model, data), weighing=SimpleNamespace(parts=(data,)))


def three(knocks: Sequence[float] = ()) -> list[Recording]:
    return [decay(1, TOP), decay(2, 0.8 * TOP, knocks), decay(3, 0.9 * TOP)]


@pytest.mark.parametrize("model", [TRUE, LINEAR])
def test_a_knock_is_found_with_its_time_and_nothing_else(model):
    """Also where the model lacks the cubic, which large motion shows in every decay."""
    (block,) = odd_blocks(found(model, three([5.3])))
    assert block.file == "decay 2"
    assert block.begin < 5.3 < block.end
    assert block.end - block.begin < 6 * 2 * math.pi / OMEGA
    assert block.times > 3.0
    assert f"decay 2, {block.begin:.4g} to {block.end:.4g} s" in block.sentence
    assert odd_blocks(found(model, three())) == []


def test_a_rig_that_stands_still_amid_a_recording_has_no_level():
    """What a camera shows of it is not even noise."""
    standing = [decay(k, TOP) for k in range(1, 4)]
    shown = np.array(standing[1].response)
    shown[400:] = 0.0
    rest = Recording("decay 2", FS, shown, free=True)
    assert all(block.file == "decay 2" and block.begin <= 4.0 for block in odd_blocks(found(TRUE, [*standing, rest])))


def test_what_is_wrong_in_many_blocks_is_no_odd_one():
    knocked = [decay(k, TOP, [1.6 + 3.2 * i for i in range(4)]) for k in range(1, 4)]
    assert odd_blocks(found(TRUE, knocked)) == []


def test_the_motion_behind_an_odd_block_begins_anew():
    recordings = three([5.3])
    (block,) = odd_blocks(found(TRUE, recordings))
    parted = without(recordings, [block])
    assert parted[0] is recordings[0]
    assert parted[2] is recordings[2]
    first, last = round(block.begin * FS), round(block.end * FS)
    assert parted[1].unknown == ((first, last),)
    cut = [(s.start, s.stop) for s in data_of(parted, TRUE).segments if s.recording == 1]
    assert cut == [(0, first), (last, parted[1].n)]
    again = found(TRUE, parted)
    assert odd_blocks(again) == []
    assert all(np.sqrt(np.mean(left**2)) < 1.1e-3 * TOP for left in again.fitted.residuals)
    assert [(p.recording.start, p.recording.n) for p in pieces(parted[1])] == [
        (0.0, first),
        (last / FS, cut[1][1] - last),
    ]


def test_a_stretch_of_a_recording_is_found_again_in_it():
    """Where nothing is held out, stretches are, which are named for their recordings."""
    recordings = three([5.3])
    part = recordings[1].slice(100, None)
    stretch = Recording("decay 2, 1 to 15 s", FS, part.response, start=part.start)
    odd = odd_blocks(found(TRUE, [recordings[0], stretch, recordings[2]]))
    (run,) = without(recordings, odd)[1].unknown
    assert run[0] < 530 < run[1]


@pytest.mark.long
def test_a_diagnosis_names_what_is_missing_without_an_odd_block():
    recordings = three([5.3])
    diagnosis = diagnose(LINEAR, recordings[1:], recordings[:1])
    assert "Left out, as no law explains it: decay 2, " in diagnosis.sentence
    assert diagnosis.verdict == "consistent"  # Eq. 17 has the cubic
    assert all(record.nrmse_after < 1.1 * record.noise_floor for record in diagnosis.records)
    assert diagnosis.model.values()["cubic"] == pytest.approx(VALUES["cubic"], rel=0.02)


@pytest.mark.long
def test_an_odd_block_that_time_does_not_allow_to_leave_out_is_stated():
    recordings = three([5.3])
    diagnosis = diagnose(LINEAR, recordings[1:], recordings[:1], seconds=1e-6)
    assert "Left out" not in diagnosis.sentence
    assert any("again without what no law explains (decay 2, " in note for note in diagnosis.notes)

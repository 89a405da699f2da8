"""Decays that go on to where their model meets the noise; not where the mass was caught, or the model is wrong."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem import last_swings
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.descent import search
from dashpot.identify.problem.last_swings import with_last_swings
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.recording import Recording

FS, N, NOISE = 1000.0, 4000, 1e-5
MODEL = Oscillator.from_values(TRUTH)


@cache
def motion():
    return integrate_pieces(dict(TRUTH), np.zeros((N, 2)), 1 / FS, 5e-3)[0][:N]


def lengthened(response, model=MODEL, found_in=None, blank=()):
    """Ends of a decay's segment before and after, in samples; it is found in another recording where that is given."""
    recording = Recording("decay", FS, response, blank=blank)
    data = data_of([recording], model, coarse=False)
    if found_in is not None:
        segment = data_of([Recording("decay", FS, found_in)], model, coarse=False).segments[0]
        data = replace(data, segments=(replace(segment, response=response[segment.start : segment.stop]),))
    structure = Structure(model, data, (), ())
    problem, state = structure.problem, structure.state(None)
    state = search(problem.keeping(state), replace(state, offsets=np.zeros(0))).state
    (after,) = with_last_swings(problem, state, [recording])
    assert np.array_equal(after.response, response[after.start : after.stop])
    if blank:
        assert after.blank is not None
        assert [after.start + int(k) for k in np.flatnonzero(after.blank)] == list(range(*blank[0]))
    return data.segments[0].stop, after.stop


def noise():
    return NOISE * np.random.default_rng(1).standard_normal(N)


def test_a_decay_goes_on_to_where_its_model_meets_the_noise():
    before, after = lengthened(motion() + noise())
    last = int(np.flatnonzero(np.abs(motion()) > 0.5 * NOISE)[-1])
    assert before < last - 40  # more than half a cycle
    assert after == pytest.approx(last, abs=4)


def test_a_decay_with_filled_samples_goes_on_with_them():
    before, after = lengthened(motion() + noise(), blank=((700, 703),))
    assert after > before + 40


def test_a_decay_that_was_caught_ends_there():
    """Held where it was caught, within the noise of the envelope's end or far above it."""
    caught = motion().copy()
    caught[1500:] = 0.0
    before, after = lengthened(caught + noise())
    assert after == before


def test_what_follows_must_be_noise_too():
    quiet = motion() + noise()
    struck, begin = quiet.copy(), lengthened(quiet)[0] + 20
    struck[begin:] += 4e-5 * np.sin(2 * np.pi * 12.7 * np.arange(N - begin) / FS)
    before, after = lengthened(struck, found_in=quiet)
    assert after == before


def test_a_model_that_leaves_more_than_noise_tells_nothing_of_the_last_swings():
    known = MODEL.parameters()
    wrong = MODEL.with_parameters({"viscous": replace(known["viscous"], value=1.02 * known["viscous"].value)})
    before, after = lengthened(motion() + noise(), wrong)
    assert after == before


@pytest.mark.parametrize(("times", "longer"), [(1.02, True), (0.98, False)])
def test_over_its_last_cycle_it_must_have_come_down(times, longer, monkeypatch):
    recording = Recording("decay", FS, motion() + noise())
    segment = data_of([recording], MODEL, coarse=False).segments[0]
    cycle = round(2 * np.pi / segment.pace * FS)
    level = float(np.std(segment.response[-cycle:])) / segment.noise
    assert level < 0.9 * last_swings.BEYOND_ERRORS  # an end at the noise is well below the limit
    monkeypatch.setattr(last_swings, "BEYOND_ERRORS", times * level)
    before, after = lengthened(recording.response)
    assert (after > before) is longer

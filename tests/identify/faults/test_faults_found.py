"""Lies of a measuring chain are named with record, kind, place and size; missing physics and honest records are not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, Lie, Stand, lies, told
from dashpot.examples.measuring_chain import force_gain, hum, late, response_gain, step
from dashpot.identify import identify
from dashpot.identify.faults.fault import Hum
from dashpot.identify.faults.faults_found import FoundFault, _lasts, faults_found
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.model import Oscillator, Response
from dashpot.recording import Recording

SHORT = replace(STANDS["built-in"], cycles=60.0, fs=400.0)


def found(stand: Stand, lie: Lie | None, seed: int = 0, **changed: float) -> list[str]:
    """What is told of recordings from a fit near the truth."""
    recordings = told(stand, lie, seed)
    model = Oscillator.from_values({**stand.values, **changed}, response=Response(stand.quantity, recordings[0].unit))
    fit = maximum_likelihood(model, recordings, tuple(changed), doubted=False, near=True)
    return [fault.sentence for fault in faults_found(fit, recordings)]


@pytest.mark.parametrize(
    ("goes_on", "moved", "lasts"), [(True, 0.0, True), (False, 0.0, False), (False, 1e-2, True)], ids=str
)
def test_hum_goes_on_while_a_rig_rests(goes_on, moved, lasts):
    """A line of the decay alone is none; behind it a hand may move the rig by far more than the line."""
    fs, n, size = 200.0, 2000, 1e-4
    t, random = np.arange(n) / fs, np.random.default_rng(5)
    line = size * np.sin(2 * np.pi * 13.0 * t) * (goes_on | (t < 4.0))
    hand = moved * np.interp(t, np.linspace(4.0, 10.0, 40), random.standard_normal(40), left=0.0)
    recording = Recording("hum", fs, line + hand + 1e-6 * random.standard_normal(n))
    fault = FoundFault(Hum(0, 13.0), (size, 0.0), (1e-6, 1e-6), 50.0, "hum", "")
    fitted = SimpleNamespace(recording=0, start=0, stop=800)
    assert _lasts(fault, [recording], [fitted]) is lasts


@pytest.mark.parametrize(
    ("lie", "figures"),
    [
        (Lie("", "gain", 2, response_gain(0.9, 0.5)), ("from 2.368 s", "0.9 ±")),
        (Lie("", "late", 1, late(0.004)), ("3.998 ±", "ms too late")),
        (Lie("", "hum", 2, hum(50.0, 0.02)), ("50 Hz",)),
    ],
    ids=["gain", "late", "hum"],
)
def test_a_lie_is_named_with_record_kind_place_and_size(lie, figures):
    (sentence,) = found(SHORT, lie)
    assert sentence.startswith(("decay.csv", "weak.csv", "strong.csv")[lie.record])
    assert lie.is_named(sentence)
    for figure in figures:
        assert figure in sentence


def test_a_gain_of_the_first_cycle_holds_throughout_and_a_step_keeps_its_time():
    (gain,) = found(SHORT, Lie("", "gain", 2, response_gain(0.9, 0.002)))
    assert "throughout" in gain
    (stepped,) = found(SHORT, Lie("", "step", 2, step(0.2, 0.002)))
    assert "inf" not in stepped


def test_honest_recordings_get_no_word():
    assert found(SHORT, None, seed=5) == []


def test_where_physics_is_missing_besides_nothing_is_said():
    # with the cubic taken away no fault brings what is left to the noise, though one is there
    lie = Lie("", "gain", 2, response_gain(0.9, 0.5))
    assert found(SHORT, lie)
    assert found(SHORT, lie, cubic=0.0) == []
    assert found(SHORT, None, cubic=0.0) == []


@pytest.mark.parametrize(("part", "named"), [(2e-3, True), (2e-6, False)])
def test_a_line_is_named_where_it_stands_out_beyond_doubt(part, named):
    assert bool(found(SHORT, Lie("", "hum", 2, hum(50.0, part)))) == named


def both(first: Lie, second: Lie) -> list[str]:
    """What is told where both driven records lie."""
    lying = [told(SHORT, lie) for lie in (first, second)]
    recordings = [lying[0][0], lying[0][1], lying[1][2]]
    model = Oscillator.from_values(dict(SHORT.values))
    fit = maximum_likelihood(model, recordings, doubted=False, near=True)
    return sorted(fault.sentence for fault in faults_found(fit, recordings))


def test_one_cause_may_lie_in_several_records():
    sentences = both(Lie("", "hum", 1, hum(50.0, 0.02)), Lie("", "hum", 2, hum(50.0, 0.02)))
    assert [sentence.split(":")[0] for sentence in sentences] == ["strong.csv", "weak.csv"]
    # gains of several sizes soak up what a family lacks as well
    assert both(Lie("", "gain", 1, response_gain(1.1, 0.5)), Lie("", "force gain", 2, force_gain(0.9, 0.5))) == []


@pytest.mark.long
@pytest.mark.parametrize("place", range(0, len(lies(STANDS["built-in"])), 3))
def test_no_lie_leaves_wrong_numbers_without_a_word(place):
    stand = STANDS["built-in"]  # of the others `benchmarks/lies.py` tells
    lie = lies(stand)[place]
    recordings = told(stand, lie)
    try:
        found = identify(recordings, faults=True)
    except BadInput as problem:
        refused = str(problem)  # that is a word
    else:
        refused = None
    if refused is not None:
        assert recordings[lie.record].name in refused
        return
    parameters = found.oscillator.parameters()
    known = {name: p for name, p in parameters.items() if name in stand.values and p.std}  # the rig has no other mode
    off = max(abs(p.value - stand.values[name]) / p.std for name, p in known.items() if p.std)
    name = recordings[lie.record].name
    assert off < 5.0 or any(name in sentence for sentence in (*found.faults, *found.notes))
    for sentence in found.faults:
        assert sentence.startswith(name)
        assert lie.is_named(sentence)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("rig", STANDS)
def test_honest_recordings_are_not_called_liars(rig, seed):
    found = identify(told(STANDS[rig], None, seed), faults=True)
    assert found.faults == ()
    assert [note for note in found.notes if "a measuring chain does" in note or "faults of the measuring chain" in note]
    assert all(np.isfinite(s.over_noise) for s in found.fit.segments)

"""By default recordings that contradict each other are told: the kind where one explains all, else the place."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.lies import STANDS, Lie, of_another_rig, told
from dashpot.examples.measuring_chain import clipped_peak, force_gain, response_gain, walk, wavering
from dashpot.identify import identify
from dashpot.identify.faults.contradiction import Contradiction
from dashpot.identify.faults.inconsistent_recording import _may_be_odd, in_words
from dashpot.identify.faults.part import Part, Span
from dashpot.identify.problem.output_error import State

SHORT = replace(STANDS["built-in"], cycles=60.0, fs=400.0)


@pytest.mark.parametrize(
    ("lie", "words"),
    [
        (Lie("", "force gain", 2, force_gain(0.8, 0.45)), "the force counts 0.8 ±"),
        (Lie("", "walk", 2, walk(0.05)), "zero walks at random"),
        (Lie("", "clipped", 2, clipped_peak(), last=True), "the top of a swing is cut off"),
        (Lie("", "wavering", 2, wavering(0.01, 9.5)), "its clock wavers by 1.001 ±"),
        pytest.param(Lie("", "wavering", 2, wavering(0.01, 3.0)), "its clock wavers by 1 ±", marks=pytest.mark.long),
    ],
    ids=["gain", "walk", "clipped", "wavering fast", "wavering"],
)
def test_without_being_asked_a_lie_is_named_and_covered(lie, words):
    found = identify(told(SHORT, lie))
    (sentence,) = found.faults
    assert sentence.startswith(("decay.csv: ", "weak.csv: ", "strong.csv: ")[lie.record])
    assert words in sentence
    parameters = found.oscillator.parameters()
    assert max(abs(p.value - SHORT.values[name]) / p.std for name, p in parameters.items() if p.std) < 5.0


@pytest.mark.long
def test_another_rig_is_told_by_its_friction_where_the_others_are_driven_as_hard():
    stand = STANDS["built-in"]
    (sentence,) = identify(told(stand, Lie("", "another rig", 1, of_another_rig(stand, viscous=1.3)))).faults
    assert sentence.startswith("weak.csv: it agrees with one rig, viscous 6.5")


def test_what_no_kind_explains_is_told_with_its_place():
    both = (response_gain(0.9, 0.6), force_gain(1.2, 0.6))
    found = identify(told(SHORT, Lie("", "", 1, lambda r: both[1](both[0](r)))))
    (sentence,) = found.faults
    assert sentence.startswith("weak.csv: from ")
    assert "does not agree" in sentence
    assert "no lack of physics does that" in sentence


def left(*ratios: float) -> SimpleNamespace:
    """A fit of as many recordings, with what each leaves in times of the noise."""
    segments = [SimpleNamespace(over_noise=r, segment=SimpleNamespace(recording=i)) for i, r in enumerate(ratios)]
    return SimpleNamespace(segments=segments)


@pytest.mark.parametrize(
    ("by_themselves", "odd", "asked"),
    [
        ((1.0, 1.0, 1.0), [0, 1, 2], [2, 1, 0]),
        ((1.0, 1.0, 2.0), [2], [2, 1, 0]),
        ((1.0, 2.0, 2.0), [], [2, 1]),  # physics is missing: nobody else is asked
        ((1.0, 2.0, None), [1], [2, 1, 0]),  # too short to be fitted by itself
    ],
)
def test_what_leaves_more_than_noise_by_itself_is_not_among_others_that_agree(by_themselves, odd, asked):
    recordings, order = [0, 1, 2], []

    def alone(some):
        order.append(some[0])
        if (ratio := by_themselves[some[0]]) is None:
            raise BadInput("too short")
        return left(ratio)

    assert list(_may_be_odd(left(3.0, 4.0, 5.0), recordings, alone)) == odd
    assert order == asked


def contradicted(part: Part, other: Part | None, *, reached: bool) -> str:
    recordings = told(SHORT, None)
    return in_words(Contradiction(part, other, (), reached, State(np.zeros(0), np.zeros((0, 2))), (), ()), recordings)


def test_the_words_say_which_part_and_what_may_be_the_cause():
    weak, strong = Span(1, 0.0, 24.0, 24), Span(2, 0.0, 24.0, 24)
    assert "all other recordings agree" in contradicted(Part(weak, 0, 24), None, reached=True)
    tail = contradicted(Part(weak, 10, 24), None, reached=False)
    assert tail.startswith("from 10 s on it does not agree")
    assert "physics is missing" in tail
    assert "physics is missing" not in contradicted(Part(weak, 10, 24), None, reached=True)
    same = contradicted(Part(weak, 10, 24), Part(weak, 0, 10), reached=False)
    assert same.startswith("what it shows until 10 s and what it shows from 10 s on contradict each other")
    others = contradicted(Part(weak, 4, 6), Part(strong, 0, 24), reached=False)
    assert others.startswith("from 4 to 6 s it contradicts strong.csv, and the rest agrees with either")


@pytest.mark.long
def test_two_driven_recordings_do_not_say_which_of_them_has_the_force_of_the_rig():
    stand = replace(STANDS["fast"], cycles=60.0)
    found = identify(told(stand, Lie("", "another rig", 2, of_another_rig(stand, mass=1.2))))
    (sentence,) = found.faults
    assert "throughout, the force counts 0.83" in sentence
    assert "strong.csv is the one that is not right" in sentence
    mass = found.oscillator.parameters()["mass"]
    assert abs(mass.value - stand.values["mass"]) < 2.0 * mass.std


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (wavering(0.01, 3.0), r"its clock wavers by (0\.99|1\.00)\d* ±"),
        (of_another_rig(STANDS["fast"], omega0=0.95), r"it agrees with one rig, 45\.3"),
    ],
    ids=["wavering", "another rig"],
)
def test_where_one_recording_leads_the_search_astray_the_others_say_which(change, words):
    stand = STANDS["fast"]
    found = identify(told(stand, Lie("", "", 2, change)))
    assert len(found.faults) == 1
    assert re.match(rf"strong\.csv: {words}", found.faults[0])
    parameters = found.oscillator.parameters()
    assert max(abs(p.value - stand.values[name]) / p.std for name, p in parameters.items() if p.std) < 5.0

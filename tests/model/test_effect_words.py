"""Effects in words: every law has a phrase that can stand in a list, and what has none is still called something."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from dashpot.model.effect_words import effect_in_words, phrase_of
from dashpot.model.laws import BASE
from dashpot.model.library import KNOWN

LAWS = {law.name: law for law in (*BASE, *KNOWN.values())}


def test_every_law_has_a_phrase_of_its_own_that_can_stand_in_a_list():
    phrases = {name: law.phrase for name, law in LAWS.items()}
    assert len(set(phrases.values())) == len({law.effect if law.learnt else name for name, law in LAWS.items()})
    for name, phrase in phrases.items():
        assert re.fullmatch(r"[a-z][^,.;:()]+[a-z]", phrase), f"{name}: {phrase!r} would not read well in a list"
        assert " or " not in phrase, f"{name}: what follows 'or' is a rival"
        assert len(phrase) <= 80, f"{name}: {phrase!r} is too long to be listed with others"
        assert name not in phrase, f"{name}: a phrase explains the name"


def test_an_effect_of_several_variants_is_said_by_words_that_hold_for_all():
    """A rival is known by its effect alone: of dry friction in one direction nothing viscous may be said."""
    assert effect_in_words("asymmetric-friction") == "friction that is larger in one direction (asymmetric-friction)"
    assert "viscous" not in LAWS["asymmetric-friction"].phrase


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stribeck", "friction that is larger at rest and falls with speed (stribeck)"),
        ("one-sided-stop", "a stop on one side (one-sided-stop)"),
        (
            "softening-stiffness/sine",
            "a part of the spring that bends over as gravity on a pendulum does (softening-stiffness/sine)",
        ),
        ("dry-friction", "dry friction of constant size (dry-friction)"),
        ("free/spring", "a spring force of a shape that no law of the library has (free/spring)"),
        ("free/surface", "a damping over the displacement that no law of the library has (free/surface)"),
        ("free/modulation", "free/modulation"),  # which no law stands for
        ("Eq. 17", "Eq. 17"),
        ("", ""),
    ],
)
def test_words_with_the_name_in_brackets_or_the_name_alone(name, words):
    assert effect_in_words(name) == words


def test_an_effect_that_has_variants_only_is_said_by_its_first(monkeypatch):
    law = replace(KNOWN["stribeck"], name="creep/slow", phrase="a joint that creeps")
    monkeypatch.setitem(KNOWN, "creep/slow", law)
    assert effect_in_words("creep") == "a joint that creeps (creep)"


@pytest.mark.parametrize(
    ("sentence", "phrase"),
    [
        ("A magnet that pulls back, the less the farther away.", "a magnet that pulls back, the less the farther away"),
        ("The seat gives way: it is of foam.", "the seat gives way"),
        ("Coulomb friction in both joints; it stays.", "Coulomb friction in both joints"),
        ("Drag of order 1.5 in the speed. Measured.", "Drag of order 1.5 in the speed"),
        ("Another", "Another"),
    ],
)
def test_without_a_phrase_the_beginning_of_the_sentence_stands_for_it(sentence, phrase):
    assert phrase_of(replace(KNOWN["stribeck"], sentence=sentence, phrase="")) == phrase

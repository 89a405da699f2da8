"""The diagnosis in words: what it must hold, in few lines."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from dashpot.diagnose.depends_on import DependsOn, Share
from dashpot.model.formula.nearest_law import NearestLaw
from dashpot.report.diagnosis_text import describe

SAID = {"missing-physics": "◆ Missing physics.", "consistent": "✓ Consistent.", "unexplained": "▲ Unexplained."}


@pytest.mark.parametrize("verdict", SAID)
def test_the_text_holds_what_it_must(verdict, hand_made) -> None:
    diagnosis = hand_made.verdicts[verdict]()
    text = describe(diagnosis)
    assert len(text.splitlines()) <= 40
    assert max(len(line) for line in text.splitlines()) <= 100
    assert text.startswith(SAID[verdict])
    for r in diagnosis.records:
        assert re.search(rf"{r.file} .*0\.021.*0\.0204", text) or verdict == "unexplained"
    assert re.search(r"multisine\.csv .* held out", text)
    if verdict == "missing-physics":
        assert "coefficient  0.15000 ± 0.00021 N·s²/m², or 0.50000 ± 0.00050 1/m per unit mass" in text
        assert "Not distinguished from damping that grows with the cube of the speed (cubic-damping)." in text
        assert "What would tell: a record at three times the amplitude." in " ".join(text.split())
        assert "viscous  5 → 4.5000 ± 0.0045 1/s  (by −111 new errors, −10 %)" in text
        assert "dry " not in text
        assert "A gap of one sample was closed." in text
    if verdict != "consistent":
        assert "Too little damping above 4 mm." in text
        assert "Play a sweep from 8 to 16 Hz at 2.5 N." in text
    if verdict == "unexplained":
        assert "Remains: Ten times the noise is left in multisine.csv." in text


def test_what_would_tell_is_not_said_twice(hand_made) -> None:
    """The next experiment has its place below; what it leaves open stays with the effect."""
    diagnosis = hand_made.missing()
    sentence = "Play a sweep from 8 to 16 Hz at 2.5 N."
    effect = replace(diagnosis.effects[0], separated_by=f"{sentence} It does not tell it from stribeck.")
    diagnosis = replace(diagnosis, effects=(effect,), experiment=replace(diagnosis.experiment, sentence=sentence))
    text = " ".join(describe(diagnosis).split())
    assert text.count(sentence) == 1
    assert "What would tell: the next experiment, below. It does not tell it from stribeck." in text


def test_each_effect_is_said_in_words_and_doubted_by_itself(hand_made) -> None:
    diagnosis = hand_made.missing()
    stop = replace(diagnosis.effects[0], effect="one-sided-stop", law="one-sided-stop", path="restoring")
    stop = replace(stop, indistinguishable_from=("clearance", "two-sided-stop"))
    text = " ".join(describe(replace(diagnosis, effects=(diagnosis.effects[0], stop))).split())
    both = "drag that grows with the square of the speed (quadratic-drag) and a stop on one side (one-sided-stop)."
    assert f"look for {both}" in text
    doubt = (
        "cannot tell quadratic-drag from cubic-damping, nor one-sided-stop from clearance or two-sided-stop: make the"
    )
    assert doubt in text
    assert "a stop on one side (one-sided-stop) in the spring (path: restoring)" in text


def test_the_text_stays_short_however_much_there_is_to_say(hand_made) -> None:
    diagnosis = hand_made.missing()
    words = "something of great length that goes on and on " * 20
    effect = replace(diagnosis.effects[0], separated_by=words)
    records = tuple(replace(diagnosis.records[i % 3], file=f"{i}-{'x' * 80}.csv") for i in range(30))
    diagnosis = replace(
        diagnosis,
        sentence=words,
        effects=(effect,) * 6,
        location=replace(diagnosis.location, statement=words),
        records=records,
        experiment=replace(diagnosis.experiment, sentence=words),
        remainder=words,
        notes=tuple(f"{i} {words}" for i in range(9)),
    )
    lines = describe(diagnosis).splitlines()
    assert len(lines) <= 62
    assert max(len(line) for line in lines) <= 100


def test_on_what_the_force_depends_and_the_nearest_law_have_their_lines(hand_made) -> None:
    diagnosis = hand_made.missing()
    shares = (Share("velocity", 0.9, 0.02, 0.9, 0.02, within=True), Share("time", 0.0, 0.0, 0.002, 0.006))
    nearest = NearestLaw("free/spring", "x", "", "softening-stiffness", -3e-3, 3e-3, 5e-3, "more", "more", {})
    place = replace(diagnosis.location, depends_on=DependsOn(shares, 40))
    text = describe(replace(diagnosis, location=place, nearest=(nearest,)))
    assert "The nearest law to free/spring\n  as softening-stiffness up to 3 mm on both sides, then harder.\n" in text
    said = "90 ± 2 % by velocity; time adds nothing (at most 0.2 ± 0.6 %)."
    assert f"On what the missing force depends, of its power\n  {said}\n" in text

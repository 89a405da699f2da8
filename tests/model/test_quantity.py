"""Numbers with units as people write them."""

from __future__ import annotations

import math

import pytest
from dashpot.errors import BadInput
from dashpot.model.quantity import converted, said


@pytest.mark.parametrize(
    ("text", "wanted", "value"),
    [
        ("0.15 N", "N", 0.15),
        ("1.7 kN/m", "N/m", 1700.0),
        ("1.7 N/mm", "N/m", 1700.0),
        ("1.35 N s/m", "N.s/m", 1.35),
        ("1.35 N·s/m", "N.s/m", 1.35),
        ("15 mm/s^2", "m/s2", 0.015),
        ("15 mm/s²", "m/s2", 0.015),
        ("270g", "kg", 0.27),
        ("12.67 Hz", "rad/s", 2 * math.pi * 12.67),
        ("79.6 rad/s", "Hz", 79.6 / 2 / math.pi),
        ("4.6e5 1/(m2.s2)", "1/(m2.s2)", 4.6e5),
        ("0.46 1/(mm2 s2)", "1/(m2.s2)", 4.6e5),
        ("180 deg/s", "rad/s", math.pi),
        ("-3 µm", "m", -3e-6),
    ],
)
def test_units_become_the_wanted_one(text, wanted, value):
    number, unit = said(text, "it")
    assert converted(number, unit, wanted, "it") == pytest.approx(value, rel=1e-12)


def test_another_quantity_is_none():
    assert converted(1.0, "kg", "N", "it") is None
    assert converted(1.0, "rad/s2", "Hz", "it") is None


@pytest.mark.parametrize(
    ("text", "words"),
    [("abc", "give a number"), ("", "give a number"), ("3 foo", "not known"), ("3 N/", "cannot read")],
)
def test_what_is_no_quantity_is_said(text, words):
    with pytest.raises(BadInput, match=words):
        converted(*said(text, "it"), "N", "it")

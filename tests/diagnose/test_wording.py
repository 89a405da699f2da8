"""Figures, lists and effects as a person reads them."""

from __future__ import annotations

import pytest
from dashpot.diagnose.wording import effects_in_words, figure, quantity
from dashpot.model.effect_words import effect_in_words


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (270.4, 2, "270"),
        (0.0012345, 3, "0.00123"),
        (1.5, 3, "1.5"),
        (-12.345, 3, "-12.3"),
        (123456.0, 3, "123000"),
        (2.0, 3, "2"),
        (0.0, 3, "0"),
    ],
)
def test_a_figure_is_written_out_to_so_many_digits(value, digits, text):
    assert figure(value, digits) == text


def test_a_figure_has_three_digits_where_nobody_says_how_many():
    assert figure(3.14159) == "3.14"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.51, "0.51 m"),
        (0.49, "490 mm"),
        (4.1e-3, "4.1 mm"),
        (0.51e-3, "0.51 mm"),
        (0.49e-3, "490 µm"),
        (0.51e-6, "0.51 µm"),
        (0.49e-6, "490 nm"),
        (0.51e-9, "0.51 nm"),
        (0.49e-9, "4.9e-10 m"),
        (-4.1e-3, "-4.1 mm"),
        (12.0, "12 m"),
        (0.0, "0 m"),
    ],
)
def test_a_length_is_told_in_thousandths_from_half_of_one_on(value, text):
    assert quantity(value, "m") == text


@pytest.mark.parametrize(
    ("unit", "text"), [("m/s", "4.1 mm/s"), ("N", "4.1 mN"), ("kg", "0.0041 kg"), ("V", "0.0041 V")]
)
def test_only_units_that_take_a_prefix_get_one(unit, text):
    """Nobody says how an unknown unit is divided, and a kilogram has its prefix already."""
    assert quantity(4.1e-3, unit) == text


def test_effects_are_named_in_words_with_their_laws_names():
    stop, drag = effect_in_words("one-sided-stop"), effect_in_words("quadratic-drag")
    assert "(one-sided-stop)" in stop
    assert effects_in_words(["one-sided-stop"]) == stop
    assert effects_in_words(["one-sided-stop", "quadratic-drag"]) == f"{stop} and {drag}"
    assert effects_in_words(["one-sided-stop", "quadratic-drag"], "or") == f"{stop} or {drag}"

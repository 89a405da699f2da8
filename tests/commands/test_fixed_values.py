"""--fix takes numbers, and numbers with a unit, whose meaning is looked at where the recordings are known."""

from __future__ import annotations

import click
import pytest
from dashpot.commands.options import fixed_values


def read(*texts: str) -> dict[str, float | str]:
    command = click.Command("identify")
    return fixed_values(click.Context(command), click.Option(["--fix"]), texts)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("dry=0.015", {"dry": 0.015}),
        (" cubic = 4.6e5", {"cubic": 4.6e5}),
        ("friction=0.15N", {"friction": "0.15N"}),
        ("stiffness=1.7 kN/m", {"stiffness": "1.7 kN/m"}),
        ("cubic=4.6e5 1/(m2.s2)", {"cubic": "4.6e5 1/(m2.s2)"}),
    ],
)
def test_a_unit_is_kept_and_a_number_is_one(text, wanted):
    assert read(text) == wanted


@pytest.mark.parametrize("text", ["dry", "dry=", "dry=abc", "=1", "dry=1,5", "dry=--1"])
def test_anything_else_is_refused(text):
    with pytest.raises(click.BadParameter, match="is not NAME=VALUE with a number"):
        read(text)

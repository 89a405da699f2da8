"""What is wanted, as it is said."""

from __future__ import annotations

import math

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.foresight.want import errors_of, stated, wants_of
from dashpot.model import Oscillator
from dashpot.model.parameter import Parameter
from dashpot.model.terms import with_term

MODEL = Oscillator.from_values(TRUTH, name="stand")


@pytest.mark.parametrize(
    ("text", "name", "error"),
    [
        ("cubic 1%", "cubic", 4600.0),
        ("dry 0.001 m/s2", "dry", 0.001),
        ("dry 0.001", "dry", 0.001),
        ("friction 5 %", "friction", 0.05 * 0.27 * 0.015),
        ("stiffness 0.1 kN/m", "stiffness", 100.0),
        ("natural_frequency 10 mHz", "natural_frequency", 0.01),
    ],
)
def test_a_share_or_a_size_with_a_unit(text, name, error):
    (want,) = wants_of([text], MODEL)
    assert want.name == name
    assert want.error == pytest.approx(error)


def test_a_law_of_one_coefficient_is_named_by_itself():
    (want,) = wants_of(["quadratic-drag 2%"], with_term(MODEL, "quadratic-drag", {"coefficient": 3.0}))
    assert want.name == "quadratic-drag.coefficient"
    assert want.error == pytest.approx(0.06 * MODEL.values()["mass"])  # as the machine has it


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("cubi 1%", "did you mean cubic"),
        ("cubic", "how well"),
        ("cubic -1%", "how well"),
        ("cubic 1 N", "no unit of cubic"),
        ("cubic one", "give a number"),
    ],
)
def test_what_is_no_want_says_what_to_write(text, says):
    with pytest.raises(BadInput, match=says):
        wants_of([text], MODEL)


def test_a_share_of_zero_is_none():
    with pytest.raises(BadInput, match="is zero in the model"):
        wants_of(["cubic 1%"], Oscillator.from_values(TRUTH | {"cubic": 0.0}))
    with pytest.raises(BadInput, match="nothing is wanted"):
        wants_of([], MODEL)


def test_errors_of_parameters_and_machine():
    wants = wants_of(["dry 1%", "friction 1%", "cubic 1%"], MODEL)
    errors = errors_of(wants, MODEL, ["mass", "dry"], np.diag([1e-6, 1e-8]))
    assert errors[0] == pytest.approx(1e-4)
    assert errors[1] == pytest.approx(math.hypot(0.015 * 1e-3, 0.27 * 1e-4))
    assert errors[2] == math.inf
    assert stated(Parameter(1.0, 0.0, "m")) == stated(None) == math.inf

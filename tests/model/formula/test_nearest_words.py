"""The nearest law in words and as JSON, for hand-made ones."""

from __future__ import annotations

from dataclasses import replace

import pytest
from dashpot.model import Oscillator
from dashpot.model.formula.nearest_law import NearestLaw
from dashpot.model.formula.nearest_words import as_json, in_words, nearest_laws
from dashpot.model.oscillator import Provenance

WHOLE = NearestLaw("free/spring", "x", "", "softening-stiffness", -5e-3, 5e-3, 5e-3, "", "", {})


@pytest.fixture(scope="module")
def model() -> Oscillator:
    base = {"mass": 2.0, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}
    return Oscillator.from_values(base)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({}, "as softening-stiffness over all that was recorded"),
        ({"law": ""}, "as Eq. 17 over all that was recorded"),
        ({"high": 3e-3, "above": "more"}, "as softening-stiffness up to 3 mm on the positive side, then harder"),
        ({"low": -3e-3, "below": "less"}, "as softening-stiffness up to −3 mm on the negative side, then softer"),
        (
            {"low": -3e-3, "high": 3e-3, "below": "more", "above": "more"},
            "as softening-stiffness up to 3 mm on both sides, then harder",
        ),
        (
            {"low": -3e-3, "high": 3e-3, "below": "more", "above": "less"},
            "as softening-stiffness up to 3 mm on both sides, then softer on the positive side and harder on the "
            "negative one",
        ),
        (
            {"low": -2e-3, "high": 3e-3, "below": "more", "above": "less"},
            "as softening-stiffness from −2 mm to 3 mm; harder below, softer above",
        ),
        (
            {"effect": "free/damping", "variable": "v", "law": "quadratic-drag", "high": 0.3, "above": "less"},
            "as quadratic-drag up to 0.3 m/s on the positive side, then weaker",
        ),
    ],
)
def test_it_is_said_in_one_line(model, change, said):
    assert in_words(replace(WHOLE, **change), model) == said


def test_in_the_unit_that_was_recorded(model):
    recordings = ({"file": "a.csv", "unit": "mil"},)
    model = replace(model, identified=Provenance(recordings=recordings))
    found = replace(WHOLE, low=-2.54e-4, high=2.54e-4, below="more", above="more")
    assert in_words(found, model) == "as softening-stiffness up to 10 mil on both sides, then harder"


def test_json_is_in_si_with_the_sentence(model):
    made = as_json(replace(WHOLE, high=3e-3, above="more"), model)
    assert (made["law"], made["from"], made["to"], made["recorded_to"]) == ("softening-stiffness", -5e-3, 3e-3, 5e-3)
    assert (made["unit"], made["below"], made["above"]) == ("m", None, "harder")
    assert made["sentence"] == "as softening-stiffness up to 3 mm on the positive side, then harder"
    assert as_json(replace(WHOLE, law=""), model)["law"] is None


def test_of_a_model_without_a_covariance_nothing_is_said(model):
    assert nearest_laws(model) == ()

"""What a diagnosis says, as the file has it: every figure in its place, and nothing that JSON does not know."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from dashpot.diagnose.depends_on import DependsOn, Share
from dashpot.diagnose.result import ChainFact, Considered, Diagnosis, Effect, Experiment, Location, RecordFit
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, Parameter, Response, oscillator_with
from dashpot.model.formula.nearest_law import NearestLaw

FAMILY = Oscillator.from_values(TRUTH | {"dry": 0.5})
MENDED = oscillator_with(TRUTH | {"quadratic-drag.coefficient": 2.0}, effects=("quadratic-drag",))
NOTHING = np.zeros(2)


def row(file: str, *, holdout: bool, before: float = 0.2, after: float = 0.1) -> RecordFit:
    return RecordFit(file, holdout, before, after, 0.01, NOTHING, NOTHING, NOTHING, NOTHING, None, Response())


def drag(odds: float = 50.0) -> Effect:
    coefficient = {"coefficient": Parameter(2.0, 0.1, "1/m")}
    return Effect(
        "quadratic-drag", "quadratic-drag", "dissipation", coefficient, ("cubic-damping",), "play it", odds, 0.75
    )


def diagnosis(**given: object) -> Diagnosis:
    """With drag missing, unless other fields are given."""
    fields = {
        "verdict": "missing-physics",
        "sentence": "Missing: drag.",
        "effects": (drag(),),
        "location": None,
        "before": FAMILY,
        "model": MENDED,
        "records": (row("sweep", holdout=False), row("held", holdout=True), row("decay", holdout=False)),
        "considered": (),
        "experiment": None,
        "remainder": None,
        "latent": (),
        "notes": ("first", "second"),
    }
    return Diagnosis(**fields | given)  # type: ignore[arg-type]


def written(**given: object) -> dict:
    """The file, as whoever reads it gets it."""
    return json.loads(json.dumps(diagnosis(**given).as_json(), allow_nan=False))


def test_what_is_named_bears_its_values_its_rivals_and_its_odds():
    document = written()
    assert document["format"] == "dashpot-diagnosis/1"
    assert (document["verdict"], document["sentence"]) == ("missing-physics", "Missing: drag.")
    assert document["effects"] == [
        {
            "effect": "quadratic-drag",
            "law": "quadratic-drag",
            "path": "dissipation",
            "parameters": {"coefficient": {"value": 2.0, "std": 0.1, "unit": "1/m"}},
            "machine": {"coefficient": {"value": 0.54, "std": None, "unit": "N.s2/m2"}},
            "indistinguishable_from": ["cubic-damping"],
            "separated_by": "play it",
            "odds": 50.0,
            "probability": 50.0 / 51.0,
            "share": 0.75,
        }
    ]
    assert document["notes"] == ["first", "second"]


@pytest.mark.parametrize(("odds", "said"), [(9.9e5, 9.9e5), (1.1e6, 1e6), (math.inf, 1e6), (math.nan, None)])
def test_odds_beyond_a_million_say_no_more(odds, said):
    assert written(effects=(drag(odds),))["effects"][0]["odds"] == said


def test_recordings_stand_where_they_were_used():
    fit = written()["fit"]
    assert [r["file"] for r in fit["train"]] == ["sweep", "decay"]
    assert fit["holdout"] == [{"file": "held", "nrmse_before": 0.2, "nrmse_after": 0.1, "noise_floor": 0.01}]


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_what_is_no_number_is_null(value):
    records = (row("run", holdout=False, before=value),)
    chain = (ChainFact("drift", "run", value, "m/s", "it drifts"), ChainFact("hold", None, None, "zero", "held"))
    document = written(records=records, chain=chain)
    assert document["fit"]["train"][0]["nrmse_before"] is None
    assert document["chain"] == [
        {"what": "drift", "file": "run", "value": None, "unit": "m/s", "sentence": "it drifts"},
        {"what": "hold", "file": None, "value": None, "unit": "zero", "sentence": "held"},
    ]


def test_a_law_that_was_not_fitted_has_no_figures():
    considered = (Considered("stribeck", 0.3, -4.0, "not decisive"), Considered("clearance", None, None, "left"))
    assert written(considered=considered)["considered"] == [
        {"effect": "stribeck", "holdout_nrmse": 0.3, "delta_bic": -4.0, "why_not": "not decisive"},
        {"effect": "clearance", "holdout_nrmse": None, "delta_bic": None, "why_not": "left"},
    ]


def test_where_nothing_is_to_be_said_there_is_null_or_nothing():
    document = written()
    assert document["location"] is None
    assert document["remainder"] is None
    assert document["next_experiment"] == ""
    assert document["chain"] == []


def test_the_place_where_the_family_fails_is_told_by_its_ranges():
    ranges = {"displacement": (-1.0, 2.0), "velocity": (-3.0, 4.0), "amplitude": (0.5, 2.0)}
    ranges |= {"frequency_hz": (5.0, 20.0), "time_s": (0.0, 6.0)}
    place = Location("dissipation", "at speed", recordings=("sweep",), harmonics={1: 0.75, 3: 0.25}, **ranges)
    assert written(location=place)["location"] == {
        "path": "dissipation",
        "statement": "at speed",
        **{name: list(edges) for name, edges in ranges.items()},
        "recordings": ["sweep"],
        "harmonics": {"1": 0.75, "3": 0.25},
        "depends_on": None,
    }


def test_on_what_the_missing_force_depends_stands_at_its_place():
    depends = DependsOn((Share("velocity", 0.9, 0.02, 0.9, 0.02, within=True),), 40)
    nowhere = dict.fromkeys(("displacement", "velocity", "amplitude", "frequency_hz", "time_s"), (0.0, 1.0))
    place = Location("dissipation", "at speed", recordings=(), harmonics={}, depends_on=depends, **nowhere)
    made = written(location=place)["location"]["depends_on"]
    assert (made["first"], made["sentence"]) == ("velocity", "90 ± 2 % by velocity")


def test_the_nearest_law_of_a_learnt_curve_is_written():
    nearest = NearestLaw("free/spring", "x", "", "softening-stiffness", -3e-3, 3e-3, 5e-3, "more", "more", {})
    (made,) = written(nearest=(nearest,))["nearest_laws"]
    assert (made["law"], made["to"], made["above"]) == ("softening-stiffness", 3e-3, "harder")


def test_what_to_record_next_is_a_sentence():
    proposed = Experiment("play a sweep", "sweep", 1.0, (5.0, 20.0), 6.0, (), None, 500.0)
    assert written(experiment=proposed)["next_experiment"] == "play a sweep"


def test_how_far_each_parameter_was_bent_is_told_of_those_that_both_have():
    known = MENDED.parameters()["dry"]
    mended = MENDED.with_parameters({"dry": Parameter(known.value, 1e-3, known.unit)})
    shift = diagnosis(model=mended).parameter_shift()
    assert set(shift) == set(TRUTH)
    assert shift["dry"] == {"before": 0.5, "after": TRUTH["dry"], "std": 1e-3}
    assert shift["viscous"] == {"before": TRUTH["viscous"], "after": TRUTH["viscous"], "std": None}
    assert written(model=mended)["parameter_shift"]["dry"] == shift["dry"]
    # a parameter that only the mended model has was never bent
    assert "quadratic-drag.coefficient" in mended.parameters()


def test_a_parameter_that_the_mended_model_lacks_has_not_shifted():
    massless = Oscillator.from_values({name: value for name, value in TRUTH.items() if name != "mass"})
    assert set(diagnosis(model=massless).parameter_shift()) == set(TRUTH) - {"mass"}

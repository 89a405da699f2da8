"""What `dashpot show` says of a model."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from dashpot.model import Parameter, Provenance, Range
from dashpot.model.show import as_json, describe, value_and_error, warnings


@pytest.fixture
def measured(rig):
    o = rig(effects=("quadratic-drag",), **{"quadratic-drag.coefficient": 0.2})
    stds = {"mass": 3e-4, "omega0": 2e-3, "cubic": 5e3, "preload": 8e-4, "viscous": 2e-3, "dry": 5e-4}
    o = o.with_parameters({name: replace(p, std=stds.get(name, 0.01)) for name, p in o.parameters().items()})
    provenance = Provenance(
        recordings=({"file": "sweep.csv", "sha256": "ab" * 32, "kind": "sweep"},),
        method="maximum-likelihood",
        software="dashpot 0.1.0",
        parameters=("preload", "dry", "viscous"),
        covariance=((4.0, -1.9, 0.1), (-1.9, 1.0, 0.1), (0.1, 0.1, 1.0)),
        log_likelihood=-12.5,
    )
    return replace(
        o, name="stand", identified=provenance, amplitude=Range(2e-4, 9e-3, "m"), frequency=Range(5.0, 20.0, "Hz")
    )


def test_everything_an_engineer_asks_for_is_there(measured):
    text = describe(measured)
    lines = [" ".join(line.split()) for line in text.splitlines()]
    assert lines[0] == "stand"
    assert lines[2] == measured.equation()
    assert "omega0 79.6080 ± 0.0020 (0.0025 %) rad/s undamped angular frequency of the linear part, 12.67 Hz" in lines
    assert "cubic 4.600e+05 ± 5.0e+03 (1.1 %) 1/(m2.s2) cubic stiffness per unit mass" in lines
    assert "quadratic-drag.coefficient 0.200 ± 0.010 (5 %) 1/m quadratic drag per unit mass" in lines
    assert "preload and dry: -0.950" in lines
    assert "amplitude 0.0002 to 0.009 m" in lines
    assert "frequency 5 to 20 Hz" in lines
    assert "sweep.csv (sweep), sha256 abababababab…" in lines
    assert "by maximum-likelihood, dashpot 0.1.0, log likelihood -12.5" in lines
    assert "Take note" not in text


def test_the_same_as_data_survives_json(measured):
    data = json.loads(json.dumps(as_json(measured), allow_nan=False))
    assert data["parameters"]["dry"] == {
        "value": 0.015,
        "std": 5e-4,
        "percent": pytest.approx(100 / 30),
        "unit": "m/s2",
        "description": "dry friction force per unit mass",
    }
    assert data["correlations"] == [{"parameters": ["preload", "dry"], "correlation": -0.95}]
    assert data["valid"]["frequency"] == {"min": 5.0, "max": 20.0, "unit": "Hz"}
    assert data["identified"]["covariance"][0] == [4.0, -1.9, 0.1]


def test_data_of_a_broken_fit_is_still_json(measured):
    broken = measured.with_parameters({"dry": Parameter(0.01, math.inf, "m/s2")})
    data = as_json(broken)
    json.dumps(data, allow_nan=False)
    assert data["parameters"]["dry"]["std"] is None
    assert any("dry is not known at all" in sentence for sentence in data["warnings"])


@pytest.mark.parametrize("name", ["dry", "viscous", "preload", "quadratic-drag.coefficient"])
def test_what_should_not_be_negative_is_a_sign_of_missing_physics(measured, name):
    p = measured.parameters()[name]
    clearly = measured.with_parameters({name: replace(p, value=-10 * p.std)})
    barely = measured.with_parameters({name: replace(p, value=-p.std)})
    assert [s for s in warnings(clearly) if s.startswith(f"{name} is negative") and "the model lacks something" in s]
    assert [s for s in warnings(barely) if s.startswith(f"{name} is negative but within two standard errors")]
    assert "do not trust it beyond what was recorded" in describe(clearly)


def test_a_softening_spring_says_where_it_lets_go(rig):
    o = replace(rig(omega0=80.0, cubic=-4e5), amplitude=Range(1e-3, 9e-3, "m"))
    # omega0² x - |c| x³ is largest at 73 mm and zero at 126.5 mm
    assert any("falls beyond 0.073 m" in s and "beyond 0.126 m; the recordings reach 0.009 m" in s for s in warnings(o))


def test_what_is_not_known_is_said(rig, measured):
    o = rig(mass=None)
    text = describe(o)
    assert "mass unknown none was given" in " ".join(text.split())
    assert "the input is a force per unit mass" in text
    assert "No parameter has a standard error" in text
    assert as_json(o)["mass_known"] is False


@pytest.mark.parametrize(
    ("value", "known"),
    [
        (7.0, None),
        (5.0, "known to 60 % only"),
        (1.0, "no larger than its error, 3 1/(m2.s2)"),
        (1e-15, "no larger than its error, 3 1/(m2.s2)"),
    ],
)
def test_what_is_hardly_known_is_said_with_its_share_or_its_size(measured, value, known):
    loose = measured.with_parameters({"cubic": Parameter(value, 3.0, "1/(m2.s2)")})
    rest = "these recordings do not carry it; record where it matters, or fix it."
    assert warnings(loose) == ([] if known is None else [f"cubic is {known}: {rest}"])


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [
        (79.6079578, 0.002, ("79.6080", "0.0020")),
        (0.015, 0.000512, ("0.01500", "0.00051")),
        (4.6e5, 5e3, ("4.600e+05", "5.0e+03")),
        (0.2, 30.0, ("0", "30")),
        (5.0, None, ("5", "")),
        (5.0, 0.0, ("5", "0")),
        (1.2e-9, 3e-11, ("1.200e-09", "3.0e-11")),
        (123.456, 1e-20, ("123.456", "1.0e-20")),
    ],
)
def test_a_value_has_the_digits_its_error_carries(value, std, shown):
    assert value_and_error(Parameter(value, std)) == shown

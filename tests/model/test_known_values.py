"""Known values in the machine's units, as the parameters that are per unit mass."""

from __future__ import annotations

import math

import pytest
from dashpot.errors import BadInput
from dashpot.model import Oscillator, Response, oscillator_with
from dashpot.model.known_values import known_values
from dashpot.model.library import find
from dashpot.model.physical import law_strengths, machine

STAND = {"mass": 0.27, "omega0": 79.6, "viscous": 5.0, "dry": 0.015, "cubic": 4.6e5, "preload": 0.07}


def known(given, *laws: str, response: Response | None = None) -> dict[str, float]:
    return known_values(given, [find(law) for law in laws], response or Response())


def test_what_the_machine_shows_goes_back_to_the_parameters():
    shown = {name: p.value for name, p in machine(Oscillator.from_values(STAND)).items() if name != "damping_ratio"}
    made = known(shown)
    assert made == pytest.approx(STAND, rel=1e-12)
    texts = {
        name: f"{p.value!r} {p.unit}" for name, p in machine(Oscillator.from_values(STAND)).items() if name in shown
    }
    assert known(texts) == pytest.approx(STAND, rel=1e-12)


def test_parameters_take_their_own_unit_or_the_force_s():
    assert known({"dry": "15 mm/s2"}) == pytest.approx({"dry": 0.015})
    assert known({"dry": "4.05 mN", "mass": "270 g"}) == pytest.approx({"dry": 0.015, "mass": 0.27})
    assert known({"omega0": "12.67 Hz"})["omega0"] == pytest.approx(2 * math.pi * 12.67)
    rotation = Response("displacement", "rad")
    assert known_values({"friction": "2 N.m", "mass": "4 kg.m2"}, [], rotation, "N.m")["dry"] == pytest.approx(0.5)


def test_the_strength_of_a_law_in_the_machine_s_unit():
    name = "quadratic-drag.coefficient"
    model = oscillator_with(STAND | {name: 3.0}, effects=("quadratic-drag",))
    strength = law_strengths(model)[name]
    made = known({name: f"{strength.value!r} {strength.unit}", "mass": 0.27}, "quadratic-drag")
    assert made[name] == pytest.approx(3.0, rel=1e-12)
    assert known({name: "3 1/m"}, "quadratic-drag")[name] == 3.0


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (
            {"friction": "0.15 N"},
            "friction = 0.15 N is a product with the mass, which is not given; give the mass too, or fix dry",
        ),
        ({"dry": "3 kg"}, "the fixed dry is '3 kg', and kg is no unit of it; give it in m/s2"),
        ({"drye": "3 N"}, "there is no parameter 'drye'; did you mean dry"),
        ({"dry": 1.0, "friction": 1.0, "mass": 2.0}, "the fixed friction says that dry is 0.5, and it is fixed at 1"),
        ({"dry": math.nan}, "must be a finite number"),
        ({"stiffness": "0 N/m", "mass": 1.0}, "'omega0' must be greater than 0"),
    ],
)
def test_what_cannot_be_is_said(given, words):
    with pytest.raises(BadInput, match=words):
        known(given)


def test_a_name_that_only_the_fit_knows_passes_where_it_is_a_number():
    assert known({"hysteresis.limit": 2.0}) == {"hysteresis.limit": 2.0}

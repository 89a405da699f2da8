"""Every law in the machine's units: the parameter's own unit times that of the mass, with the errors of both."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from dashpot.model import Oscillator, Parameter, Provenance, Response, oscillator_with, units
from dashpot.model.laws import LIBRARY
from dashpot.model.library import find
from dashpot.model.machine_units import in_force, products, words_of_product
from dashpot.model.physical import in_machine_units, law_strengths, machine, machine_words
from dashpot.model.show import describe

STAND = {"mass": 0.5, "omega0": 80.0, "viscous": 5.0, "dry": 0.3, "cubic": 4e5, "preload": 0.08}
FORCES = sorted(law.name for law in LIBRARY.values() if law.force is not None)


def with_law(name: str, **how: object) -> Oscillator:
    law = find(name)
    values = {f"{name}.{p.name}": max(p.lower, 0.7) if p.lower > -math.inf else 0.7 for p in law.parameters}
    return oscillator_with(STAND | values, [name], **how)


@pytest.mark.parametrize("name", FORCES)
def test_the_unit_of_each_strength_is_the_parameter_s_times_kg(name):
    model = with_law(name)
    parameters, strengths = model.parameters(), law_strengths(model)
    assert strengths
    for key, p in strengths.items():
        own = units.base_exponents(parameters[key].unit)
        assert units.base_exponents(p.unit) == {**own, "kg": 1}
        assert p.value == pytest.approx(0.5 * parameters[key].value, rel=1e-15)
    named = {product.name for key, product in products(model).items() if "." in key}
    assert named <= machine(model).keys()
    assert not any("per unit mass" in machine_words(model)[key] for key in named)


@pytest.mark.parametrize(
    ("law", "parameter", "unit"),
    [
        ("quadratic-drag", "coefficient", "N.s2/m2"),
        ("one-sided-stop", "stiffness", "N/m"),
        ("one-sided-stop", "damping", "N.s/m"),
        ("stribeck", "excess", "N"),
        ("quintic-stiffness", "coefficient", "N/m5"),
        ("cubic-damping", "coefficient", "N.s3/m3"),
    ],
)
def test_an_engineer_s_unit_of(law, parameter, unit):
    assert units.same(law_strengths(with_law(law))[f"{law}.{parameter}"].unit, unit)


def test_of_a_rotation_forces_are_moments():
    turned = with_law("quadratic-drag", response=Response("displacement", "rad"), force_unit="N.m")
    assert law_strengths(turned)["quadratic-drag.coefficient"].unit == "N.m.s2/rad2"
    assert in_machine_units(turned)["dry"].unit == "N.m"


def test_a_ratio_of_masses_is_a_mass_and_called_so():
    model = with_law("attached-resonator")
    assert products(model)["attached-resonator.mass-ratio"] == ("attached-resonator.mass", "kg")
    assert machine(model)["attached-resonator.mass"] == Parameter(0.35, None, "kg")
    assert machine_words(model)["attached-resonator.mass"] == "its mass"


def test_the_error_is_that_of_both_with_their_covariance():
    name = "quadratic-drag.coefficient"
    model = with_law("quadratic-drag").with_parameters(
        {"mass": Parameter(0.5, 0.01, "kg"), name: Parameter(0.7, 0.02, "1/m")}
    )
    alone = law_strengths(model)[name]
    assert alone.std == pytest.approx(math.hypot(0.5 * 0.02, 0.7 * 0.01))
    rows = ((1e-4, -1.9e-4), (-1.9e-4, 4e-4))
    known = replace(model, identified=Provenance(parameters=("mass", name), covariance=rows))
    together = 0.7**2 * 1e-4 + 0.5**2 * 4e-4 - 2 * 0.7 * 0.5 * 1.9e-4
    assert law_strengths(known)[name].std == pytest.approx(math.sqrt(together))


def test_what_is_given_and_not_measured_has_the_error_of_the_mass_alone():
    model = with_law("quadratic-drag").with_parameters({"mass": Parameter(0.5, 0.01, "kg")})
    assert law_strengths(model)["quadratic-drag.coefficient"].std == pytest.approx(0.007)
    assert in_machine_units(with_law("quadratic-drag"))["dry"].std is None


def test_without_a_mass_everything_stays_per_unit_mass():
    values = {key: value for key, value in STAND.items() if key != "mass"}
    model = oscillator_with(values | {"quadratic-drag.coefficient": 0.7}, ["quadratic-drag"])
    assert products(model) == in_machine_units(model) == law_strengths(model) == {}
    assert machine(model).keys() == {"natural_frequency", "damping_ratio"}


def test_what_is_shown_has_the_law_as_the_machine_has_it():
    said = describe(with_law("quadratic-drag"))
    (line,) = [line.split() for line in said.splitlines() if line.split()[:2] == ["quadratic-drag.coefficient", "0.35"]]
    assert line[2:] == ["N.s2/m2", "quadratic", "drag"]


def test_the_words_of_a_product_leave_the_mass_out():
    assert words_of_product("force that it comes to, per unit mass") == "force that it comes to"
    assert words_of_product("contact stiffness per unit mass") == "contact stiffness"
    assert in_force("1/X") == "Q.s2/X2"

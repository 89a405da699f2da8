"""A force law by itself: its numbers, its equation, its file, its equations as the engine has them."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.model.element import MEMBERS, Element, grown, template_of
from dashpot.model.element_file import dumps, is_element, load_element, loads, save_element
from dashpot.model.equations import equations
from dashpot.model.file import load
from dashpot.model.laws import LIBRARY, PRESCRIBED
from dashpot.model.library import find

VALUES = {"inertia": 2.0, "stiffness": 8e3, "viscous": 900.0, "dry": 40.0, "load": -12.0}
FORCES = [law.name for law in (*LIBRARY.values(), *PRESCRIBED.values()) if law.force is not None]


def test_members_that_are_not_given_are_zero_and_units_follow() -> None:
    element = Element.from_values(VALUES, unit="m", force_unit="N")
    assert element.values() == {
        "inertia": 2.0, "stiffness": 8e3, "cubic": 0.0, "preload": 0.0, "viscous": 900.0, "dry": 40.0, "load": -12.0
    }  # fmt: skip
    units = {name: p.unit for name, p in element.parameters().items()}
    assert units == {
        "inertia": "kg", "stiffness": "N/m", "cubic": "N/m3", "preload": "N", "viscous": "N.s/m", "dry": "N",
        "load": "N",
    }  # fmt: skip
    turning = Element.from_values(VALUES, unit="rad", force_unit="N.m").parameters()
    assert turning["inertia"].unit == "kg.m2"
    assert turning["viscous"].unit == "N.m.s/rad"


def test_strengths_of_a_law_are_forces_and_its_places_are_not() -> None:
    law = find("hysteresis")
    assert [template_of(p) for p in law.parameters] == ["Q/X", "X", "1", "1"]
    element = grown(Element.from_values(VALUES), law, {"stiffness": 1e5, "limit": 1e-4, "exponent": 1, "loading": 0.5})
    assert element.parameters()["hysteresis.stiffness"].unit == "N/m"
    assert element.bounds()["hysteresis.limit"] == (1e-12, np.inf)
    assert element.bounds()["inertia"] == (0.0, np.inf)


def test_what_is_not_known_or_missing_is_refused() -> None:
    with pytest.raises(BadInput, match="unknown parameter 'mass'"):
        Element.from_values({"mass": 1.0})
    with pytest.raises(BadInput, match=r"'quadratic-drag\.coefficient' is missing"):
        Element.from_values({}, laws=[find("quadratic-drag")])


def test_the_equation_leaves_out_what_is_zero() -> None:
    assert Element.from_values({"viscous": 2.0, "load": 1.0}).equation() == "F = viscous x' + load"
    assert Element.from_values({}).equation() == "F = 0"
    aside = Element.from_values({"dry": 3.0}, origin=0.05)
    assert aside.equation() == "F = dry sgn(x'); x counted from 0.05 m"


@pytest.mark.parametrize("law", FORCES)
def test_a_file_comes_back_bit_for_bit(law: str) -> None:
    own = {f"{law}.{p.name}": max(p.lower, min(p.upper, 1.2)) for p in find(law).parameters}
    element = Element.from_values(VALUES | own, name="a strut", origin=0.1 / 3, laws=[find(law)])
    assert loads(dumps(element)) == element


def test_files_of_elements_and_of_rigs_are_told_apart(tmp_path) -> None:
    path = tmp_path / "strut.yaml"
    save_element(Element.from_values(VALUES, name="strut"), path)
    assert is_element(path.read_text())
    assert load_element(path).name == "strut"
    with pytest.raises(BadInput, match="that is a force law by itself"):
        load(path)
    with pytest.raises(BadInput, match="an element says 'format: dashpot-element/1'"):
        loads("format: dashpot-model/1\nname: rig\n")


def test_every_problem_of_a_file_is_reported_at_once() -> None:
    text = dumps(Element.from_values(VALUES | {"quadratic-drag.coefficient": 3.0}, laws=[find("quadratic-drag")]))
    broken = text.replace("dry: ", "dri: ").replace("unit: N.s/m}", "unit: N}").replace("coefficient:", "coeff:")
    with pytest.raises(BadInput) as refused:
        loads(broken, "strut.yaml")
    said = str(refused.value)
    for words in (
        "$.dry: is missing",
        "$.viscous.unit: must be N.s/m",
        "$.dri: unknown key",
        "coefficient: is missing",
    ):
        assert words in said
    sensor = text.replace("quadratic-drag", "sensor-lag").replace("coefficient:", "time:")
    with pytest.raises(BadInput, match="sensor-lag is no force"):
        loads(sensor)


def test_a_covariance_must_be_one() -> None:
    text = dumps(Element.from_values(VALUES))
    identified = "identified:\n  parameters: [viscous, dri]\n  covariance:\n    - [1.0, 5.0]\n    - [5.0, 1.0]\n"
    with pytest.raises(BadInput) as refused:
        loads(text + identified)
    assert "no parameter 'dri'" in str(refused.value)
    assert "correlation above 1" in str(refused.value)


@pytest.mark.parametrize("law", [None, *FORCES])
def test_power_is_what_is_stored_and_what_is_taken(law: str | None) -> None:
    """F v = d(energy)/dt + dissipated power, along any motion."""
    import casadi as ca

    own = {} if law is None else {f"{law}.{p.name}": max(p.lower, min(p.upper, 0.7)) for p in find(law).parameters}
    element = Element.from_values(VALUES | own, laws=[] if law is None else [find(law)])
    eq = equations(element)
    motion = ca.jtimes(eq.energy, eq.z, eq.zdot) + ca.jtimes(eq.energy, eq.t, ca.SX(1))
    left = ca.Function("left", [eq.z, eq.t, eq.u, eq.p, eq.s], [eq.y[0] * eq.z[1] - motion - eq.dissipated])
    rng, values = np.random.default_rng(0), [*element.values().values(), element.origin]
    for _ in range(20):
        z = rng.uniform(-0.3, 0.3, eq.z.numel())
        signs = np.where(rng.uniform(size=len(eq.kinds)) > 0.5, 1.0, -1.0)
        assert abs(float(left(z, 0.3, rng.normal(), values, signs))) < 1e-6 * 1e4


def test_members_of_eq_17_are_its_own_times_a_mass() -> None:
    assert [p.name for law in MEMBERS for p in law.parameters] == [
        "stiffness", "cubic", "preload", "viscous", "dry", "load"
    ]  # fmt: skip

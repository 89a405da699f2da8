"""Strengths that depend on a channel: forms by hand, the element at a value of the channel, its file."""

from __future__ import annotations

import math

import pytest
from dashpot.errors import BadInput
from dashpot.model.dependence import FORMS, Dependence, beyond, own_unit, possible
from dashpot.model.element import Element
from dashpot.model.element_file import dumps, loads
from dashpot.model.library import find

CURRENT = ("A", 0.0, 0.5)
PRESSURE = (4e5, "Pa", 1e5, 7e5)


def element() -> Element:
    values = {"viscous": 300.0, "dry": 3.0, "quadratic-drag.coefficient": 4.0}
    values |= {"viscous.current_slope": 100.0, "dry.pressure_exponent": 1.2}
    values |= {"quadratic-drag.coefficient.current_rate": 0.8}
    ways = [
        Dependence("current", "viscous", "linear", 0.25, *CURRENT),
        Dependence("pressure", "dry", "power", *PRESSURE),
        Dependence("current", "quadratic-drag.coefficient", "inverse", 0.25, *CURRENT),
        Dependence("pressure", "viscous", "origin", *PRESSURE),
    ]
    return Element.from_values(values, laws=[find("quadratic-drag")], dependences=ways)


def test_each_form_is_one_at_the_reference() -> None:
    for form in FORMS.values():
        assert form.value(7.0, 0.3, 2.5, 2.5) == pytest.approx(7.0)
    assert FORMS["linear"].value(7.0, 2.0, 4.0, 1.0) == pytest.approx(13.0)
    assert FORMS["origin"].value(7.0, None, 4.0, 2.0) == pytest.approx(14.0)
    assert FORMS["power"].value(7.0, 2.0, 4.0, 2.0) == pytest.approx(28.0)
    assert FORMS["inverse"].value(7.0, 0.5, 4.0, 2.0) == pytest.approx(3.5)


def test_an_element_at_a_channel_has_plain_numbers() -> None:
    plain = element().at({"current": 0.5, "pressure": 2e5})
    assert not plain.dependences
    known = plain.values()
    assert known["viscous"] == pytest.approx((300.0 + 100.0 * 0.25) * 0.5)
    assert known["dry"] == pytest.approx(3.0 * 0.5**1.2)
    assert known["quadratic-drag.coefficient"] == pytest.approx(4.0 / (1.0 + 0.8 * 0.25))
    same = element().at({}).values()
    assert [same[name] for name in ("viscous", "dry")] == [300.0, 3.0]
    with pytest.raises(BadInput, match="depends on no channel 'load'"):
        element().at({"load": 1.0})


def test_the_equation_and_the_words_say_what_depends() -> None:
    said = element().equation()
    assert "(viscous + current_slope (current - 0.25)) pressure/4e+05 x'" in said
    assert "dry (pressure/4e+05)^pressure_exponent sgn(x')" in said
    assert element().descriptions()["viscous.current_slope"] == "change of viscous with current"


def test_the_units_of_a_forms_own_number() -> None:
    assert own_unit("linear", "N.s/m", "A") == "N.s/(m.A)"
    assert own_unit("inverse", "N.s/m", "degC") == "1/degC"
    assert own_unit("power", "N", "Pa") == "1"
    assert own_unit("linear", "N", "N") == "1"


def test_forms_that_cannot_be_are_said() -> None:
    assert possible("power", "A", 0.0, 1.0, 0.5)
    assert possible("origin", "degC", 20.0, 30.0, 25.0)
    assert possible("origin", "A", 0.0, 1.0, 0.5) is None
    assert possible("linear", "degC", -5.0, 30.0, 10.0) is None


def test_beyond_what_was_recorded_is_said() -> None:
    ways = element().dependences
    assert beyond(ways, {"current": 0.0}, {"current": 0.5}) == []
    (said,) = beyond(ways, {"current": 0.7}, {"current": 0.7})
    assert "current is 0.7 A, and the recordings covered 0 to 0.5 A" in said


def test_the_file_gives_the_element_back() -> None:
    text = dumps(element())
    again = loads(text)
    assert dumps(again) == text
    assert again.dependences == element().dependences
    assert math.isclose(again.at({"pressure": 1e5}).values()["viscous"], 75.0)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("of: viscous", "of: viscos", r"line 18: \$.channels\[0\].of: nothing is called so.*did you mean viscous"),
        ("how: linear", "how: cubic", r"must be 'linear', 'origin', 'power' or 'inverse', not 'cubic'"),
        ("how: linear", "how: power", "its zero lies within 0 to 0.5 A"),
        ("unit: N.s/(m.A)", "unit: N", r"line 21: \$.channels\[0\].slope.unit: must be N.s/\(m.A\), not 'N'"),
        ("at: 0.25", "at: 2", "must be a range with 'at' in it"),
        ("value: 0.8", "value: 8.0", "makes quadratic-drag.coefficient infinite within 'valid'"),
        ("    rate: {value: 0.8, std: null, unit: 1/A}\n", "", "rate: is missing; write rate"),
        ("channel: pressure", "channel: current", "has another unit, 'at' or 'valid' above"),
        ("unit: A", "unit: /", "cannot read"),
    ],
)
def test_what_is_wrong_in_a_file_is_said_with_its_line(old: str, new: str, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        loads(dumps(element()).replace(old, new, 1))

"""What the model file refuses no way into a model accepts."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from fractions import Fraction

import dashpot
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.model import Oscillator, Parameter
from dashpot.model.file import dumps, loads
from dashpot.model.limits import LEAST, MOST, checked_value

#: No value of a parameter, and what is said of it.
WRONG = [
    ("mass", 0, "must be greater than 0, not 0"),
    ("mass", -1, "must be greater than 0, not -1"),
    ("mass", np.inf, "is inf; it must be a finite number"),
    ("mass", np.nan, "is nan; it must be a finite number"),
    ("mass", "1.3", "must be a plain number such as 4.6e5, not '1.3'"),
    ("mass", b"1.3", "must be a plain number"),
    ("mass", 1e-320, "must not be below 1e-100, but is 9.99"),
    ("mass", True, "must be a plain number"),
    ("mass", np.bool_(True), "must be a plain number"),
    ("mass", 1j, "must be a plain number"),
    ("mass", [1.0], "must be a plain number"),
    ("mass", np.ones(1), "must be a plain number"),
    ("mass", 10**400, "is inf"),
    ("omega0", -5, "must be greater than 0, not -5"),
    ("omega0", 0.0, "must be greater than 0"),
    ("omega0", 1e-101, "must not be below 1e-100"),
    ("dry", np.nan, "is nan"),
    ("cubic", -1e101, "is -1e.101; it must be a finite number of at most 1e.100"),
    ("cubic", None, "must be a plain number"),
]


@pytest.mark.parametrize(("name", "value", "says"), WRONG)
def test_what_is_no_value_is_refused(name, value, says):
    with pytest.raises(BadInput, match=f"parameter '{name}' {says}"):
        dashpot.Model.from_values({**TRUTH, name: value})


@pytest.mark.parametrize(("name", "value"), [(n, v) for n, v, _ in WRONG if type(v) in (int, float) and v != 10**400])
def test_the_file_and_whatever_takes_a_model_refuse_it_as_well(name, value):
    sound = Oscillator.from_values(TRUTH)
    wrong = replace(sound, **{name: Parameter(float(value), None, sound.parameters()[name].unit)})
    with pytest.raises(BadInput, match=rf"\$\.{name}\.value: must"):
        loads(dumps(wrong))
    for use in (
        lambda: dashpot.Model(wrong),
        lambda: dashpot.simulate(wrong, seconds=1.0, fs=100.0),
        lambda: dashpot.compare(wrong, sound),
    ):
        with pytest.raises(BadInput, match=rf"model: \$\.{name}\.value: must"):
            use()


# a text is taken there: with a unit or without
@pytest.mark.parametrize(
    ("name", "value", "says"), [w for w in WRONG if w[1] is not None and not isinstance(w[1], str)]
)
def test_what_is_held_is_checked_alike(name, value, says):
    with pytest.raises(BadInput, match=f"parameter '{name}' {says}"):
        dashpot.identify(recording_of(TRUTH, begin=(8e-3, 0.0)), fixed={name: value})


def test_bounds_of_a_law_hold():
    with pytest.raises(BadInput, match=r"'quadratic-drag\.coefficient' must lie between 0 and inf, but is -1"):
        dashpot.Model.from_values({**TRUTH, "quadratic-drag.coefficient": -1.0}, laws=["quadratic-drag"])


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ({"name": ""}, "is empty"),
        ({"name": "a\nb"}, "holds a line break"),
        ({"name": "a" * 300}, "longer than 255"),
        ({"name": 5}, "must be texts"),
        ({"unit": ""}, "unit '' is not known"),
        ({"unit": None}, "must be texts"),
        ({"quantity": "speed"}, "use one of displacement"),
        ({"laws": ["quadratic-drag", "quadratic-drag"]}, "is missing"),
    ],
)
def test_names_and_units_are_checked_as_in_the_file(how, says):
    values = {**TRUTH, "quadratic-drag.coefficient": 1.0} if "laws" in how else TRUTH
    with pytest.raises(BadInput, match=says):
        dashpot.Model.from_values(values, **how)


@pytest.mark.parametrize("value", [1, 1.5, np.float32(0.5), np.int8(3), np.array(2.0), Fraction(1, 2), LEAST, MOST])
def test_plain_numbers_of_any_kind_are_taken(value):
    assert checked_value("mass", value) == float(value)
    assert dashpot.Model.from_values({**TRUTH, "mass": value})["mass"].value == float(value)


@pytest.mark.parametrize(("name", "value"), [("mass", LEAST), ("mass", MOST), ("omega0", LEAST), ("omega0", MOST)])
def test_the_utmost_models_are_simulated_or_refused(name, value):
    model = dashpot.Model.from_values({**TRUTH, "cubic": 0.0, name: value})
    found = None
    with contextlib.suppress(BadInput):
        found = model.simulate(force=np.sin(np.arange(200) * 0.1), fs=100.0)
    assert found is None or np.all(np.isfinite(found.response))

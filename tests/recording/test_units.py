"""Units as headers spell them."""

from __future__ import annotations

import math

import pytest
from dashpot.errors import BadInput
from dashpot.recording.units import find_unit, parse_unit


@pytest.mark.parametrize(
    ("spellings", "si", "factor", "quantity"),
    [
        (["m", "meter", "metre"], "m", 1.0, "displacement"),
        (["mm", "MM", "millimetre"], "m", 1e-3, "displacement"),
        (["um", "µm", "μm", "micron"], "m", 1e-6, "displacement"),
        (["in", "inch"], "m", 0.0254, "displacement"),
        (["rad"], "rad", 1.0, "displacement"),
        (["deg", "°", "degrees"], "rad", math.pi / 180, "displacement"),
        (["m/s", "m_s", "mps", "m s-1", "m.s-1", "m s^-1"], "m/s", 1.0, "velocity"),
        (["mm/s", "mm_s"], "m/s", 1e-3, "velocity"),
        (["m/s2", "m_s2", "m/s^2", "m/s²", "mps2", "m/s**2", "m/s/s", "m s-2"], "m/s2", 1.0, "acceleration"),
        (["g", "G"], "m/s2", 9.80665, "acceleration"),
        (["N", "newton"], "N", 1.0, "force"),
        (["kN"], "N", 1e3, "force"),
        (["mN"], "N", 1e-3, "force"),
        (["Nm", "N.m", "N m", "N·m"], "N.m", 1.0, "force"),
        (["V", "volt"], "V", 1.0, "any"),
        (["mV"], "V", 1e-3, "any"),
        (["strain"], "strain", 1.0, "displacement"),
        (["microstrain", "ustrain", "µε", "µm/m"], "strain", 1e-6, "displacement"),
        (["s", "sec", "seconds"], "s", 1.0, "time"),
        (["ms"], "s", 1e-3, "time"),
    ],
)
def test_spellings(spellings, si, factor, quantity):
    for text in spellings:
        unit = parse_unit(text, "here")
        assert (unit.si, unit.quantity) == (si, quantity), text
        assert unit.factor == pytest.approx(factor, rel=1e-12), text


@pytest.mark.parametrize("text", ["MN", "M", "KM", "MV", "S", "", "furlong", "m/s3", "1", "n"])
def test_capitals_and_strangers_are_not_taken_for_units(text):
    assert find_unit(text) is None


def test_unknown_unit_names_the_nearest():
    with pytest.raises(BadInput, match=r"rig\.csv: unit 'mmm' is not known; did you mean .*mm"):
        parse_unit("mmm", "rig.csv")
    with pytest.raises(BadInput, match="known are m, "):
        parse_unit("?!", "rig.csv")

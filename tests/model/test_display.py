from __future__ import annotations

import math

import pytest
from dashpot.model import Parameter
from dashpot.model.display import number, pretty_unit, scale_of, tick_text, times_text, value_text


@pytest.mark.parametrize(
    ("unit", "largest", "shown", "factor"),
    [
        ("m", 9e-3, "mm", 1e3),
        ("m", 3e-6, "µm", 1e6),
        ("N", 0.3, "N", 1.0),
        ("N", 0.02, "mN", 1e3),
        ("m/s2", 0.02, "mm/s²", 1e3),
        ("m2", 1e-6, "m²", 1.0),  # a prefix would be squared
        ("V", 2e4, "kV", 1e-3),
        ("rad", 0.1, "deg", 180 / math.pi),
        ("rad/s", 0.1, "deg/s", 180 / math.pi),
        ("counts", 1e5, "counts", 1.0),
        ("strain", 1e-6, "strain", 1.0),
        ("1/s", 1e-6, "1/s", 1.0),
        ("m", 0.0, "m", 1.0),
        ("m", math.nan, "m", 1.0),
    ],
)
def test_scale(unit: str, largest: float, shown: str, factor: float) -> None:
    scale = scale_of(unit, largest)
    assert scale.unit == shown
    assert scale.factor == pytest.approx(factor, rel=1e-12)
    assert scale.label("Amplitude") == f"Amplitude [{shown}]"


def test_units_and_numbers_are_typeset() -> None:
    assert pretty_unit("1/(m2.s2)") == "1/(m²·s²)"
    assert number(-4.6e5, 3) == "−4.6·10⁵"
    assert number(math.nan) == "unknown"
    assert number(math.inf) == "∞"
    assert [times_text(v) for v in (1.019, 12.3, 186.4, 12345.0, math.inf)] == [
        "1.02",
        "12",
        "190",
        "12000",
        "infinitely many",
    ]
    assert value_text(Parameter(0.27, 0.0016, "kg")) == ("0.2700", "0.0016")
    assert value_text(Parameter(-0.27, None, "kg")) == ("−0.27", "")
    assert [tick_text(v) for v in (0.1, 100.0, 1e-5, 2e6, 0.0)] == ["0.1", "100", "10⁻⁵", "2·10⁶", ""]

"""A sampling frequency as people say it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording.frequency import frequency_of


@pytest.mark.parametrize(
    ("given", "hertz"),
    [
        (1000, 1e3),
        ("1000", 1e3),
        ("1kHz", 1e3),
        ("1.5 kHz", 1500.0),
        ("50 hz", 50.0),
        (np.float32(8), 8.0),
        ("2e-1 MHz", 2e5),
    ],
)
def test_numbers_and_texts(given, hertz):
    assert frequency_of(given) == pytest.approx(hertz, rel=1e-15)


@pytest.mark.parametrize("given", ["1 kN", "", "kHz", "1 mHz", "1,000", "nan", [1000], True])
def test_anything_else_is_refused_in_a_sentence(given):
    with pytest.raises(BadInput, match=r"fs .*(give a number of Hz|must be a number)"):
        frequency_of(given)

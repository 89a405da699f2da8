"""Displacement by integration, against a motion in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.displacement import displacement
from dashpot.recording import Recording

FS, PACE, RATE = 500.0, 2 * np.pi * 10.0, 0.05
TIME = np.arange(4000) / FS


def motion(order: int) -> np.ndarray:
    """The order-th derivative of 5 mm exp(-rate t) cos(pace t)."""
    pole = -RATE + 1j * PACE
    return np.real(5e-3 * pole**order * np.exp(pole * TIME))


def test_a_displacement_is_returned_as_it_is():
    given = Recording("run", FS, motion(0) + 1.0)
    assert np.array_equal(displacement(given).samples, given.response)


@pytest.mark.parametrize("offset", [0.0, 0.3])
@pytest.mark.parametrize(("order", "quantity", "unit"), [(1, "velocity", "m/s"), (2, "acceleration", "m/s2")])
def test_what_is_integrated_is_the_motion_and_an_offset_is_not(order, quantity, unit, offset):
    given = Recording("run", FS, motion(order) + offset * np.std(motion(order)), None, quantity, unit)
    found = displacement(given)
    assert found.fs == FS
    # what an integration adds is known worst at the ends, ten cycles and for the second one thirty
    ends, part = ((500, 0.01), (1500, 0.05))[order - 1]
    assert found.samples[ends:-ends] == pytest.approx(motion(0)[ends:-ends], abs=part * 5e-3)

"""Intervals are split where a law switches, however large or small what switches is."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.model.quadrature import split_panels


@pytest.mark.parametrize("size", [1e-200, 1.0, 1e200])
def test_a_switch_is_found_whatever_its_surface_is_measured_in(size):
    panels = split_panels(lambda angle, row: size * (np.cos(angle) - 0.3)[None], 1, np.pi, 4)
    edges = np.concatenate([[0.0], np.cumsum(panels.width[0])])
    assert np.min(np.abs(edges - np.arccos(0.3))) < 1e-12
    assert panels.integral(np.sign(np.cos(panels.angle) - 0.3))[0] == pytest.approx(2 * np.arccos(0.3) - np.pi)

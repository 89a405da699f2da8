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


@pytest.mark.parametrize(("shape", "evaluations"), [(np.sinh, 16), (np.tanh, 16), (np.cbrt, 60), (lambda u: u**3, 62)])
def test_a_switch_is_found_to_the_last_digit_in_few_evaluations(shape, evaluations):
    asked = []

    def surfaces(angle, row):
        asked.append(angle.size)
        return shape(40 * (angle - np.array([0.7, 1.9, 1.0])[row]))[None]

    panels = split_panels(surfaces, 3, np.pi, 4)
    edges = np.cumsum(panels.width, axis=1)
    found = [np.min(np.abs(row - root)) for row, root in zip(edges, (0.7, 1.9, 1.0), strict=True)]
    assert np.max(found) < 1e-15 * 4
    assert len(asked) <= evaluations  # halving takes 50; where that is best it is what is done


def test_a_switch_in_the_middle_of_an_interval_is_kept_while_others_are_looked_for():
    def surfaces(angle, row):
        return (angle - np.array([3 * np.pi / 8, 0.7])[row])[None] ** np.array([1, 3])[row]

    edges = np.cumsum(split_panels(surfaces, 2, np.pi, 4).width, axis=1)
    assert np.min(np.abs(edges[0] - 3 * np.pi / 8)) < 1e-15

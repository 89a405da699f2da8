"""Describing functions by quadrature against their closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.model.describing import equivalent_damping, equivalent_stiffness

A = np.geomspace(1e-6, 2e-2, 25)
OMEGA = np.linspace(20.0, 140.0, 25)
NONE = {"cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0}


def test_the_whole_of_equation_17(rig):
    o = rig()
    stiffness = o.omega0.value**2 + 0.75 * o.cubic.value * A**2 + 4 * o.preload.value / (np.pi * A)
    damping = o.viscous.value + 4 * o.dry.value / (np.pi * OMEGA * A)
    np.testing.assert_allclose(equivalent_stiffness(o, A, OMEGA), stiffness, rtol=1e-12)
    np.testing.assert_allclose(equivalent_damping(o, A, OMEGA), damping, rtol=1e-12)


@pytest.mark.parametrize(
    ("effect", "stiffness", "damping"),
    [
        ("quadratic-stiffness", 0 * A, 0 * A),
        ("quintic-stiffness", 5 / 8 * A**4, 0 * A),
        ("quadratic-drag", 0 * A, 8 / (3 * np.pi) * OMEGA * A),
        ("cubic-damping", 0 * A, 3 / 4 * (OMEGA * A) ** 2),
    ],
)
def test_further_laws(rig, effect, stiffness, damping):
    factor = 1e5
    o = rig(effects=(effect,), **NONE, **{f"{effect}.coefficient": factor})
    np.testing.assert_allclose(equivalent_stiffness(o, A, OMEGA), o.omega0.value**2 + factor * stiffness, rtol=1e-11)
    np.testing.assert_allclose(equivalent_damping(o, A, OMEGA), factor * damping, rtol=1e-12, atol=1e-9)


def test_a_kink_inside_the_cycle_is_met_exactly(rig, contact):
    k, gap = 3e4, 1e-3
    o = rig(effects=("contact",), **NONE, **{"contact.stiffness": k, "contact.gap": gap})
    amplitude = gap * np.array([0.5, 1.0 + 1e-5, 1.01, 1.5, 3.0, 50.0])
    angle = np.arccos(np.minimum(gap / amplitude, 1.0))  # half of the contact, in phase
    # one side of the clearance nonlinearity: Gelb and Vander Velde 1968, appendix B
    expected = k / np.pi * (angle - np.sin(angle) * np.cos(angle))
    stiffness = equivalent_stiffness(o, amplitude, 80.0) - o.omega0.value**2
    np.testing.assert_allclose(stiffness, expected, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(equivalent_damping(o, amplitude, 80.0), 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("amplitude", "omega", "said"),
    [
        ([1e-3, 0.0], 80.0, "amplitude must be above zero, but one is 0 m"),
        ([1e-3, np.nan], 80.0, "amplitude must be above zero, but one is nan m"),
        ([1e-3], -80.0, "omega must be above zero"),
        ([[1e-3]], 80.0, "one number or a row of numbers"),
        ([1e-3, 2e-3, 3e-3], [80.0, 81.0], "3 amplitudes with 2 frequencies"),
    ],
)
def test_what_has_no_describing_function_is_said(rig, amplitude, omega, said):
    with pytest.raises(BadInput, match=said):
        equivalent_stiffness(rig(), amplitude, omega)

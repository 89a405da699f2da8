"""Corrected Eqs. 13 and 14 against linear theory, against each other and against an integrated steady state."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.oscillator import integrate
from dashpot.model.backbone import damping_curve, polynomial_backbone
from dashpot.model.frequency_response import branches, frequency_response, steady_amplitude


def test_the_linear_oscillator_has_the_textbook_s_response():
    omega0, h, f = 80.0, 12.0, 4.0
    omega = np.linspace(5.0, 200.0, 40)
    amplitude = np.abs(f / (omega0**2 - omega**2 + 2j * h * omega))
    np.testing.assert_allclose(steady_amplitude(omega, omega0, h, f), amplitude, rtol=1e-13)
    order = np.argsort(amplitude)
    flat = np.full(40, omega0)
    response = branches(amplitude[order], flat, np.full(40, h), f)
    peak = np.sqrt(omega0**2 - 2 * h**2)
    branch = np.where(omega[order] < peak, response.lower, response.upper)
    np.testing.assert_allclose(branch, omega[order], rtol=1e-10)


def test_equation_14_is_the_inverse_of_the_corrected_equation_13():
    a = np.geomspace(1e-5, 5e-3, 60)
    omega0 = polynomial_backbone(80.0, 4.6e5, a)
    h = damping_curve(5.0, 0.015, a, omega0)
    response = branches(a, omega0, h, 2.0)
    for side in (response.lower, response.upper):
        there = np.isfinite(side)
        assert np.count_nonzero(there) > 20
        back = steady_amplitude(side[there], omega0[there], h[there], 2.0)
        np.testing.assert_allclose(back, a[there], rtol=1e-9)


def test_above_the_peak_there_is_nothing_and_below_the_static_deflection_no_lower_branch():
    response = branches([1e-4, 1e-3, 1.0], [80.0] * 3, [2.5] * 3, 2.0)
    assert np.isnan(response.lower).tolist() == [True, False, True]
    assert np.isnan(response.upper).tolist() == [False, False, True]
    omega, amplitude = response.curve()
    assert amplitude.tolist() == [1e-3, 1e-3, 1e-4]
    assert np.all(np.diff(omega) > 0)


@pytest.mark.parametrize("force", [0.1, 1.0])
def test_the_stand_s_branches_meet_at_the_peak_on_the_backbone(rig, force):
    o = rig()
    response = frequency_response(o, force)
    h = damping_curve(o.viscous.value, o.dry.value, response.amplitude, response.omega0)
    f = force / o.mass.value
    np.testing.assert_allclose(response.upper[-1], response.lower[-1], rtol=1e-5)
    np.testing.assert_allclose(response.upper[-1], np.sqrt(response.omega0[-1] ** 2 - 2 * h[-1] ** 2), rtol=1e-5)
    exact = 2 * h[-1] * np.sqrt(response.omega0[-1] ** 2 - h[-1] ** 2)
    np.testing.assert_allclose(response.amplitude[-1], f / exact, rtol=1e-9)


@pytest.mark.parametrize("share", [0.4, 0.9])
@pytest.mark.parametrize("side", ["lower", "upper"])
def test_a_simulated_steady_state_lies_on_the_branch(rig, side, share):
    o, force, fs = rig(), 0.3, 1000.0
    peak = 2.737e-3
    omega = getattr(frequency_response(o, force, [share * peak]), side)[0]
    t = np.arange(int(4 * fs)) / fs
    start = (share * peak, 0.0)
    x, _ = integrate(o.values(), force * np.cos(omega * t), 1 / fs, *start)
    late = t > t[-1] - 20 * 2 * np.pi / omega
    basis = np.exp(-1j * omega * t[late])
    design = np.column_stack([basis.real, basis.imag, np.cos(3 * omega * t[late]), np.sin(3 * omega * t[late])])
    amplitude = np.hypot(*np.linalg.lstsq(design, x[late], rcond=None)[0][:2])
    # one harmonic is balanced and h is taken at omega0: a fraction of a percent
    np.testing.assert_allclose(amplitude, share * peak, rtol=5e-3)


def test_without_a_mass_the_force_is_per_unit_mass(rig):
    given = frequency_response(rig(), 0.3, [1e-3, 2e-3])
    free = frequency_response(rig(mass=None), 0.3 / 0.27, [1e-3, 2e-3])
    np.testing.assert_allclose(free.upper, given.upper, rtol=1e-12)


@pytest.mark.parametrize(
    ("changed", "force", "said"),
    [
        ({}, 0.0, "force amplitude must be above zero"),
        ({}, 0.004, "friction holds the mass against this force"),
        ({"viscous": -1.0, "dry": 0.0}, 1.0, "no peak: the damping is not positive"),
        ({"cubic": -1e6}, 10.0, "softens to nothing before"),
    ],
)
def test_a_response_without_a_peak_is_said(rig, changed, force, said):
    with pytest.raises(BadInput, match=said):
        frequency_response(rig(**changed), force)


def test_unequal_lengths_are_said():
    with pytest.raises(BadInput, match="2 amplitudes, 1 frequencies and 1 dampings"):
        branches([1e-3, 2e-3], [80.0], [2.5], 1.0)

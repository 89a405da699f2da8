"""Describing functions of laws with a memory, against their closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.model.backbone import exact_backbone
from dashpot.model.describing import (
    describing_functions,
    equivalent_damping,
    equivalent_stiffness,
    natural_motion,
)
from dashpot.model.frequency_response import frequency_response
from dashpot.model.laws import LIBRARY

A = np.geomspace(1e-6, 2e-2, 15)
OMEGA = np.linspace(20.0, 300.0, 15)
LINEAR = {"omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0}


@pytest.mark.parametrize("rate", [3.0, 90.0, 900.0])
def test_a_maxwell_branch(with_law, rate):
    branch = {"viscoelastic.stiffness": 3000.0, "viscoelastic.rate": rate}
    k, d = describing_functions(with_law("viscoelastic", **LINEAR, **branch), A, OMEGA)
    np.testing.assert_allclose(k - 6400.0, 3000 * OMEGA**2 / (OMEGA**2 + rate**2), atol=3e-6 * 3000)
    np.testing.assert_allclose(d, 3000 * rate / (OMEGA**2 + rate**2), rtol=3e-6)


def test_an_attached_resonator(with_law):
    ratio, own, damping = 0.1, 100.0, 2.0
    given = {"mass-ratio": ratio, "frequency": own, "damping": damping}
    model = with_law("attached-resonator", **LINEAR, **{f"attached-resonator.{n}": v for n, v in given.items()})
    k, d = describing_functions(model, A, OMEGA)
    pull = own**2 + 1j * damping * OMEGA  # Den Hartog 1956, section 3.3: the second mass as a dynamic stiffness
    dynamic = -ratio * OMEGA**2 * pull / (pull - OMEGA**2)
    np.testing.assert_allclose(k - 6400.0 + 1j * d * OMEGA, dynamic, atol=3e-5 * np.max(np.abs(dynamic)))


@pytest.mark.parametrize("loading", [0.5, 1.0])
@pytest.mark.parametrize("exponent", [1.0, 4.0])
def test_hysteresis_is_a_spring_when_small_and_dry_friction_when_large(with_law, exponent, loading):
    k0, limit = 3000.0, 1e-4
    given = {"stiffness": k0, "limit": limit, "exponent": exponent, "loading": loading}
    model = with_law("hysteresis", **LINEAR, **{f"hysteresis.{n}": v for n, v in given.items()})
    small, large = np.array([1e-3, 3e-3]) * limit, np.array([100.0, 200.0]) * limit
    np.testing.assert_allclose(equivalent_stiffness(model, small, 80.0) - 6400.0, k0, rtol=5e-3)
    assert np.all(equivalent_damping(model, small, 80.0) * 80.0 < 1e-2 * k0)
    assert np.all(equivalent_stiffness(model, large, 80.0) - 6400.0 < 0.02 * k0)
    friction = 4 * k0 * limit / (np.pi * 80.0 * large)
    np.testing.assert_allclose(equivalent_damping(model, large, 80.0), friction, rtol=2e-2)


def test_dahls_loop(with_law):
    """z' = v (1 - (z / limit) sgn v) has the loop z = limit (1 - c exp(-travel / limit)) on the way up."""
    k0, limit = 3000.0, 1e-3
    given = {"stiffness": k0, "limit": limit, "exponent": 1.0, "loading": 1.0}
    model = with_law("hysteresis", **LINEAR, **{f"hysteresis.{n}": v for n, v in given.items()})
    amplitude = np.array([0.3e-3, 1e-3, 4e-3])
    x = amplitude * np.cos(np.linspace(np.pi, 0, 20_001))[:, None]  # the way up; the way down is its mirror image
    c = 2 / (1 + np.exp(-2 * amplitude / limit))
    z = limit * (1 - c * np.exp(-(x + amplitude) / limit))
    area = np.array([np.trapezoid(k0 * z[:, i], x[:, i]) for i in range(3)]) * 2
    np.testing.assert_allclose(
        equivalent_damping(model, amplitude, 80.0), area / (np.pi * 80.0 * amplitude**2), rtol=1e-5
    )


def test_the_motion_of_its_own_frequency(with_law):
    branch = {"viscoelastic.stiffness": 3000.0, "viscoelastic.rate": 90.0}
    model = with_law("viscoelastic", **LINEAR, **branch)
    omega, h = natural_motion(model, A)
    np.testing.assert_allclose(omega**2, 6400 + 3000 * omega**2 / (omega**2 + 8100), rtol=1e-7)
    np.testing.assert_allclose(2 * h, 3000 * 90 / (omega**2 + 8100), rtol=1e-5)


def test_the_response_peaks_where_the_force_balances_the_loss(with_law):
    model = with_law("hysteresis")
    response = frequency_response(model, 1.0)
    omega, h = natural_motion(model, response.amplitude[-1:])
    needed = 2 * h * response.amplitude[-1:] * np.sqrt(omega**2 - h**2) * model.values()["mass"]
    assert needed == pytest.approx([1.0], rel=1e-3)


@pytest.mark.parametrize("effect", LIBRARY)
def test_every_law_has_its_curves(with_law, effect):
    model = with_law(effect)
    omega, h = natural_motion(model, np.array([1e-3, 4e-3]))
    assert np.all(omega > 0)
    assert np.all(h > 0)
    law = LIBRARY[effect]
    if law.force is None or effect == "tonal-disturbance":  # no part of what pulls at the mass
        plain, damping = natural_motion(with_law(), np.array([1e-3, 4e-3]))
        assert np.array_equal(omega, plain)
        assert np.array_equal(h, damping)


def test_what_has_no_energy_integral_is_said(with_law):
    with pytest.raises(BadInput, match=r"force of hysteresis depends on the motion before.*describing functions"):
        exact_backbone(with_law("hysteresis"), 1e-3)


def test_a_memory_far_faster_than_the_motion_is_refused(with_law):
    model = with_law("viscoelastic", **{"viscoelastic.rate": 1e9})
    with pytest.raises(BadInput, match="choose other amplitudes, or simulate"):
        equivalent_stiffness(model, 1e-3, 80.0)
    assert np.isnan(describing_functions(model, 1e-3, 80.0)).all()

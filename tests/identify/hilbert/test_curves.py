"""Backbone and damping fits; which amplitude and which form the sgn terms follow."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.hilbert.curves import backbone_omega0, fit_backbone, fit_damping
from dashpot.model.backbone import preload_backbone


@pytest.mark.parametrize("peak", [0.3, 1.0, 10.0, 100.0])
def test_describing_function_is_exact_on_the_fundamental_and_eq_1_on_the_peak(peak):
    # x'' + x + sgn x = 0 from rest at `peak`: a cosine about -1 until x = 0, a quarter of the period
    quarter = np.arccos(1 / (1 + peak))
    omega = np.pi / 2 / quarter
    t = np.linspace(0, quarter, 20001)
    fundamental = 2 / quarter * np.trapezoid(((1 + peak) * np.cos(t) - 1) * np.cos(omega * t), t)
    assert preload_backbone(1.0, 1.0, peak) == pytest.approx(omega, rel=1e-12)
    assert backbone_omega0(np.array([fundamental]), 1.0, 0.0, 1.0)[0] == pytest.approx(omega, rel=1e-8)


def test_backbone_from_two_ranges_combined():
    rng = np.random.default_rng(1)
    a = np.concatenate([np.linspace(1e-4, 1e-3, 40), np.linspace(5e-3, 9e-3, 40)])
    std = 1e-5 / a
    w = backbone_omega0(a, 79.6, 4.6e5, 0.074) + std * rng.standard_normal(a.size)
    fit = fit_backbone(a, w, 1 / std**2)
    assert abs(fit.omega0 - 79.6) < 4 * fit.omega0_std
    assert abs(fit.cubic - 4.6e5) < 4 * fit.cubic_std < 0.1 * 4.6e5
    assert abs(fit.preload - 0.074) < 4 * fit.preload_std < 0.1 * 0.074
    assert 0.5 < fit.misfit < 2


def test_an_invisible_cubic_is_zero_and_says_how_little_is_known():
    rng = np.random.default_rng(2)
    a = np.linspace(1e-4, 1e-3, 60)
    std = 1e-5 / a
    fit = fit_backbone(a, backbone_omega0(a, 79.6, 4.6e5, 0.074) + std * rng.standard_normal(a.size), 1 / std**2)
    assert fit.cubic == 0.0
    assert fit.cubic_std > 4.6e5
    assert fit.preload == pytest.approx(0.074, rel=0.1)


def test_damping():
    a = np.linspace(2e-4, 9e-3, 50)
    w = np.full_like(a, 79.6)
    fit = fit_damping(a, w, 2.5 + 2 * 0.015 / (np.pi * w * a))
    assert fit.viscous == pytest.approx(5.0, rel=1e-9)
    assert fit.dry == pytest.approx(0.015, rel=1e-9)


def test_three_points_are_too_few():
    with pytest.raises(BadInput, match="5 points"):
        fit_backbone(np.ones(3), np.ones(3))

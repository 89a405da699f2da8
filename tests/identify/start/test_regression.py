"""The regression on windows: free, swept, broad band, few samples a cycle."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.signals.signals import Signal
from dashpot.identify.signals.weakform import windows
from dashpot.identify.start.regression import Segment, linear_regression_start, regress

NAMES = ("omega0", "cubic", "preload", "viscous", "dry")


def check(estimate, rig, rel):
    for name, tolerance in rel.items():
        assert getattr(estimate, name) == pytest.approx(getattr(rig, name), rel=tolerance), name


def test_windows_differentiate_exactly():
    fs, w, g = 200.0, 2 * np.pi * 6.3, -1.7
    t = np.arange(800) / fs
    p = g + 1j * w
    x, v, a = (np.real(p**k * np.exp(p * t)) for k in range(3))
    view = windows(t.size, fs, 1.0, 3.0, 20.0)
    for k, y in enumerate((x, v, a)):
        assert np.max(np.abs(view.project(x, k) - view.project(y))) < 1e-6 * np.max(np.abs(view.project(y)))


def test_reference_decay(rigs, reference_decay):
    check(
        linear_regression_start(Signal(reference_decay.x[:2000], 1000.0), None),
        rigs.reference,
        {"omega0": 1e-5, "cubic": 2e-3, "preload": 1e-3, "viscous": 1e-4, "dry": 1e-3},
    )
    noisy = linear_regression_start(Signal(reference_decay.noisy(1e-6, 0, 1).x[:2000], 1000.0), None)
    assert noisy.mass is None
    check(noisy, rigs.reference, {"omega0": 1e-4, "cubic": 0.06, "preload": 0.01, "viscous": 1e-3, "dry": 0.05})


def test_reference_sweeps_with_noise_jointly(rigs, reference_sweeps):
    segments = []
    for i, case in enumerate(reference_sweeps):
        noisy = case.noisy(1e-6, 1e-3, i)
        segments.append(Segment(Signal(noisy.x, noisy.fs), Signal(noisy.force, noisy.fs)))
    estimate = regress(segments)
    tolerances = {"omega0": 1e-4, "mass": 1e-4, "cubic": 0.01, "preload": 2e-3, "viscous": 1e-3, "dry": 0.01}
    check(estimate, rigs.reference, tolerances)
    for name in ("mass", *NAMES):
        assert abs(getattr(estimate, name) - getattr(rigs.reference, name)) < 5 * getattr(estimate, f"{name}_std"), name


def test_multisine_at_nine_samples_a_cycle(rigs):
    w0 = 2 * np.pi * 68
    rig = rigs.Rig(mass=5e-6, omega0=w0, cubic=0.3 * w0**2, preload=0.0, viscous=0.1 * w0, dry=0.0)
    case = rigs.case(rig, rigs.multisine(0.1 * w0**2 * 5e-6, 5, 150, 0.4, 3), 610.0, 6.0, substeps=8)
    noisy = case.noisy(1e-4, 1e-3, 0)
    estimate = linear_regression_start(Signal(noisy.x, 610.0), Signal(noisy.force, 610.0))
    check(estimate, rig, {"mass": 2e-3, "omega0": 1e-3, "cubic": 0.02, "viscous": 0.01})


def test_a_constant_is_refused():
    with pytest.raises(BadInput):
        linear_regression_start(Signal(np.ones(1000), 100.0), None)

"""The regression over a forced record: mass, backbone and damping curve from sweeps."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.hilbert.curves import backbone_omega0
from dashpot.identify.hilbert.forced_regression import forced_regression
from dashpot.identify.signals.signals import Signal


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_reference_sweeps_up_and_down(rigs, reference_sweeps, which, noise):
    rig = rigs.reference
    case = reference_sweeps[which].noisy(noise * 1e-6, noise * 1e-3, 5)
    f = forced_regression(Signal(case.x, case.fs), Signal(case.force, case.fs))
    assert f.mass == pytest.approx(rig.mass, rel=1e-4)
    clear = f.amplitude > 3e-4
    truth = backbone_omega0(f.amplitude, rig.omega0, rig.cubic, rig.preload)
    assert np.max(np.abs(f.omega0 - truth)[clear]) / (2 * np.pi) < 0.003
    h = rig.viscous / 2 + 2 * rig.dry / (np.pi * truth * f.amplitude)
    assert np.max(np.abs(f.damping - h)[clear]) < 0.01
    assert f.amplitude[-1] > 0.95 * np.max(np.abs(case.x))


def test_a_rig_of_another_size_and_rate(rigs):
    w0 = 2 * np.pi * 140
    rig = rigs.Rig(mass=12.0, omega0=w0, cubic=-0.1 * w0**2 / 1e-3**2, preload=0.0, viscous=0.04 * w0, dry=0.0)
    case = rigs.case(rig, rigs.sweep(0.04 * w0**2 * 12 * 1e-3, 60, 220, 1.5, 0.05), 2100.0, 1.5, substeps=6)
    f = forced_regression(Signal(case.x, case.fs), Signal(case.force, case.fs))
    assert f.mass == pytest.approx(12.0, rel=1e-3)
    truth = backbone_omega0(f.amplitude, rig.omega0, rig.cubic, rig.preload)
    inner = f.amplitude > 0.2 * f.amplitude[-1]
    assert np.max(np.abs(f.omega0 / truth - 1)[inner]) < 2e-3
    assert np.max(np.abs(f.damping / (rig.viscous / 2) - 1)[inner]) < 0.02


def test_force_of_the_wrong_sign_is_refused(reference_sweeps):
    case = reference_sweeps[0]
    with pytest.raises(BadInput, match="signs"):
        forced_regression(Signal(case.x, case.fs), Signal(-case.force, case.fs))


def test_no_force_is_refused(reference_decay):
    with pytest.raises(BadInput, match="force"):
        forced_regression(Signal(reference_decay.x, 1000.0), Signal(np.zeros_like(reference_decay.x), 1000.0))

"""FREEVIB and the fits to its curves, on decays whose parameters are known."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.hilbert.curves import fit_backbone, fit_damping
from dashpot.identify.hilbert.freevib import freevib
from dashpot.identify.signals.signals import Signal


def fits(f):
    weight = f.per_point / f.omega0_std**2
    count = f.per_point * f.amplitude.size
    backbone = fit_backbone(f.amplitude, f.omega0, weight, count)
    return backbone, fit_damping(f.amplitude, f.omega0, f.damping, f.per_point / f.damping_std**2, count)


@pytest.mark.parametrize("ratio", [0.002, 0.03])
@pytest.mark.parametrize("samples_per_cycle", [12.3, 80.0])
def test_linear_decay_is_met_exactly(ratio, samples_per_cycle):
    w0 = 2 * np.pi * 12.67
    h = ratio * w0
    t = np.arange(round(25 * samples_per_cycle)) / (12.67 * samples_per_cycle)
    x = np.exp(-h * t) * np.cos(np.sqrt(w0**2 - h**2) * t + 0.7)
    f = freevib(Signal(x, 12.67 * samples_per_cycle))
    assert np.max(np.abs(f.omega0 / w0 - 1)) < 1e-4
    assert np.max(np.abs(f.damping - h)) < 1e-4 * w0


def test_reference_decay_noiseless(rigs, reference_decay):
    rig = rigs.reference
    backbone, damping = fits(freevib(Signal(reference_decay.x[:1750], 1000.0)))
    assert backbone.omega0 == pytest.approx(rig.omega0, rel=1e-4)
    assert backbone.cubic == pytest.approx(rig.cubic, rel=0.06)
    assert backbone.preload == pytest.approx(rig.preload, rel=0.01)
    assert damping.viscous == pytest.approx(rig.viscous, rel=1e-3)
    assert damping.dry == pytest.approx(rig.dry, rel=0.02)


def test_reference_decay_with_noise_covers_the_truth(rigs, reference_decay):
    rig = rigs.reference
    off = []
    for seed in range(10):
        backbone, damping = fits(freevib(Signal(reference_decay.noisy(1e-6, 0, seed).x[:1750], 1000.0)))
        off.append(
            [
                (backbone.cubic - rig.cubic) / backbone.cubic_std,
                (backbone.preload - rig.preload) / backbone.preload_std,
                (damping.viscous - rig.viscous) / damping.viscous_std,
                (damping.dry - rig.dry) / damping.dry_std,
            ]
        )
        assert backbone.preload == pytest.approx(rig.preload, rel=0.02)
        assert damping.viscous == pytest.approx(rig.viscous, rel=2e-3)
    assert np.sqrt(np.mean(np.square(off))) < 3


def test_too_short_a_decay_says_so():
    t = np.arange(300) / 1000.0
    with pytest.raises(BadInput, match="8"):
        freevib(Signal(np.exp(-t) * np.cos(80 * np.pi * t / 2), 1000.0))

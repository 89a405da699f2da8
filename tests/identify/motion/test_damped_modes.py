"""Modes that several pieces share, against their truth and the scatter of repeated fits."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.damped_modes import Modes, fit_modes

OMEGA, ZETA = np.array([0.3, 0.33]), np.array([0.01, 0.02])


def piece(n: int, phase: float, drift: float = 0.0) -> np.ndarray:
    t = np.arange(n)
    waves = np.exp(-ZETA * OMEGA * t[:, None]) * np.cos(OMEGA * np.sqrt(1 - ZETA**2) * t[:, None] + phase)
    return waves.sum(axis=1) + 0.5 * phase + drift * t


def test_pieces_without_noise_give_their_modes_and_the_drift():
    pieces = [piece(300, 0.0, 1e-4), piece(200, 1.0, 1e-4), piece(250, 2.0, 1e-4)]
    start = Modes(OMEGA * [1.01, 0.99], ZETA * 1.2, np.eye(4))
    modes, rss = fit_modes(pieces, start, [1e-3] * 3)
    assert modes.omega == pytest.approx(OMEGA, rel=1e-7)
    assert modes.zeta == pytest.approx(ZETA, rel=1e-5)
    assert modes.drift == pytest.approx(1e-4, rel=1e-4)
    assert np.all(rss < 1e-8)


def test_the_covariance_is_the_scatter_of_repeated_fits():
    random, start, found = np.random.default_rng(3), Modes(OMEGA, ZETA, np.eye(4)), []
    for _ in range(200):
        pieces = [piece(n, p) + 0.02 * random.standard_normal(n) for n, p in ((150, 0.0), (200, 1.0))]
        found.append(fit_modes(pieces, start, [0.02] * 2)[0])
    scatter = np.std([np.concatenate([np.log(m.omega), m.zeta]) for m in found], axis=0)
    assert np.sqrt(np.diag(found[0].covariance)) == pytest.approx(scatter, rel=0.25)

"""Second harmonic balance against harmonics that are summed up numerically."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.further_harmonics import further_harmonics, peak_of

ANGLE = 2 * np.pi * (np.arange(200_000) + 0.5) / 200_000


def fundamental(x: np.ndarray, v: np.ndarray, cubic: float, preload: float, dry: float) -> complex:
    force = cubic * x**3 + preload * np.sign(x) + dry * np.sign(v)
    return 2 * complex(np.mean(force * np.exp(-1j * ANGLE)))


@pytest.mark.parametrize(("cubic", "preload", "dry"), [(4.6e5, 0.0, 0.0), (4.6e5, 0.07, 0.02), (0.0, 0.02, 0.05)])
def test_the_fundamental_changes_by_what_the_harmonics_do(cubic, preload, dry):
    a, omega = 1e-3, 80.0
    x, v = a * np.cos(ANGLE), -a * omega * np.sin(ANGLE)
    before = fundamental(x, v, cubic, preload, dry)
    force = cubic * x**3 + preload * np.sign(x) + dry * np.sign(v)
    for n in range(3, 61, 2):
        size = 2 * complex(np.mean(force * np.exp(-1j * n * ANGLE))) / ((n**2 - 1) * omega**2)
        x = x + np.real(size * np.exp(1j * n * ANGLE))
        v = v + np.real(1j * n * omega * size * np.exp(1j * n * ANGLE))
    change = fundamental(x, v, cubic, preload, dry) - before
    stiffness, damping = (float(part) for part in further_harmonics(np.array(a), np.array(omega), cubic, preload, dry))
    scale = abs(change) / a
    # what is left is of the third order, and the harmonics beyond the last
    assert stiffness == pytest.approx(change.real / a, abs=0.06 * scale)
    assert damping * omega == pytest.approx(change.imag / a, abs=0.06 * scale)


def test_a_preload_makes_the_motion_pointed():
    a, omega, preload = 1e-3, 80.0, 0.07
    x = a * np.cos(ANGLE)
    for n in range(3, 201, 2):
        size = 2 * np.mean(preload * np.sign(np.cos(ANGLE)) * np.cos(n * ANGLE)) / ((n**2 - 1) * omega**2)
        x = x + size * np.cos(n * ANGLE)
    assert float(peak_of(np.array(a), np.array(omega), preload)) - a == pytest.approx(np.max(x) - a, rel=1e-3)

"""Harmonic balance against harmonics that are summed up numerically, and against exact periodic motions."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.hilbert.further_harmonics import fundamental_beyond_a_sine, peak_of
from scipy.integrate import quad

ANGLE = 2 * np.pi * (np.arange(200_000) + 0.5) / 200_000
TIME = np.linspace(0.0, 1.0, 5)


def fundamental(x: np.ndarray, v: np.ndarray, cubic: float, preload: float, dry: float) -> complex:
    force = cubic * x**3 + preload * np.sign(x) + dry * np.sign(v)
    return 2 * complex(np.mean(force * np.exp(-1j * ANGLE)))


def beyond(a: float, omega: float, **values: float) -> complex:
    """Of a motion that stays as it is."""
    steady = {"omega0": omega, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0} | values
    return complex(
        fundamental_beyond_a_sine(TIME, np.full(5, a), np.full(5, omega), np.zeros(5), steady)[2],
    )


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
    # what is left is of the third order, and the harmonics beyond the last
    found = a * beyond(a, omega, cubic=cubic, preload=preload, dry=dry)
    assert found == pytest.approx(change, abs=0.06 * abs(change))


@pytest.mark.parametrize("strength", [-0.3, 0.1, 0.5, 1.5])
def test_a_strong_cubic_vibrates_as_its_energy_integral_has_it(strength):
    # x'' + x + strength x³ = 0 from rest at 1: dt = d(phi)/sqrt(1 + strength/2 (1 + cos² phi)) with x = cos(phi)
    def rate(phi: float) -> float:
        return 1 / np.sqrt(1 + 0.5 * strength * (1 + np.cos(phi) ** 2))

    quarter = quad(rate, 0, np.pi / 2, epsabs=1e-13)[0]
    omega = np.pi / 2 / quarter

    def moving(phi: float) -> float:
        return np.cos(phi) * np.cos(omega * quad(rate, 0, phi, epsabs=1e-12)[0]) * rate(phi)

    a = 2 / quarter * quad(moving, 0, np.pi / 2, epsabs=1e-11)[0]
    further = beyond(a, omega, omega0=1.0, cubic=strength)
    assert 1 + 0.75 * strength * a**2 + further.real == pytest.approx(omega**2, rel=2e-7)
    # by Eq. 6 alone it is not
    assert abs(1 + 0.75 * strength * a**2 - omega**2) > 2e-5 * omega**2


def test_what_does_not_bend_needs_no_harmonics():
    assert beyond(1e-3, 80.0, viscous=5.0) == 0.0


def test_a_preload_makes_the_motion_pointed():
    a, omega, preload = 1e-3, 80.0, 0.07
    x = a * np.cos(ANGLE)
    for n in range(3, 201, 2):
        size = 2 * np.mean(preload * np.sign(np.cos(ANGLE)) * np.cos(n * ANGLE)) / ((n**2 - 1) * omega**2)
        x = x + size * np.cos(n * ANGLE)
    assert float(peak_of(np.array(a), np.array(omega), preload)) - a == pytest.approx(np.max(x) - a, rel=1e-3)

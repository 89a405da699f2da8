"""How near to the beginning of a decay its curve begins, and that it is right there."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.ends import with_ends
from dashpot.identify.signals.hilbert import analytic_signal
from dashpot.recording import Recording

FS, OMEGA, H = 1000.0, 2 * np.pi * 12.0, 2.0
TIME = np.arange(4000) / FS


def test_the_ends_are_those_of_a_motion_that_goes_on():
    x = np.exp(-H * TIME) * np.cos(OMEGA * TIME)
    signal = with_ends(analytic_signal(x, FS, by_kernel=True), FS)
    first = slice(0, signal.kernel // 2)
    np.testing.assert_allclose(signal.amplitude[first], np.exp(-H * TIME[first]), rtol=2e-4)
    np.testing.assert_allclose(signal.omega[first], OMEGA, rtol=2e-4)
    np.testing.assert_allclose(signal.growth[first], -H, atol=2e-3 * OMEGA)


def test_a_curve_begins_two_cycles_from_the_beginning():
    a, b = 3e5, 5.0
    x = np.empty(TIME.size)
    position, speed, fine = 0.01, 0.0, 10

    def pull(x: float, v: float) -> float:
        return -(OMEGA**2) * x - a * x**3 - b * v

    step = 1 / FS / fine
    for i in range(TIME.size * fine):  # Runge and Kutta's, of the fourth order
        if i % fine == 0:
            x[i // fine] = position
        k1 = speed, pull(position, speed)
        k2 = speed + step / 2 * k1[1], pull(position + step / 2 * k1[0], speed + step / 2 * k1[1])
        k3 = speed + step / 2 * k2[1], pull(position + step / 2 * k2[0], speed + step / 2 * k2[1])
        k4 = speed + step * k3[1], pull(position + step * k3[0], speed + step * k3[1])
        position += step / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        speed += step / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    x += 1e-6 * np.random.default_rng(0).standard_normal(x.size)
    (curve,) = hilbert_analysis([Recording("ring", FS, x)]).curves
    assert curve.time[0] * 12.0 == pytest.approx(2.0, abs=0.1)
    backbone = np.sqrt(OMEGA**2 + 0.75 * a * curve.amplitude**2)
    start = slice(0, 80)  # a cycle
    np.testing.assert_allclose(curve.omega0[start], backbone[start], rtol=5e-5)

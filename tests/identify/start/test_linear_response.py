"""Linear modes under a force and free: against SciPy's simulation, and derivatives against difference quotients."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.problem.segments import cut
from dashpot.identify.start.linear_response import Signal, linear_response
from dashpot.recording.recording import Recording
from scipy.signal import cont2discrete, dlsim

MODES = ((2 * np.pi * 8.0, 0.02, 0.7), (2 * np.pi * 11.0, 0.04, 0.3))
FS = 300.0
OUTPUTS = {"displacement": 0, "velocity": 1, "acceleration": 2}


def driven(quantity, hold):
    """The exact discrete form of the state space under a force that is held or in straight lines."""
    force = np.random.default_rng(3).standard_normal(900).cumsum()
    force -= force[0]
    shown = np.zeros(force.size)
    for omega, zeta, gain in MODES:
        a = np.array([[0.0, 1.0], [-(omega**2), -2 * zeta * omega]])
        c, d = np.vstack([np.eye(2), a[1]]), np.array([[0.0], [0.0], [gain]])
        plant = cont2discrete((a, np.array([[0.0], [gain]]), c, d), 1 / FS, {"zero": "zoh", "linear": "foh"}[hold])
        shown += dlsim(plant, force)[1][:, OUTPUTS[quantity]]
    return Recording("driven", FS, shown, force, quantity=quantity, hold=hold)


def free(quantity):
    times = np.arange(700) / FS
    poles = [omega * (-zeta + 1j * np.sqrt(1 - zeta**2)) for omega, zeta, _ in MODES]
    shown = sum(np.real(p ** OUTPUTS[quantity] * a * np.exp(p * times)) for p, a in zip(poles, (1, 0.4j), strict=True))
    return Recording("free", FS, shown + 0.3, quantity=quantity)


def logarithms(scale=1.0):
    return np.log([part for omega, z, _ in MODES for part in (scale * omega * np.sqrt(1 - z**2), scale * omega * z)])


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("quantity", OUTPUTS)
def test_true_modes_leave_nothing(quantity, hold):
    segments = cut([driven(quantity, hold), free(quantity)], MODES[0][0])
    found = linear_response([Signal(segment) for segment in segments], logarithms(), drifts=True)
    assert found.gains == pytest.approx([0.7, 0.3], rel=1e-6)
    assert found.cost < 1e-12


@pytest.mark.parametrize("samples_a_cycle", [32.0, 8.0])
@pytest.mark.parametrize("quantity", OUTPUTS)
def test_derivatives_of_what_is_left(quantity, samples_a_cycle):
    """Kaufman's leave out what is of the order of the rest, which is small so near the truth."""
    segments = cut([driven(quantity, "linear"), free(quantity)], MODES[0][0])
    signals = [Signal(segment, samples_a_cycle) for segment in segments]
    theta, h = logarithms(1.00001), 1e-6
    exact = linear_response(signals, theta).jacobian()
    for k, step in enumerate(h * np.eye(theta.size)):
        up, down = (np.concatenate(linear_response(signals, theta + sign * step).rests) for sign in (1.0, -1.0))
        assert np.linalg.norm((up - down) / (2 * h) - exact[:, k]) < 1e-3 * np.linalg.norm(exact[:, k])

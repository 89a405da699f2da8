"""Displacement by integration, against a motion in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.displacement import displacement
from dashpot.recording import Recording
from scipy.signal import lsim, lti

FS, PACE, RATE = 500.0, 2 * np.pi * 10.0, 0.05
TIME = np.arange(4000) / FS


def motion(order: int) -> np.ndarray:
    """The order-th derivative of 5 mm exp(-rate t) cos(pace t)."""
    pole = -RATE + 1j * PACE
    return np.real(5e-3 * pole**order * np.exp(pole * TIME))


def test_a_displacement_is_returned_as_it_is():
    given = Recording("run", FS, motion(0) + 1.0)
    assert np.array_equal(displacement(given).samples, given.response)


@pytest.mark.parametrize("offset", [0.0, 0.3])
@pytest.mark.parametrize(("order", "quantity", "unit"), [(1, "velocity", "m/s"), (2, "acceleration", "m/s2")])
def test_what_is_integrated_is_the_motion_and_an_offset_is_not(order, quantity, unit, offset):
    given = Recording("run", FS, motion(order) + offset * np.std(motion(order)), None, quantity, unit)
    found = displacement(given)
    assert found.fs == FS
    # what an integration adds is known worst at the ends, ten cycles and for the second one thirty
    ends, part = ((500, 0.01), (1500, 0.05))[order - 1]
    assert found.samples[ends:-ends] == pytest.approx(motion(0)[ends:-ends], abs=part * 5e-3)


@pytest.mark.parametrize("noise", [1e-3, 3e-2])
def test_what_is_struck_has_no_motion_slower_than_its_ringing(noise):
    """Four blows that reach from zero upwards: what the integration adds below the ringing is no motion of the rig."""
    fs, omega, ratio = 3000.0, 2 * np.pi * 20.0, 0.02
    t = np.arange(24000) / fs
    force = np.zeros(t.size)
    pulse = np.sin(np.pi * np.arange(12) / 12)
    for at, size in ((600, 1.0), (6900, 0.7), (12300, 1.3), (18300, 0.9)):
        force[at : at + pulse.size] = size * pulse
    system = lti([1.0], [1.0, 2 * ratio * omega, omega**2])
    truth = lsim(system, force, t)[1]
    rate = lsim(lti([1.0, 0.0], [1.0, 2 * ratio * omega, omega**2]), force, t)[1]
    acceleration = force - 2 * ratio * omega * rate - omega**2 * truth
    seen = acceleration + noise * np.std(acceleration) * np.random.default_rng(4).standard_normal(t.size)
    recording = Recording("hits", fs, seen, force, "acceleration", "m/s2")
    found = displacement(recording)
    assert found.frequency == pytest.approx(20.0, rel=0.02)
    ringing = slice(700, 3000)
    assert np.std((found.samples - truth)[ringing]) < 0.05 * np.std(truth[ringing])


@pytest.mark.parametrize(("damping", "seconds"), [(0.04, 1.0), (0.01, 3.0)])
def test_a_decay_that_begins_loud_bends_no_drift_towards_it(damping, seconds):
    """An accelerometer with an offset, plucked: the first half of the decay to 2 %; the drift alone took 40 %."""
    fs, omega = 532.0, 2 * np.pi * 21.0
    t = np.arange(0.0, seconds, 1.0 / fs)
    pole = omega * (-damping + 1j * np.sqrt(1 - damping**2))
    complex_motion = 7e-3 * np.exp(pole * t)
    noise = 0.2 * np.random.default_rng(4).standard_normal(t.size)
    seen = np.real(pole**2 * complex_motion) - 9.0 + noise
    found = displacement(Recording("pluck", fs, seen, quantity="acceleration", unit="m/s2")).samples
    half = t.size // 2
    off = found[:half] - np.real(complex_motion)[:half]
    assert np.std(off) < 0.02 * np.std(np.real(complex_motion)[:half])


@pytest.mark.parametrize(("times", "quantity", "unit"), [(1, "velocity", "m/s"), (2, "acceleration", "m/s2")])
def test_noise_is_that_of_the_slopes_by_the_kernel(times, quantity, unit):
    """Integrated noise of (f / (f + d))^times, weighed as the first derivative of the kernel weighs it."""
    window = np.blackman(301) / np.sum(np.blackman(301))  # three cycles of 100 samples
    apart = np.linspace(-0.8, 2.2, 1501)  # in parts of the frequency; slower is drift
    passed = np.abs(np.exp(-2j * np.pi * np.outer(apart, np.arange(301)) / 100) @ window) ** 2 * apart**2
    colour = np.sqrt(np.sum(passed * (1 + apart) ** (-2.0 * times)) / np.sum(passed))
    noise = 0.01 * np.std(motion(times))
    seen = motion(times) + noise * np.random.default_rng(3).standard_normal(TIME.size)
    found = displacement(Recording("run", FS, seen, quantity=quantity, unit=unit))
    assert found.noise == pytest.approx(colour * noise / PACE**times, rel=0.1)

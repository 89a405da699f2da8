"""One mode more from no start: against the exact response of two linear oscillators to a chirp, and damped cosines."""

from __future__ import annotations

import numpy as np
from dashpot.identify.problem.segments import cut
from dashpot.identify.start.linear_modes import fitted_modes, left_by, one_mode_more
from dashpot.recording.recording import Recording
from scipy.signal import lsim

FIRST, FAR = 2 * np.pi * 8.0, 2 * np.pi * 2.5
NOISE = 3e-3


def chirped():
    """Two modes far apart under a chirp over both, in noise of a small part of the motion."""
    fs, random = 80.0, np.random.default_rng(4)
    times = np.arange(2400) / fs
    force = np.sin(2 * np.pi * (1.0 * times + 0.2 * times**2))
    x = sum(
        gain * lsim(([1.0], [1.0, 2 * z * w, w**2]), force, times)[1]
        for w, z, gain in ((FIRST, 0.014, 1.0), (FAR, 0.009, 0.2))
    )
    size = float(np.std(x))
    return Recording("chirp", fs, x + NOISE * size * random.standard_normal(x.size), force, hold="linear"), size


def test_a_far_mode_is_found_though_the_known_one_is_off():
    recording, size = chirped()
    segments = cut([recording], FIRST)
    known = [(0.985 * FIRST, 0.0145, 1.0)]
    (first, zeta, gain), (far, wide, share) = one_mode_more(segments, known)
    np.testing.assert_allclose([first, far], [FIRST, FAR], rtol=2e-3)
    np.testing.assert_allclose([zeta, wide], [0.014, 0.009], rtol=0.1)
    np.testing.assert_allclose([gain, share], [1.0, 0.2], rtol=0.05)
    left = left_by(segments, [(first, zeta, 0.0), (far, wide, 0.0)])
    assert np.all(np.sqrt(left) < 2 * NOISE * size)
    assert np.all(np.sqrt(left_by(segments, known)) > 20 * NOISE * size)


def test_modes_that_are_shown_are_fitted_from_there():
    times = np.arange(1200) / 60.0
    modes = (2 * np.pi * 5.0, 0.006, 1e-3), (2 * np.pi * 5.35, 0.008, 3e-4)
    x = sum(a * np.exp(-z * w * times) * np.cos(w * np.sqrt(1 - z**2) * times + 0.4) for w, z, a in modes)
    segments = cut([Recording("free", 60.0, x)], modes[0][0])
    shown = [(1.004 * modes[0][0], 0.008, 0.0), (0.996 * modes[1][0], 0.006, 0.0)]
    found = fitted_modes(segments, shown)
    for (omega, zeta, _), (true, damped, _) in zip(found, modes, strict=True):
        assert abs(omega / true - 1) < 1e-5
        assert abs(zeta / damped - 1) < 1e-2

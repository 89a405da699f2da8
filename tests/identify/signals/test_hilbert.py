"""The simulator these tests lean on, and the analytic signal against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.signals.hilbert import analytic_signal, dominant_frequency, noise_level
from scipy.integrate import solve_ivp


def test_simulator_agrees_with_an_event_located_dop853(rigs):
    rig, fs, n = rigs.reference, 1000.0, 500
    x, _ = rigs.simulate(rig, None, fs, n, x0=9e-3)

    def crossing(i, sign):
        def event(t, y, sx, sv):
            return y[i]

        event.terminal, event.direction = True, -sign
        return event

    state, t, sx, sv, best = np.array([9e-3, 0.0]), 0.0, 1.0, -1.0, np.zeros(n)
    grid = np.arange(n) / fs
    while t < grid[-1]:

        def rhs(t, y, sx, sv):
            k = rig.omega0**2 * y[0] + rig.cubic * y[0] ** 3 + rig.preload * sx
            return [y[1], -rig.viscous * y[1] - rig.dry * sv - k]

        run = solve_ivp(
            rhs,
            (t, grid[-1]),
            state,
            "DOP853",
            rtol=1e-11,
            atol=1e-14,
            events=(crossing(0, sx), crossing(1, sv)),
            args=(sx, sv),
            dense_output=True,
        )
        inside = (grid >= t) & (grid <= run.t[-1])
        best[inside] = run.sol(grid[inside])[0]
        t, state = float(run.t[-1]), run.y[:, -1].copy()
        if run.t_events[0].size:
            state[0], sx = 0.0, -sx
        if run.t_events[1].size:
            state[1], sv = 0.0, -sv
    assert np.max(np.abs(x - best)) < 1e-6 * 9e-3


@pytest.mark.parametrize("fs", [127.0, 1000.0])
def test_decaying_chirp_inside_the_ends(fs):
    h, w, rate = 2.5, 2 * np.pi * 12.67, 1.5
    t = np.arange(round(2.5 * fs)) / fs
    x = 0.009 * np.exp(-h * t) * np.cos(w * t + 0.5 * rate * t**2 + 0.4)
    s = analytic_signal(x, fs)
    inside = slice(round(0.16 * fs), -round(0.16 * fs))
    assert np.max(np.abs(s.amplitude / (0.009 * np.exp(-h * t)) - 1)[inside]) < 2e-3
    assert np.max(np.abs(s.omega - (w + rate * t))[inside]) < 2e-4 * w
    assert np.max(np.abs(s.growth + h)[inside]) < 0.02


def test_ends_are_continued_not_wrapped():
    fs, h, w = 1000.0, 2.5, 2 * np.pi * 12.67
    t = np.arange(2000) / fs
    s = analytic_signal(np.exp(-h * t) * np.cos(w * t + 1.0), fs)
    assert np.max(np.abs(s.omega - w)) < 0.005 * w
    assert np.max(np.abs(s.amplitude * np.exp(h * t) - 1)) < 0.02


def test_dominant_frequency_between_bins():
    t = np.arange(1000) / 200.0
    assert dominant_frequency(3 + np.exp(-0.3 * t) * np.sin(2 * np.pi * 7.313 * t), 200.0) == pytest.approx(
        7.313, rel=2e-3
    )


def test_noise_level_under_a_large_signal():
    rng = np.random.default_rng(0)
    t = np.arange(8000) / 1000.0
    x = np.exp(-t) * np.sin(2 * np.pi * 12 * t) + 1e-3 * rng.standard_normal(t.size)
    assert noise_level(x, 1000.0) == pytest.approx(1e-3, rel=0.1)


@pytest.mark.parametrize(
    "x", [np.zeros(500), np.ones(500), np.sin(np.arange(500) * 2.5), np.sin(np.arange(500) * 0.02)]
)
def test_what_has_no_envelope_is_refused(x):
    with pytest.raises(BadInput):
        analytic_signal(x, 100.0)


def test_too_few_swings_are_said_of_the_line_that_was_found():
    """It need not be the rig's: of two cycles and a drift the drift is stronger."""
    with pytest.raises(BadInput, match=r"^The strongest line swings [0-9.]+ times in it, each over [0-9.]+ samples; "):
        analytic_signal(np.sin(2 * np.pi * np.arange(200) / 80), 100.0, frequency=1.25)

"""The reference integrator against closed forms and against scipy."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate, integrate_pieces
from dashpot.examples.taylor import first_root
from dashpot.examples.truth import TRUTH

LINEAR = {"mass": 0.27, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 5.0, "dry": 0.0}


def test_linear_oscillator_follows_the_matrix_exponential():
    from scipy.linalg import expm

    dt, n = 1e-3, 4000
    force = np.random.default_rng(1).standard_normal(n)
    w2, c, m = LINEAR["omega0"] ** 2, LINEAR["viscous"], LINEAR["mass"]
    # State x, v, F, F' : the exact response to a force that is linear between samples.
    step = expm(np.array([[0, 1, 0, 0], [-w2, -c, 1 / m, 0], [0, 0, 0, 1], [0, 0, 0, 0]]) * dt)
    exact = np.zeros((n, 2))
    exact[0] = 1e-3, -0.2
    for k in range(n - 1):
        full = np.array([*exact[k], force[k], (force[k + 1] - force[k]) / dt])
        exact[k + 1] = (step @ full)[:2]
    x, v = integrate(LINEAR, force, dt, 1e-3, -0.2)
    assert np.abs(x - exact[:, 0]).max() < 1e-13 * np.abs(x).max()
    assert np.abs(v - exact[:, 1]).max() < 1e-13 * np.abs(v).max()


@pytest.mark.parametrize("dt", [1e-4, 1e-3, 7e-3, 0.05])
def test_dry_friction_takes_the_same_amplitude_every_half_cycle_and_then_holds(dt):
    law = {**LINEAR, "viscous": 0.0, "dry": 0.3}
    offset = law["dry"] / law["omega0"] ** 2
    start = 8.35 * offset  # stops after four half cycles at +0.35 offset
    n = round(0.3 / dt)
    x, v = integrate(law, np.zeros(n), dt, start, 0.0)
    t = np.arange(n) * dt
    half = np.floor(t * law["omega0"] / np.pi)
    side = np.where(half % 2 == 0, 1.0, -1.0)
    amplitude = start - (2 * half + 1) * offset
    # In a half cycle the motion is a cosine about the side's friction offset.
    exact = side * (offset + amplitude * np.cos(law["omega0"] * t - half * np.pi))
    exact = np.where(half >= 4, 0.35 * offset, exact)
    assert np.abs(x - exact).max() < 1e-13 * start
    assert np.all(v[half >= 4] == 0.0)


def test_preload_keeps_the_period_of_equation_1():
    law = {**LINEAR, "viscous": 0.0, "preload": 3.0}
    amplitude = 0.7 * law["preload"] / law["omega0"] ** 2
    omega = np.pi * law["omega0"] / 2 / np.arccos(1 / (1 + amplitude * law["omega0"] ** 2 / law["preload"]))
    periods = 300
    dt = 2 * np.pi / omega / 7
    x, v = integrate(law, np.zeros(7 * periods + 1), dt, amplitude, 0.0)
    assert np.abs(x[::7] - amplitude).max() < 1e-11 * amplitude
    assert np.abs(v[::7]).max() < 1e-11 * omega * amplitude


def test_duffing_keeps_its_energy():
    law = {**LINEAR, "viscous": 0.0, "cubic": 4.6e8}
    x, v = integrate(law, np.zeros(20_000), 1e-3, 9e-3, 0.0)
    energy = 0.5 * v**2 + 0.5 * law["omega0"] ** 2 * x**2 + 0.25 * law["cubic"] * x**4
    assert np.ptp(energy) < 2e-12 * energy[0]


def test_mass_at_rest_moves_when_force_exceeds_preload_and_friction():
    law = {**LINEAR, "preload": 0.5, "dry": 0.2, "viscous": 0.0}
    dt, slope = 1e-3, 2.0  # N/s
    t = np.arange(400) * dt
    x, _ = integrate(law, slope * t, dt)
    start = law["mass"] * (law["preload"] + law["dry"]) / slope
    # Afterwards x'' + omega0² x = slope (t - start) / mass.
    after = np.maximum(t - start, 0.0)
    w = law["omega0"]
    exact = slope / law["mass"] / w**2 * (after - np.sin(w * after) / w)
    assert np.all(x[t < start] == 0.0)
    assert np.abs(x - exact).max() < 1e-10 * exact.max()


def test_held_away_from_the_origin_until_the_force_lets_go():
    law = {**LINEAR, "preload": 0.1, "dry": 0.5, "viscous": 0.0}
    start = 0.9 * (law["dry"] + law["preload"]) / law["omega0"] ** 2  # springs 0.54 + 0.1 against a grip of 0.5
    held = 0.6 * law["dry"] / law["omega0"] ** 2  # springs 0.3 + 0.1 against 0.5
    assert abs(integrate(law, np.zeros(2), 1e-3, start)[0][-1]) < start
    force = np.linspace(0.0, -0.1, 101)  # releases at -(0.5 - 0.4) 0.27 N = -0.027 N
    x, _ = integrate(law, force, 1e-3, held)
    assert np.all(x[:28] == held)
    assert np.all(np.diff(x[27:60]) < 0.0)


def test_chatter_at_the_origin_ends_at_rest():
    x, v = integrate(TRUTH, np.zeros(5000), 1e-3, 8.5e-3, 0.0)
    moving = np.nonzero(v)[0][-1]
    assert 1000 < moving < 4500
    assert np.all(x[moving + 1 :] == 0.0)
    # Making the step ten times shorter makes the rest decision a hundred times finer, and changes nothing.
    fine, _ = integrate(TRUTH, np.zeros(50_000), 1e-4, 8.5e-3, 0.0)
    assert np.abs(fine[::10] - x).max() < 1e-12 * 8.5e-3


def test_reference_rig_agrees_with_scipy_between_events():
    n, dt = 700, 1e-3
    t = np.arange(n) * dt
    force = 0.3 * np.sin(2 * np.pi * 11.0 * t)
    x, v = integrate(TRUTH, force, dt, 2e-3, 0.0)
    expected = _with_scipy(TRUTH, force, dt, 2e-3)
    assert np.abs(x - expected[:, 0]).max() < 1e-12 * np.abs(x).max()
    assert np.abs(v - expected[:, 1]).max() < 1e-12 * np.abs(v).max()


def _with_scipy(law, force, dt, x0):
    """DOP853 with terminal events, restarted at every sample: the mass never stops here, so signs say it all."""
    from scipy.integrate import solve_ivp

    signs = [1.0, -1.0]  # of x, of v

    def rate(s, y, f0, f1):
        drive = (f0 + (f1 - f0) * s / dt) / law["mass"]
        smooth = law["viscous"] * y[1] + law["omega0"] ** 2 * y[0] + law["cubic"] * y[0] ** 3
        return [y[1], drive - smooth - law["preload"] * signs[0] - law["dry"] * signs[1]]

    def x_is_zero(s, y, *_):
        return y[0]

    def v_is_zero(s, y, *_):
        return y[1]

    x_is_zero.terminal = v_is_zero.terminal = True  # type: ignore[attr-defined]
    y = np.array([x0, 0.0])
    out = [y]
    for f0, f1 in pairwise(force):
        s = 0.0
        while s < dt:
            x_is_zero.direction, v_is_zero.direction = -signs[0], -signs[1]  # type: ignore[attr-defined]
            run = solve_ivp(
                rate, (s, dt), y, "DOP853", events=(x_is_zero, v_is_zero), args=(f0, f1), rtol=1e-12, atol=1e-16
            )
            s, y = run.t[-1], run.y[:, -1]
            for i in (0, 1):
                if run.t_events[i].size:
                    y[i] = 0.0
                    signs[i] = -signs[i]
        out.append(y)
    return np.array(out)


def test_smooth_force_and_its_samples_tell_the_size_of_the_hold():
    """The reference for a held force is not the reference for the smooth one: 0.03 % apart at 13 Hz and 1 kHz."""
    from dashpot.examples.force import chirp

    dt = 1e-3
    pieces = chirp(1.0, 13.0, 0.0, np.arange(2000) * dt, dt)
    smooth, _ = integrate_pieces(TRUTH, pieces[:-1], dt)
    held, _ = integrate(TRUTH, pieces[:, 0], dt)
    hold = (2 * np.pi * 13.0 * dt) ** 2 / 12  # what linear interpolation takes off a sine
    assert np.abs(held - smooth).max() / np.abs(smooth).max() == pytest.approx(hold, rel=0.2)


@pytest.mark.parametrize("pair", [(0.3, 0.300001), (0.123, 0.9), (0.999999, 1.0)])
def test_first_of_two_near_roots_is_found(pair):
    c = list(np.polynomial.polynomial.polyfromroots([*pair, -2.0, 3.5]))
    c = [v * np.sign(c[0]) for v in c]
    assert first_root(c) == pytest.approx(pair[0], abs=1e-10)


def test_near_miss_is_no_root():
    assert first_root([0.25 + 1e-12, -1.0, 1.0]) is None


def test_negative_friction_is_refused():
    with pytest.raises(ValueError, match="negative"):
        integrate({**LINEAR, "dry": -0.1}, np.zeros(3), 1e-3)

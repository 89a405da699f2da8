"""The smoother against forces that were put in by hand, through the engine that is exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.smoother import Smoother
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator
from dashpot.model.oscillator import Response
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force
from scipy.linalg import cho_solve_banded, cholesky_banded

VALUES = {"mass": 0.5, "omega0": 60.0, "cubic": 2e8, "preload": 0.05, "viscous": 1.5, "dry": 0.06}
FS = 600.0


def recorded(model: Oscillator, quantity: str = "displacement", noise: float = 3e-3, seconds: float = 6.0) -> Recording:
    """A sweep over the resonance with white noise, a part of its largest response."""
    model = replace(model, response=Response(quantity, {"displacement": "m", "velocity": "m/s"}.get(quantity, "m/s2")))
    t = np.arange(int(seconds * FS)) / FS
    force = 0.25 * np.sin(2 * np.pi * (7 * t + 5 * t**2 / seconds)) * np.clip(t, 0, 1)
    values = np.array(list(model.values().values()))
    begin = np.zeros(core_of(model).states)
    step = internal_step(model, model.values(), 2e-3)
    response = core_of(model).record(values, begin, smooth_force(force, 1 / FS, 30.0), t.size, 1 / FS, step)
    random = np.random.default_rng(3)
    response = response + noise * np.max(np.abs(response)) * random.standard_normal(t.size)
    return Recording(name="sweep", fs=FS, response=response, force=force, quantity=quantity, unit=model.response.unit)


def smoother_of(family: Oscillator, recording: Recording) -> Smoother:
    family = replace(family, response=Response(recording.quantity, recording.unit))
    return Smoother(family, data_of([recording], family), 0)


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_it_finds_the_drag_that_the_model_lacks(quantity):
    base = Oscillator.from_values(VALUES)
    smoother = smoother_of(base, recorded(with_term(base, "quadratic-drag", {"coefficient": 20.0}), quantity))
    smoothed = smoother.smooth()
    inside = smoothed.moving.copy()
    inside[:100] = inside[-100:] = False
    drag = 20.0 * smoothed.velocity * np.abs(smoothed.velocity)
    assert np.corrcoef(smoothed.force[inside], drag[inside])[0, 1] > 0.93
    assert smoothed.force[inside] @ drag[inside] / (drag[inside] @ drag[inside]) == pytest.approx(1.0, abs=0.06)
    assert np.mean(np.abs(smoothed.force - drag)[inside] < 2 * smoothed.std[inside]) > 0.9


def test_it_finds_nothing_where_nothing_is_missing():
    base = Oscillator.from_values(VALUES)
    smoother = smoother_of(base, recorded(base))
    first, last = smoother.loudest()
    strength, memory = smoother.most_likely(first, last)
    spring = 60.0**2 * 2e-3
    assert strength < 2e-3 * spring
    assert smoother.evidence(strength, memory, first, last) < 0.01 * (last - first)
    assert np.std(smoother.smooth().force) < 1e-3 * spring


@pytest.fixture(scope="module")
def linear():
    """Of a model without signs, so that all is linear."""
    base = Oscillator.from_values(VALUES | {"cubic": 0.0, "preload": 0.0, "dry": 0.0})
    return smoother_of(base, recorded(base))


def written_out(smoother: Smoother, strength: float, memory: float, first: int, last: int):
    """The penalised system, and mean and covariance of all states before anything is seen, written out in full."""
    n = last - first
    system = smoother._system(strength, memory, first, last)
    phi, _ = smoother._blocks(memory, first, last)
    covariance = np.zeros((3 * n, 3 * n))
    mean = np.zeros(3 * n)
    # the prior at the first sample: precision of its diagonal block less what the dynamics and the measurement add
    block = np.zeros((3, 3))
    for i in range(3):
        for j in range(i + 1):
            block[i, j] = block[j, i] = system.band[i - j, j]
    block -= phi[0].T @ system.inverse[0] @ phi[0] + np.outer(system.h[0], system.h[0])
    covariance[:3, :3] = np.diag(1.0 / np.diag(block))
    for k in range(n - 1):
        here, there = slice(3 * k, 3 * k + 3), slice(3 * k + 3, 3 * k + 6)
        covariance[there, : 3 * k + 3] = phi[k] @ covariance[here, : 3 * k + 3]
        covariance[: 3 * k + 3, there] = covariance[there, : 3 * k + 3].T
        covariance[there, there] = phi[k] @ covariance[here, here] @ phi[k].T + np.linalg.inv(system.inverse[k])
        mean[there] = phi[k] @ mean[here] + system.given[k]
    return system, mean, covariance


def test_its_likelihood_is_that_of_the_kalman_filter(linear):
    """Against the covariance of all samples written out for a few of them."""
    first, last = 1500, 1560
    system, mean, covariance = written_out(linear, 0.5, 0.02, first, last)
    seen = system.seen - mean[::3]
    whole = covariance[::3, ::3] + np.eye(last - first)
    exact = -0.5 * (seen @ np.linalg.solve(whole, seen) + np.linalg.slogdet(whole)[1])
    assert linear.log_likelihood(0.5, 0.02, first, last) == pytest.approx(exact, rel=1e-4, abs=0.05)


def test_what_it_finds_in_a_part_is_the_posterior_of_a_gaussian(linear):
    """Conditioned on the samples in one go; of so few, each has its own standard deviation."""
    first, last = 1500, 1520
    system, mean, covariance = written_out(linear, 0.5, 0.02, first, last)
    gain = np.linalg.solve(covariance[::3, ::3] + np.eye(last - first), covariance[::3]).T
    states = mean + gain @ (system.seen - mean[::3])
    left = np.diag(covariance - gain @ covariance[::3])
    unit, dt = linear.sensor, linear.dt
    part = linear.smooth(first, last, prior=(0.5, 0.02))
    assert part.time == pytest.approx(linear.time[first:last])
    assert part.displacement - states[::3] * unit == pytest.approx(linear.x[::4][first:last], abs=1e-5 * unit)
    assert part.velocity - states[1::3] * unit / dt == pytest.approx(linear.v[::4][first:last], abs=1e-5 * unit / dt)
    assert part.force == pytest.approx(states[2::3] * unit / dt**2, rel=1e-4, abs=1e-5)
    assert part.std == pytest.approx(np.sqrt(left[2::3]) * unit / dt**2, rel=1e-4)


def test_its_precision_matrix_has_six_bands(linear):
    """Three states, and those of the next sample: a wider band would only cost time."""
    system = linear._system(0.5, 0.02, 0, 40)
    assert system.band.shape == (6, 3 * 40)
    assert np.all(np.any(system.band, axis=1))


@pytest.mark.parametrize("strength", [0.005, 0.05, 0.5])
def test_where_the_recording_says_nothing_the_force_keeps_its_strength(linear, strength):
    """Two samples do not show a force: its variance is that of a stationary process, at the first and at the next."""
    few = linear.smooth(700, 702, prior=(strength, 0.5))
    assert few.std == pytest.approx(strength, rel=0.01)


@pytest.mark.parametrize("samples", range(1200, 1204))
def test_the_spline_has_fourteen_points_a_cycle_and_none_crowds_the_last(samples, monkeypatch):
    """A point that noise sets beside another one shows as a speed that never was."""
    import scipy.interpolate

    whole = recorded(Oscillator.from_values(VALUES), seconds=3.0)
    short = replace(whole, response=whole.response[:samples], force=np.asarray(whole.force)[:samples])
    drawn = []
    spline = scipy.interpolate.make_interp_spline
    monkeypatch.setattr(
        scipy.interpolate, "make_interp_spline", lambda x, *y, **k: drawn.append(x) or spline(x, *y, **k)
    )
    smoother = smoother_of(Oscillator.from_values(VALUES), short)
    points = drawn[-1]
    step = float(np.median(np.diff(points)))
    assert smoother.period / step >= 14.0
    assert smoother.period / (step + smoother.dt) < 14.0
    assert points[0] == 0.0
    assert points[-1] == pytest.approx((smoother.n - 1) * smoother.dt)
    assert np.min(np.diff(points)) > 0.5 * step * (1 - 1e-9) - 1e-12


@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
def test_the_slopes_are_those_of_the_likelihood(quantity):
    base = Oscillator.from_values(VALUES)
    smoother = smoother_of(base, recorded(with_term(base, "quadratic-drag", {"coefficient": 20.0}), quantity))
    here, step = np.log([0.02 * smoother.scale, 0.02]), 1e-4
    value, slopes = smoother._slopes(*np.exp(here), 200, 1200)
    assert value == pytest.approx(smoother.log_likelihood(*np.exp(here), 200, 1200), rel=1e-12)
    for k in range(2):
        ahead, behind = here + step * np.eye(2)[k], here - step * np.eye(2)[k]
        moved = [smoother.log_likelihood(*np.exp(place), 200, 1200) for place in (ahead, behind)]
        assert slopes[k] == pytest.approx((moved[0] - moved[1]) / (2 * step), rel=1e-3, abs=1e-3)


def test_what_it_would_find_of_a_force_is_what_it_finds_of_the_motion_that_the_force_makes(linear):
    """The motion by the transitions themselves, then smoothed as a measured one."""
    strength, memory, n = 0.5, 0.02, linear.n
    turn = np.linspace(0.0, 80.0, n)
    force = np.column_stack([np.sin(turn), np.sign(np.sin(0.3 * turn))])
    system, (phi, _) = linear._system(strength, memory, 0, n), linear._blocks(memory, 0, n)
    found = linear.makes_of(force, (strength, memory))
    for made, one in zip(found.T, force.T, strict=True):
        states = np.zeros((n, 3))
        states[0, 2] = one[0]
        for k in range(n - 1):
            states[k + 1] = phi[k] @ states[k]
            states[k + 1, 2] = one[k + 1]
        seen = np.sum(system.h * states, axis=1)
        factor = cholesky_banded(system.band, lower=True)
        smoothed = cho_solve_banded((factor, True), system.right(seen, np.zeros((n - 1, 3))))[2::3]
        assert made == pytest.approx(smoothed, abs=1e-5 * np.max(np.abs(one)))
        assert np.std(made) < np.std(one)  # noise hides a part of it

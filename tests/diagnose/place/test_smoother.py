"""The smoother against forces that were put in by hand, through the engine that is exact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.smoother import Smoother
from dashpot.identify.data import data_of
from dashpot.model import Oscillator
from dashpot.model.oscillator import Response
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import smooth_force

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


def test_its_likelihood_is_that_of_the_kalman_filter():
    """Against the covariance of all samples written out for a few of them (no signs, so that all is linear)."""
    base = Oscillator.from_values(VALUES | {"cubic": 0.0, "preload": 0.0, "dry": 0.0})
    smoother = smoother_of(base, recorded(base))
    first, last = 1500, 1560
    strength, memory = 0.5, 0.02
    n = last - first
    system = smoother._system(strength, memory, first, last)
    phi = smoother._blocks(memory, first, last)
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
    seen = system.seen - mean[::3]
    whole = covariance[::3, ::3] + np.eye(n)
    exact = -0.5 * (seen @ np.linalg.solve(whole, seen) + np.linalg.slogdet(whole)[1])
    assert smoother.log_likelihood(strength, memory, first, last) == pytest.approx(exact, rel=1e-4, abs=0.05)

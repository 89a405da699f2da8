"""What is left over: noise of any colour is none of it physics, what moves with the rig is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.residual_test import leftovers, sentence, share_in_step
from dashpot.identify.data import data_of
from dashpot.identify.structure import Structure
from scipy.signal import lfilter


@pytest.fixture(scope="module")
def fitted():
    from ..conftest import concealed

    case = concealed("none")
    data = data_of(case.training, case.model)
    return data, Structure(case.model, data).fit(settle=True)


def with_residuals(data, fit, residuals):
    """The same simulation of recordings that leave these residuals."""
    segments = [
        replace(s, response=s.response - old + new)
        for s, old, new in zip(data.segments, fit.residuals, residuals, strict=True)
    ]
    return replace(fit, residuals=tuple(residuals)), replace(data, segments=tuple(segments))


def coloured(random, n):
    return lfilter([1.0], [1.0, -0.95], random.standard_normal(n))


def stepped(random, n):
    return np.round(random.standard_normal(n)) * 1.0


@pytest.mark.parametrize("noise", [coloured, stepped])
def test_noise_of_any_colour_is_no_mismatch(fitted, noise):
    data, fit = fitted
    random = np.random.default_rng(3)
    residuals = tuple(5 * np.std(r) * noise(random, r.size) for r in fit.residuals)
    left = leftovers(*with_residuals(data, fit, residuals))
    assert max(one.ratio for one in left) > 2
    assert sentence(left) is None


def test_what_grows_with_the_motion_is_a_mismatch(fitted):
    data, fit = fitted
    residuals = tuple(
        r + 0.02 * (segment.response - r) for r, segment in zip(fit.residuals, data.segments, strict=True)
    )
    said = sentence(leftovers(replace(fit, residuals=residuals), data))
    assert said is not None
    assert "growing with the motion" in said


def test_what_keeps_step_with_the_motion_is_a_mismatch_however_large_the_motion_is(fitted):
    data, fit = fitted
    residuals = []
    for segment, r in zip(data.segments, fit.residuals, strict=True):
        speed = np.gradient(segment.response - r)
        residuals.append(r + 1.5 * np.std(r) * np.sign(speed))  # as of play in the sensor
    left = leftovers(*with_residuals(data, fit, residuals))
    assert all(one.in_step > 0.3 and one.is_mismatch for one in left)
    assert "in step with the motion" in (sentence(left) or "") or any(one.with_motion for one in left)


def test_noise_keeps_step_with_nothing(fitted):
    data, fit = fitted
    random = np.random.default_rng(8)
    for segment, r in zip(data.segments, fit.residuals, strict=True):
        motion = segment.response - r
        for _ in range(20):
            assert share_in_step(motion, random.standard_normal(r.size)) == 0.0
            assert share_in_step(motion, coloured(random, r.size)) == 0.0


def test_a_burst_is_a_mismatch(fitted):
    data, fit = fitted
    first = fit.residuals[0].copy()
    first[5000:5200] += 50 * np.std(first)
    left = leftovers(replace(fit, residuals=(first, *fit.residuals[1:])), data)
    assert left[0].burst_s == pytest.approx(data.segments[0].time + 5100 * data.segments[0].dt, rel=0.05)

"""The part of the recordings that all the rest contradicts: where it is, what it costs, when nothing is to blame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.lies import STANDS, Lie, told
from dashpot.examples.measuring_chain import force_gain, response_gain
from dashpot.identify import identify
from dashpot.identify.faults.contradiction import _stands_out, contradiction, covering
from dashpot.identify.faults.part import Part, spans_of
from dashpot.identify.faults.without_part import Level
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.signals.odds import is_noise
from dashpot.model import Oscillator
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

SHORT = replace(STANDS["built-in"], cycles=60.0, fs=400.0)


def fitted(lie, used=slice(None), **fixed):
    """The fit near the truth of some recordings of which one lies, and these."""
    recordings = told(SHORT, lie)[used]
    model = Oscillator.from_values({**SHORT.values, **fixed})
    return maximum_likelihood(model, recordings, tuple(fixed), doubted=False, near=True), recordings


def most_off(fit) -> float:
    parameters = fit.oscillator.parameters()
    return max(abs(p.value - SHORT.values[name]) / p.std for name, p in parameters.items() if p.std)


@pytest.mark.parametrize(
    ("record", "change", "since"),
    [(2, response_gain(1.05, 0.4), 0.4), (1, force_gain(1.1, 0.5), 0.5)],
    ids=["response", "force"],
)
def test_the_part_is_found_where_a_gain_has_changed(record, change, since):
    fit, recordings = fitted(Lie("", "gain", record, change))
    found = contradiction(fit, recordings)
    assert found.part.recording == record
    assert found.other is None
    duration = recordings[record].duration
    assert found.part.begin == pytest.approx(since * duration, abs=duration / 12)
    assert found.part.end == pytest.approx(duration, rel=1e-3)
    # the strong sweep drives as hard as the weak one that lies, and nothing else as hard as the strong one
    assert found.reached == (record == 1)


def test_errors_cover_what_a_lie_does_to_the_parameters():
    fit, recordings = fitted(Lie("", "gain", 1, force_gain(0.8, 0.45)), slice(0, 2))
    assert most_off(fit) > 20.0
    wider = covering(fit, contradiction(fit, recordings).shifts)
    assert most_off(wider) < 3.0
    errors = [p.std for name, p in wider.oscillator.parameters().items() if name in wider.names]
    np.testing.assert_allclose(np.sqrt(np.diag(wider.covariance)), errors)


@pytest.mark.parametrize("since", [0.5, 0.48], ids=["between pieces", "within a piece"])
def test_two_parts_of_which_either_may_be_right_are_both_told(since):
    fit, recordings = fitted(Lie("", "gain", 1, response_gain(0.9, since)), slice(1, 2))
    found = contradiction(fit, recordings)
    assert found.other is not None
    assert found.part.apart_from(found.other)
    assert len(found.shifts) == 2
    assert most_off(covering(fit, found.shifts)) < 3.0


def test_honest_recordings_do_not_contradict_each_other():
    assert contradiction(*fitted(None)) is None


def test_where_physics_is_missing_nothing_is_to_blame():
    fit, recordings = fitted(None, cubic=0.0)
    assert max(s.over_noise for s in fit.segments) > 10.0
    assert contradiction(fit, recordings) is None


def test_what_shows_where_the_motion_is_small_is_not_said_to_be_no_lack_of_physics():
    """A clearance bends the end of a decay alone, which nothing before it reaches down to."""
    omega, peak = 2 * np.pi * 2.0, 3e-3

    def rates(_, z):
        return [z[1], -0.02 * omega * z[1] - omega**2 * (z[0] - 0.3 * np.clip(z[0], -0.1 * peak, 0.1 * peak))]

    times = np.arange(0.0, 20.0, 1 / 120)
    x = solve_ivp(rates, (0, times[-1]), [peak, 0.0], "DOP853", times, rtol=1e-9, atol=1e-12, max_step=0.02).y[0]
    recordings = [Recording("clearance", 120.0, x + 1e-3 * peak * np.random.default_rng(7).standard_normal(x.size))]
    found = contradiction(identify(recordings, doubted=False).fit, recordings)
    assert found is not None
    assert not found.reached


def test_few_independent_values_of_noise_may_be_large_by_chance():
    large = np.array([1.5**2])
    assert is_noise(large, np.array([20.0]))
    assert not is_noise(large, np.array([1000.0]))
    # of a thousand records of noise less than one is beyond, at the level that is known to a tenth
    draws = np.mean(np.random.default_rng(0).standard_normal((1000, 20)) ** 2, axis=1)
    assert sum(not is_noise(np.array([draw]), np.array([20.0])) for draw in draws) <= 1


@pytest.mark.parametrize(
    ("inside", "outside", "stands"), [(1.3, 1.0, True), (1.3, 1.25, False), (1.05, 1.0, False), (1.6, 1.25, True)]
)
def test_a_part_stands_out_where_more_is_left_in_it_than_in_any_other_segment(inside, outside, stands):
    """Noise of a colour is more than its highest frequencies tell, everywhere."""
    fit, _recordings = fitted(None)
    segments = [stretch.segment for stretch in fit.segments]
    span = spans_of(segments)[-1]
    part = Part(span, span.pieces // 2, span.pieces)
    random = np.random.default_rng(0)
    left = []
    for segment in segments:
        times = np.where(part.holds(segment), inside, outside)
        left.append(0.7 * times * random.standard_normal(segment.n))
    assert _stands_out(segments, left, part, [Level(0.7, 1.0)] * len(segments)) is stands

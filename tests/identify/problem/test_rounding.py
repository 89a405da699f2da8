"""Rounding by a converter of few levels: what it does to a sine has a closed form, and the errors of a fit cover it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.lies import STANDS
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.problem.rounding import Rounding, _beyond_white, rounding_of
from dashpot.identify.signals.signals import Signal
from dashpot.model import Oscillator
from scipy.special import j1

FS, N = 500.0, 4000
TURN = 2 * np.pi * 12.3 * np.arange(N) / FS


def rounded(signal, step, level=0.0):
    return step * np.round((signal - level) / step) + level


def test_of_a_sine_it_makes_one_of_another_size_by_its_closed_form():
    step, size = 0.11, 1.0
    rounding = Rounding(step, 0.0, size * np.sin(TURN), 0.0)
    random = np.random.default_rng(0)
    drawn = [2 * np.mean(rounding.error(random) * np.sin(TURN)) for _ in range(300)]
    # Fourier series of the saw that rounding adds, along a sine (Widrow and Kollar 2008)
    sizes, k = np.linspace(size - step / 2, size + step / 2, 400)[:, None], np.arange(1, 200)
    made = 2 * step / (np.pi * k) * j1(2 * np.pi * k * sizes / step)  # times the cosine of where zero lies in a step
    expected = np.sqrt(np.mean(np.sum(made**2, axis=1)) / 2)
    assert np.sqrt(np.mean(np.square(drawn))) == pytest.approx(expected, rel=0.1)
    assert np.std(rounding.error(random)) == pytest.approx(step / np.sqrt(12), rel=0.1)


def test_the_signal_before_is_known_to_a_small_part_of_a_step():
    rounding = rounding_of(Signal(rounded(np.sin(TURN), 0.11, 0.04), FS))
    assert rounding.step == pytest.approx(0.11)
    assert np.std(rounding.smooth - np.sin(TURN)) < 0.1 * 0.11
    assert (rounding.level - 0.04) / 0.11 == pytest.approx(round((rounding.level - 0.04) / 0.11))
    assert rounding.noise < 1e-3 * rounding.step


def test_of_a_signal_that_crosses_many_levels_it_is_as_good_as_noise():
    """Nothing is counted twice; of one that stays between two levels for long, what its place there does is counted."""
    step, rows = 2e-3, np.vstack([np.cos(TURN), np.ones(N)])
    crosses, rests = (
        [Rounding(step, 0.0, smooth, 0.0).error(np.random.default_rng(draw)) for draw in range(60)]
        for smooth in (np.sin(TURN) * (1 + 0.3 * np.sin(0.17 * TURN)), np.zeros(N))
    )
    assert not np.any(_beyond_white(np.array(crosses) @ rows.T, step, rows))
    scatter = _beyond_white(np.array(rests) @ rows.T, step, rows)
    assert np.sqrt(scatter[1, 1]) == pytest.approx(N * step / np.sqrt(12), rel=0.15)


@pytest.mark.parametrize(("noise", "keeps_step"), [(0.4, True), (0.6, False)])
def test_noise_of_half_a_step_makes_it_white(noise, keeps_step):
    step = 0.02
    signal = np.sin(TURN) + noise * step * np.random.default_rng(1).standard_normal(N)
    assert (rounding_of(Signal(rounded(signal, step), FS)) is not None) == keeps_step


def test_what_was_never_rounded_has_none():
    assert rounding_of(Signal(np.sin(TURN), FS)) is None


@pytest.mark.parametrize(
    ("channel", "levels", "before"), [("force", 32, 5.0), pytest.param("response", 16, 4.0, marks=pytest.mark.long)]
)
def test_errors_of_parameters_cover_it(channel, levels, before, monkeypatch):
    """Without it no parameter's error says how far it is off."""
    stand = STANDS["slow"]

    def coarse(recording):
        signal = getattr(recording, channel)
        return (
            recording if signal is None else replace(recording, **{channel: rounded(signal, np.ptp(signal) / levels)})
        )

    recordings = [coarse(recording) for recording in stand.noisy(stand.clean(), 1)]
    start = Oscillator.from_values(dict(stand.values))

    def worst():
        parameters = maximum_likelihood(start, recordings, doubted=False, near=True).oscillator.parameters()
        return max(abs(p.value - stand.values[name]) / p.std for name, p in parameters.items() if p.std)

    assert worst() < 3.0
    monkeypatch.setattr("dashpot.identify.fit.scatter.scatter_of_rounding", lambda *_: 0.0)
    assert worst() > before

"""What kind of force a recording holds."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decay import Decay
from dashpot.identify.motion.excitation import band_of, kind_of
from dashpot.recording import Recording

FS, SECONDS = 200.0, 24.0
TIME = np.arange(round(FS * SECONDS)) / FS


def under(force):
    return Recording("run", FS, np.cos(TIME), force)


def sweep(first, last):
    return np.sin(2 * np.pi * (first * TIME + 0.5 * (last - first) / SECONDS * TIME**2))


@pytest.mark.parametrize(
    ("force", "kind"),
    [
        (None, "decay"),
        (np.zeros(TIME.size), "decay"),
        (sweep(10.0, 10.0), "sine"),
        (sweep(10.0, 11.5), "sine"),  # a line that wanders by less than a fifth
        (sweep(10.0, 13.0), "sweep"),
        (sweep(30.0, 10.0), "sweep"),
        (np.random.default_rng(0).standard_normal(TIME.size), "broadband"),
        (sweep(10.0, 10.0) + sweep(30.0, 30.0), "broadband"),
    ],
)
def test_the_kind_is_told_by_the_signal(force, kind):
    assert kind_of(under(force), ()) == kind


@pytest.mark.parametrize(("part", "broad"), [(0.75, True), (0.9, False)])
def test_four_fifths_of_what_is_no_noise_are_narrow(part, broad):
    noise = np.random.default_rng(0).standard_normal(TIME.size)
    assert (kind_of(under(np.where(part * SECONDS > TIME, sweep(10.0, 10.0), noise)), ()) == "broadband") is broad


@pytest.mark.parametrize("level", [0.01, 0.1])
def test_a_sweep_with_noise_on_its_force_is_a_sweep_where_the_noise_is_known(level):
    noise = level * np.random.default_rng(2).standard_normal(TIME.size)
    assert kind_of(under(sweep(5.0, 20.0) + noise), (), level) == "sweep"
    assert kind_of(under(noise), (), level) == "broadband"
    slow = np.convolve(noise, np.ones(9) / 3, mode="same")
    assert kind_of(under(slow + 0.001 * noise), (), 0.001 * level) == "broadband"


def test_pauses_count_for_nothing():
    assert kind_of(under(np.where(TIME < 12.0, sweep(10.0, 10.0), 0.0)), ()) == "sine"


def test_what_is_driven_and_let_go_is_in_bursts():
    assert kind_of(under(sweep(10.0, 10.0)), [Decay(100, 200)]) == "bursts"
    assert kind_of(under(None), [Decay(100, 200)]) == "decay"


def test_a_force_has_a_band_and_free_motion_none():
    assert band_of(under(None)) is None
    assert band_of(under(np.zeros(TIME.size))) is None
    band = band_of(under(sweep(10.0, 20.0)))
    assert band == pytest.approx((10.0, 20.0), rel=0.05)


@pytest.mark.parametrize("seconds", [1.0, 2.0, 6.0])
def test_a_short_sweep_is_one_and_as_short_a_multisine_is_none(seconds):
    time = np.arange(round(1000 * seconds)) / 1000
    noise = 0.01 * np.random.default_rng(3).standard_normal(time.size)
    swept = np.sin(2 * np.pi * (5.0 * time + 7.5 / seconds * time**2)) + noise
    lines = np.arange(np.ceil(5 * seconds), 20 * seconds) / seconds
    phases = np.random.default_rng(4).uniform(0, 2 * np.pi, lines.size)
    many = np.cos(2 * np.pi * np.outer(time, lines) + phases).sum(1) / np.sqrt(lines.size) + noise
    kinds = [kind_of(Recording("run", 1000.0, np.cos(time), force), (), 0.01) for force in (swept, many)]
    assert kinds == ["sweep", "broadband"]

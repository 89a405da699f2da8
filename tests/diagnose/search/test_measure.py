"""The measure in which structures are compared: by one spectrum, at levels of each one's own."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.measure import Measure, measure_by
from dashpot.diagnose.search.residual_test import leftovers
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data
from dashpot.identify.problem.segments import Segment
from dashpot.identify.problem.structure import Fitted
from dashpot.model import Oscillator
from dashpot.model.law import Scales

MODEL = Oscillator.from_values(TRUTH)
PER_CYCLE, NOISE = 40, 1e-5
DT = 2 * np.pi / TRUTH["omega0"] / PER_CYCLE
#: Cycles of a stretch that is long enough to show how what is left moves with the rig, and of one that is not.
LONG, SHORT = 100, 8


def motion_of(cycles: int) -> np.ndarray:
    """(n,) a motion of one frequency that swells twice."""
    n = cycles * PER_CYCLE
    swell = 0.55 - 0.45 * np.cos(4 * np.pi * np.arange(n) / n)
    return 1e-3 * swell * np.cos(2 * np.pi * np.arange(n) / PER_CYCLE + 0.2)


def leaving(*left: np.ndarray) -> tuple[Fitted, Data]:
    """What leaves these beside free motions of as many samples, on a sensor whose noise is known."""
    segments = [
        Segment(i, 0, r.size, motion_of(r.size // PER_CYCLE) + np.nan_to_num(r), None, DT, 0.0, TRUTH["omega0"])
        for i, r in enumerate(left)
    ]
    recordings = tuple(SimpleNamespace(name=f"run {i}") for i in range(len(left)))
    scales = Scales(length=1e-3, omega=TRUTH["omega0"], force=0.0, response=1e-3, duration=10.0)
    levels = (NOISE,) * len(left), (0.0,) * len(left)
    data = Data(recordings, tuple(segments), *levels, scales)  # type: ignore[arg-type]
    return Fitted(MODEL, np.zeros((len(left), 2)), left, 0.0, ()), data


def white(times: float = 1.0, cycles: int = LONG, seed: int = 0) -> np.ndarray:
    """Noise of exactly so many times the sensor's."""
    noise = np.random.default_rng(seed).standard_normal(cycles * PER_CYCLE)
    return times * NOISE * noise / np.sqrt(np.mean(noise**2))


def swinging(times: float, cycles: int = LONG) -> np.ndarray:
    """So many times the noise, what is beyond it in step with the motion."""
    motion, noise = motion_of(cycles), white(cycles=cycles)
    motion -= (motion @ noise) / (noise @ noise) * noise
    return noise + NOISE * np.sqrt(times**2 - 1.0) * motion / np.sqrt(np.mean(motion**2))


def coloured(times: float, cycles: int = LONG) -> np.ndarray:
    """Slow noise that does not know of the motion."""
    drive = np.random.default_rng(5).standard_normal(cycles * PER_CYCLE + 49)
    noise = np.convolve(drive, 0.9 ** np.arange(50), mode="valid")
    return times * NOISE * noise / np.sqrt(np.mean(noise**2))


def gives_a_spectrum(*left: np.ndarray) -> bool:
    return measure_by(*leaving(*left)).noise is not None


# --- what is noise


@pytest.mark.parametrize(("times", "noise"), [(1.19, True), (1.21, False), (5.0, False)])
def test_what_moves_with_the_rig_is_noise_up_to_a_limit(times, noise):
    left = swinging(times)
    assert leftovers(*leaving(left))[0].is_mismatch
    assert gives_a_spectrum(left) is noise


def test_what_moves_with_the_rig_in_one_recording_is_none_in_any():
    assert gives_a_spectrum(white(), white(seed=1))
    assert not gives_a_spectrum(white(), swinging(1.5))
    assert not gives_a_spectrum(swinging(1.5), white())


def test_noise_of_another_colour_is_noise_however_loud():
    left = coloured(5.0)
    assert not leftovers(*leaving(left))[0].is_mismatch
    assert gives_a_spectrum(left)
    assert gives_a_spectrum(left, white())


@pytest.mark.parametrize(("times", "noise"), [(1.0, True), (1.19, True), (1.21, False)])
def test_a_stretch_too_short_to_show_how_it_moves_is_noise_by_its_size_alone(times, noise):
    left = coloured(5.0), white(times, cycles=SHORT)
    assert [part.short for part in leftovers(*leaving(*left))] == [False, True]
    assert gives_a_spectrum(*left) is noise


def test_what_does_not_simulate_gives_no_measure():
    gone = np.full(LONG * PER_CYCLE, np.nan)
    assert not gives_a_spectrum(gone)
    assert not gives_a_spectrum(white(), gone)
    assert not gives_a_spectrum(gone, white())


# --- the measure


def test_as_long_as_no_noise_is_known_only_power_counts():
    """Quiet frequencies that are made quieter gain nothing beside the motion."""
    t = np.arange(4000) / 400.0
    random = np.random.default_rng(1)
    motion, hiss = np.sin(40.0 * t), 1e-2 * random.standard_normal(t.size)
    loud, quiet = motion + hiss, 1.01 * motion + 1e-3 * hiss
    assert Measure().value([loud]) > Measure().value([quiet])
    assert Measure().value([loud]) == pytest.approx(-0.5 * t.size * np.log(np.mean(loud**2)))
    assert Measure().values([loud, quiet]) == pytest.approx([Measure().value([loud]), Measure().value([quiet])])
    assert Measure().value([loud, quiet]) == pytest.approx(Measure().value([loud]) + Measure().value([quiet]))


def test_without_a_spectrum_each_stretch_is_as_loud_as_what_is_left():
    """Per sample, at every frequency."""
    for spectrum, times in zip(Measure().spectra([white(2.0), white(3.0)]), (2.0, 3.0), strict=True):
        assert spectrum.density == pytest.approx((times * NOISE) ** 2, rel=1e-6)


def test_one_spectrum_holds_for_all():
    fit, data = leaving(white(), coloured(2.0))
    measure = measure_by(fit, data)
    assert measure.value(fit.residuals) == pytest.approx(0.0, abs=0.02 * data.points)
    twice = [2.0 * residual for residual in fit.residuals]
    assert measure.value(fit.residuals) - measure.value(twice) == pytest.approx(data.points * np.log(2.0))
    for own, given in zip(measure.spectra(twice), measure.spectra(fit.residuals), strict=True):
        assert np.allclose(own.density, 4.0 * given.density)


def test_the_frequencies_are_weighed_by_the_noise():
    """As much again where the noise is quiet takes more away than where it is loud."""
    noise = coloured(2.0)
    fit, data = leaving(noise)
    measure = measure_by(fit, data)
    turns = np.arange(noise.size)
    slow, fast = (noise + NOISE * np.cos(rate * turns) for rate in (0.05, 2.5))
    assert Measure().value([slow]) == pytest.approx(Measure().value([fast]), abs=0.05 * data.points)
    assert measure.value([slow]) > measure.value([fast]) + 0.1 * data.points


def test_a_level_is_a_level_of_its_stretch():
    """What is left in one stretch says nothing of another's noise."""
    fit, data = leaving(white(), white(seed=1))
    measure = measure_by(fit, data)
    louder = [fit.residuals[0], 3.0 * fit.residuals[1]]
    first, second = measure.values(fit.residuals)
    assert measure.values(louder) == pytest.approx([first, second - fit.residuals[1].size * np.log(3.0)])


@pytest.mark.parametrize("factor", [0.0, 1e-200])
def test_what_leaves_nothing_has_a_value_all_the_same(factor):
    value = Measure().value([factor * white()])
    assert np.isfinite(value)
    assert value > Measure().value([1e-100 * white()])


def test_what_does_not_simulate_is_never_the_better():
    gone = np.full(LONG * PER_CYCLE, np.nan)
    assert Measure().value([gone]) == -np.inf
    assert Measure().value([white(), gone]) == -np.inf
    assert np.isfinite(Measure().value([white()]))


# --- nearness


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize(("times", "near"), [(0.5, True), (1.19, True), (1.21, False)])
def test_what_is_about_the_noise_in_every_stretch_is_near_it(known, times, near):
    """In size: by the sensor's noise, and once a spectrum is known by that."""
    fit, data = leaving(white(), white(seed=1))
    measure = Measure(tuple(Measure().spectra(fit.residuals))) if known else Measure()
    for left in ([times, 1.0], [1.0, times]):
        residuals = [factor * residual for factor, residual in zip(left, fit.residuals, strict=True)]
        assert measure.near(residuals, MODEL, data) is near

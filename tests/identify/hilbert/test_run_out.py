"""The end of a decay that dry friction stops, against closed forms and the independent integrator."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import hilbert_analysis
from dashpot.identify.hilbert.modal_fit import spring_and_friction
from dashpot.identify.hilbert.modal_mass import MassFit
from dashpot.identify.hilbert.modal_stretch import Stretch, decay_stretch
from dashpot.identify.hilbert.run_out import before_stop, held, time_to_stop
from dashpot.identify.signals.signals import Signal

#: Stops after 2.5 s, 20 cycles behind the last that the noise would hide.
RUBBING = {**TRUTH, "viscous": 2.0, "dry": 0.3, "preload": 0.0}


def decay_of(values: dict[str, float], seconds: float, noise: float = 1e-6) -> Stretch:
    recording = recording_of(values, begin=(8e-3, 0.0), fs=1000.0, seconds=seconds, noise=noise)
    return decay_stretch(Signal(recording.response, recording.fs))


@pytest.fixture(scope="module")
def rubbing() -> Stretch:
    return decay_of(RUBBING, 1.6)


def test_an_envelope_takes_as_long_as_its_equation_says():
    amplitude, omega, dry = 8e-3, 80.0, 0.3
    for viscous in (0.0, 2.0, 20.0):
        a, steps = amplitude, 200_000
        expected = time_to_stop(np.array([amplitude]), np.array([omega]), viscous, dry)[0]
        step = expected / steps
        for _ in range(steps):  # the midpoint rule; the last step ends at nothing
            slope = -0.5 * viscous * a - 2 * dry / (np.pi * omega)
            a += step * (-0.5 * viscous * (a + 0.5 * step * slope) - 2 * dry / (np.pi * omega))
        assert abs(a) < 1e-5 * amplitude
    assert time_to_stop(np.array([-1e-3]), np.array([omega]), 2.0, dry)[0] == 0.0


def test_a_preload_leaves_less_room_for_friction_to_hold():
    assert held(100.0, 0.0, 0.3) == pytest.approx(3e-3)
    assert held(100.0, 0.1, 0.3) == pytest.approx(2e-3)
    assert held(100.0, 0.4, 0.3) == 0.0


def test_what_leans_on_the_stop_is_left_out_and_no_more(rubbing: Stretch):
    left = before_stop(rubbing)
    reach = (rubbing.signal.kernel + rubbing.low_pass_kernel.size / 2) / rubbing.fs
    assert 0 < left.run_out / rubbing.fs < 2 * reach
    whole, part = (
        [np.max(np.abs(fit.left()[0])) for fit in spring_and_friction([s], MassFit(rows=(np.zeros(0),)))]
        for s in (rubbing, left)
    )
    assert max(whole) > 10.0  # standard errors of a point
    assert max(part) < 5.0


def test_a_decay_that_sinks_into_its_noise_first_is_left_whole():
    for noise in (1e-6, 1e-5):
        decay = decay_of({**TRUTH, "dry": 1e-3}, 3.0, noise)
        assert before_stop(decay).run_out == 0


def test_the_errors_of_a_decay_that_friction_stops_hold():
    off = []
    for seed in range(4):
        recording = recording_of(RUBBING, begin=(8e-3, 0.0), fs=1000.0, seconds=4.0, noise=2e-6, seed=seed)
        analysis = hilbert_analysis([recording])
        fit = analysis.freevib
        assert fit is not None
        assert fit.has_errors
        assert analysis.curves[0].cut > 0.0
        off += [(fit.values[name] - RUBBING[name]) / fit.stds[name] for name in fit.values]
    assert np.max(np.abs(off)) < 4.0
    assert np.sqrt(np.mean(np.square(off))) < 2.0

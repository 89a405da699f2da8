"""Work is counted: runs, samples, those with derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.work import Meter, Work


def test_every_run_is_counted_with_its_samples():
    model = Oscillator.from_values(TRUTH)
    core, values = core_of(model), np.array(list(model.values().values()))
    run = (values, np.array([5e-3, 0.0]), None, 400, 1e-3, internal_step(model, model.values(), 5e-3))
    meter, later = Meter(), Meter()
    core.record(*run)
    core.record_with_derivatives(*run, by=[0, 1])
    core.record_with_derivatives(*run, by=list(range(9)))
    work = meter.read(800)
    assert (work.simulated, work.with_derivatives, work.fits) == (1200, 800, 0)
    assert work.times == pytest.approx(1.5)
    assert later.read(800).simulated == 1200
    assert Meter().read(800).simulated == 0


def test_it_is_told_in_one_line_and_as_numbers():
    work = Work(64_403, 9_145_226, 3_220_150, 21, 3.04, 4.12)
    assert str(work) == (
        "work: 142 times the recordings, 9.15 M samples (50 times with derivatives), 21 fits, 4.1 s of which 3.0 s "
        "simulating"
    )
    assert work.as_json() == {
        "times_the_recordings": pytest.approx(142.0, abs=0.01),
        "recorded_samples": 64_403,
        "simulated_samples": 9_145_226,
        "with_derivatives": 3_220_150,
        "fits": 21,
        "seconds_simulating": 3.04,
        "seconds": 4.12,
    }

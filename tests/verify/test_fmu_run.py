"""A run that the FMU ends: how far it came is known, and another start may still be found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.virtual_recording import recording_of
from dashpot.export import export
from dashpot.identify.problem.replay import force_of, replay
from dashpot.model import Oscillator, Response
from dashpot.verify.fmu_run import FmuRun, FmuStopped
from dashpot.verify.verification import verify

#: The spring pulls back up to 10 mm: sqrt(omega0² / -cubic).
SOFTENING = {"mass": 0.3, "omega0": 60.0, "cubic": -3.6e7, "viscous": 6.0, "dry": 0.0, "preload": 0.0}


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    path = tmp_path_factory.mktemp("softening") / "rig.fmu"
    export(Oscillator.from_values(SOFTENING, response=Response("displacement", "m")), path)
    return path


def test_how_far_it_came_is_known(fmu):
    with FmuRun(fmu) as run:
        with pytest.raises(FmuStopped, match="grows beyond bounds") as raised:
            run.record(None, 2000, 1e-3, np.array([0.0101, 0.0]))
        reached = raised.value.reached
        within = run.record(None, 2000, 1e-3, np.array([0.0099, 0.0]))  # it goes on after that
    lasts = int(np.argmax(~np.isfinite(reached)))
    assert 10 < lasts < 2000
    assert np.all(np.isnan(reached[lasts:]))
    assert np.all(np.diff(reached[:lasts]) > 0)
    assert np.max(np.abs(within)) < 0.01


def loaded():
    """A sweep whose load cell shows 4.5 N at zero: with that as a force the mass is pushed over the edge."""
    sweep = recording_of(values=SOFTENING, sweep=(0.3, 2.0, 14.0), fs=500.0, seconds=10.0, noise=2e-6, name="sweep.csv")
    assert sweep.force is not None
    return replace(sweep, force=sweep.force + 4.5)


def test_a_start_from_which_the_motion_runs_away_is_no_end(fmu):
    recording = loaded()
    with FmuRun(fmu) as run, pytest.raises(FmuStopped):
        run.record(force_of(recording), recording.n, recording.dt)
    (check,) = verify(fmu, [recording]).recordings
    own = replay(Oscillator.from_values(SOFTENING, response=Response("displacement", "m")), recording)
    assert check.nrmse == pytest.approx(np.std(own - recording.response) / np.std(recording.response), rel=0.05)
    assert check.nrmse < 0.02
    assert any("load cell shows 4.5" in word for word in check.besides)


def test_where_it_runs_away_from_each_it_is_said(fmu):
    far = recording_of(values=SOFTENING | {"cubic": 0.0}, sweep=(40.0, 5.0, 14.0), fs=500.0, seconds=6.0, noise=2e-6)
    with pytest.raises(BadInput, match="grows beyond bounds"):
        verify(fmu, [far])

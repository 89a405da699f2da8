"""What a load cell shows at zero, and the drift of a sensor: found where they are, and not where they are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.recording import Recording

FORCE, OFFSET = 1.5, 25e-3


def good(identification, names=TRUTH):
    known = identification.oscillator.parameters()
    return {n: (known[n].value - TRUTH[n]) / known[n].std for n in names if n in known and known[n].std is not None}


@pytest.fixture(scope="module")
def sweep(recorded):
    return recorded(sweep=(1.0, 5.0, 20.0), seconds=10.0, name="sweep")


def channels(identification):
    return {offset.channel: offset for offset in identification.fit.offsets}


def test_a_load_cell_and_a_sensor_that_sit_elsewhere(sweep):
    moved = replace(sweep, response=np.asarray(sweep.response) + OFFSET, force=np.asarray(sweep.force) + FORCE)
    identification = identify([moved])
    shown = channels(identification)
    assert set(shown) == {"force", "response"}
    assert abs(shown["force"].value - FORCE) < 3 * shown["force"].std < 0.1 * FORCE
    assert abs(shown["response"].value - OFFSET) < 3 * shown["response"].std < 0.1 * OFFSET
    scores = good(identification)
    assert len(scores) == 6
    assert max(abs(score) for score in scores.values()) < 3
    assert sum("the force sensor shows" in note for note in identification.notes) == 1


def test_neither_is_found_where_there_is_none(sweep):
    assert channels(identify([sweep])) == {}


@pytest.mark.parametrize("drift", [2e-4, -2e-4])
def test_a_drift_of_a_decay(recorded, drift):
    decay = recorded(begin=(5e-3, 0.0), seconds=3.0, name="decay")
    line = drift * (np.asarray(decay.time) - 1.0)
    identification = identify([replace(decay, response=np.asarray(decay.response) + line)])
    shown = channels(identification)
    assert abs(shown["drift"].value - drift) < 3.5 * shown["drift"].std < 0.3 * abs(drift)
    assert max(abs(score) for score in good(identification).values()) < 4
    assert sum("drifts by" in note for note in identification.notes) == 1


def test_no_drift_is_found_in_decays_without():
    fs, n, w, h = 400.0, 800, TRUTH["omega0"], TRUTH["viscous"] / 2
    t, damped = np.arange(n) / fs, np.sqrt(w**2 - h**2)
    x = 5e-3 * np.exp(-h * t) * (np.cos(damped * t) + h / damped * np.sin(damped * t))
    random = np.random.default_rng(3)
    several = [Recording(f"d{i}", fs, x + 5e-6 * random.standard_normal(n), free=True) for i in range(8)]
    assert channels(identify(several)) == {}

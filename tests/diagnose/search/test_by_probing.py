"""Places for a law with side valleys: the paper's play, from short bursts alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dashpot import examples
from dashpot.diagnose.search import by_prediction
from dashpot.diagnose.search.by_prediction import by_probing
from dashpot.examples.truth import ACTUATOR, TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.identify.start.measured_motion import Regression
from dashpot.model import Oscillator
from dashpot.model.library import find
from dashpot.recording import read

PLAY = find("actuator-backlash")
STANDS = Oscillator.from_values(TRUTH, name="what stands")


@pytest.fixture(scope="module")
def bursts() -> tuple[Fitted, Data]:
    """The family at its best on the bursts of the stand with play."""
    recording = read(Path(examples.__file__).parent / "recordings" / "paper-stand-backlash" / "bursts.csv.gz")
    model = Oscillator.from_values(TRUTH)
    data = data_of([recording], model)
    return Structure(model, data).fit(), data


@pytest.mark.long
def test_what_short_bursts_hide_from_the_regression_a_prediction_shows(bursts):
    fitted, data = bursts
    regression = Regression(data, fitted.model)
    guess = regression.best(PLAY)
    assert guess is None or guess.values["actuator-backlash.gap"] < 0.5 * ACTUATOR["half_gap"]  # the play is not seen
    proposals = by_probing(fitted, fitted, data, [PLAY])
    assert 1 <= len(proposals) <= by_prediction._KEPT
    assert all(p.law == PLAY.name and p.gain > 1000.0 and p.initial is None for p in proposals)
    found = max(proposals, key=lambda proposal: proposal.gain).model.values()
    assert found["actuator-backlash.gap"] == pytest.approx(ACTUATOR["half_gap"], rel=0.2)
    assert found["actuator-backlash.mass"] == pytest.approx(ACTUATOR["moving_mass"], rel=0.05)  # a start, not a fit
    assert found["mass"] == pytest.approx(TRUTH["mass"] - ACTUATOR["moving_mass"], rel=0.01)


def test_free_motion_has_nothing_to_probe_with(bursts):
    fitted, data = bursts
    free = [i for i, segment in enumerate(data.segments) if segment.force is None]
    decays = replace(
        data,
        segments=tuple(data.segments[i] for i in free),
        sensor=tuple(data.sensor[i] for i in free),
        force=tuple(data.force[i] for i in free),
    )
    assert by_probing(fitted, fitted, decays, [PLAY]) == []


def test_the_loudest_segments_are_simulated(bursts, monkeypatch):
    _, data = bursts
    monkeypatch.setattr(by_prediction, "_SAMPLES", data.points)
    assert by_prediction._loudest(data).segments == data.segments
    monkeypatch.setattr(by_prediction, "_SAMPLES", 4000)
    loudest = by_prediction._loudest(data)
    least = min(float(np.std(segment.response)) for segment in loudest.segments)
    left = [segment for segment in data.segments if segment not in loudest.segments]
    assert 4000 <= loudest.points < 4000 + max(segment.n for segment in data.segments)
    assert all(float(np.std(segment.response)) <= least for segment in left)
    assert list(loudest.segments) == sorted(loudest.segments, key=lambda segment: segment.start)


def test_beside_a_family_that_does_not_simulate_nothing_is_gained(bursts):
    fitted, data = bursts
    known = fitted.model.parameters()
    lost = replace(known["cubic"], value=-1e12)  # runs away
    runaway = replace(fitted, model=fitted.model.with_parameters({"cubic": lost}))
    assert by_probing(runaway, fitted, data, [PLAY]) == by_probing(fitted, runaway, data, [PLAY]) == []


def test_what_predicts_worse_than_what_stands_is_not_simulated(bursts, monkeypatch):
    fitted, data = bursts
    better = replace(fitted, likelihood=fitted.likelihood + 1.0)
    monkeypatch.setattr(by_prediction, "_step", lambda model, initial, part: better if model is STANDS else fitted)
    monkeypatch.setattr(by_prediction, "continued", None)  # is not called
    assert by_probing(fitted, replace(fitted, model=STANDS), data, [PLAY]) == []


def test_a_probe_that_does_not_simulate_is_passed_over(bursts, monkeypatch):
    fitted, data = bursts
    taken = []

    def steps(model, initial, part):
        taken.append(model)
        return None if len(taken) > 2 else fitted

    monkeypatch.setattr(by_prediction, "_step", steps)
    assert by_probing(fitted, fitted, data, [PLAY]) == []
    assert len(taken) == 2 + 54  # the family, what stands, and every probe once

"""Starts from the measured motion: forces of unknown phase, and an actuator that plays."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from dashpot import examples
from dashpot.examples.truth import ACTUATOR, TRUTH
from dashpot.identify.data import data_of
from dashpot.identify.measured_motion import Guess, Regression
from dashpot.model import Oscillator
from dashpot.model.laws import find
from dashpot.recording import read


@pytest.mark.long
def test_a_periodic_force_is_found_with_its_amplitude_whatever_its_phases(rig):
    case = rig("single", "tonal-disturbance")
    data = data_of(case.training, case.model)
    data = replace(data, scales=replace(data.scales, lines=(1.0005 * case.truth["parameters"]["tone_omega"],)))
    regression = Regression(data, case.model)
    guess = regression.best(find("tonal-disturbance"))
    assert guess is not None
    assert guess.values["tonal-disturbance.amplitude"] == pytest.approx(case.truth["parameters"]["tone"], rel=0.1)
    assert guess.misfit < 0.5 * regression.plain()
    assert len(set(guess.phases.values())) == len(regression.rows)


def test_play_in_the_papers_stand_is_seen_in_the_measured_motion():
    folder = Path(examples.__file__).parent / "recordings" / "paper-stand-backlash"
    recordings = [read(folder / f"{name}.csv.gz") for name in ("bursts", "sweep_low")]
    model = Oscillator.from_values(TRUTH)
    regression = Regression(data_of(recordings, model), model)
    guess = regression.best(find("actuator-backlash"))
    assert guess is not None
    assert guess.misfit < 0.3 * regression.plain()
    assert guess.values["actuator-backlash.gap"] == pytest.approx(ACTUATOR["half_gap"], rel=0.2)
    assert guess.values["actuator-backlash.mass"] == pytest.approx(ACTUATOR["moving_mass"], rel=0.25)
    assert guess.values["mass"] == pytest.approx(TRUTH["mass"] - ACTUATOR["moving_mass"], rel=0.05)


@pytest.mark.long
def test_a_contact_is_found_where_it_is_and_as_stiff_as_it_is(rig):
    """Its place moves between the probes, the contact without damping there as at all of them."""
    case = rig("single", "one-sided-stop")
    regression = Regression(data_of(case.training, case.model), case.model)
    guess = regression.best(find("one-sided-stop"))
    assert guess is not None
    side = "up" if guess.values["one-sided-stop.position"] > 0 else "down"
    truth = case.truth["parameters"]
    assert abs(guess.values["one-sided-stop.position"]) == pytest.approx(truth[f"{side}_at"], rel=0.03)
    assert guess.values["one-sided-stop.stiffness"] == pytest.approx(truth[f"{side}_stiffness"], rel=0.15)


@pytest.mark.parametrize(("gained", "tries"), [(0.49, 10), (0.51, 40)])
def test_only_where_a_law_gains_half_of_the_best_its_place_is_searched_to_the_end(monkeypatch, gained, tries):
    """Ten solutions a parameter tell which laws are worth the other thirty."""
    gains = {"quadratic-drag": 100.0, "stribeck": 100.0 * gained}
    solved = dict.fromkeys(gains, 0)

    def refined(self, law, guess, most):
        solved[law.name] += most
        return guess

    monkeypatch.setattr(Regression, "__init__", lambda self: None)
    monkeypatch.setattr(Regression, "plain", lambda self: 1.0)
    monkeypatch.setattr(Regression, "gain", lambda self, plain, guess: gains[guess.effect])
    monkeypatch.setattr(Regression, "_refined", refined)
    # what cannot be put on the motion at all is left out
    monkeypatch.setattr(
        Regression, "_probed", lambda self, law: Guess(law.name, {}, 1 / gains[law.name]) if law.name in gains else None
    )
    laws = [find(name) for name in ("stribeck", "sensor-lag", "quadratic-drag")]
    guesses = Regression().guesses(laws)  # pyright: ignore[reportCallIssue]
    assert [guess.effect for guess in guesses] == ["quadratic-drag", "stribeck"]
    assert solved == {"quadratic-drag": 40, "stribeck": tries}

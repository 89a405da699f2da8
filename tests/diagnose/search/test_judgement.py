"""Which name a fit gets: laws that are one equation under two names, and laws that contain one another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.judgement import Round, Trial
from dashpot.identify.structure import Fitted, renamed
from dashpot.model import Oscillator
from dashpot.model.laws import find
from dashpot.model.terms import generalised

BASE = {"mass": 0.3, "omega0": 80.0, "cubic": 0.0, "preload": 0.0, "viscous": 5.0, "dry": 0.1}
LEFT = (np.full(50, 1.0),)


def fitted(effect: str, **values: float) -> Fitted:
    numbers = BASE | {f"{effect}.{name}": value for name, value in values.items()}
    model = Oscillator.from_values(numbers, effects=(effect,))
    return Fitted(model, np.zeros((1, 2)), (np.full(50, 0.1),), 0.0, tuple(numbers))


def trial(one: Fitted, gain: float = 100.0, holdout_gain: float = 100.0) -> Trial:
    (term,) = one.model.terms
    return Trial(term.effect, one, one, gain, holdout_gain, finished=True)


def best(*trials: Trial) -> Round:
    before = Fitted(Oscillator.from_values(BASE), np.zeros((1, 2)), LEFT, 0.0, tuple(BASE))
    return Round(before, before, trials)


@pytest.mark.parametrize(
    ("load", "name", "rivals"), [(2.0, "constant-force", ()), (0.05, "asymmetric-friction/dry", ("constant-force",))]
)
def test_a_load_larger_than_the_friction_is_no_friction(load, name, rivals):
    one = fitted("constant-force", load=load)
    law = find("asymmetric-friction/dry")
    round_ = best(trial(one), trial(renamed(one, "constant-force", law)))
    assert round_.best is not None
    assert round_.best.effect == name
    assert round_.rivals(round_.best) == rivals


def test_the_same_fit_under_another_name_is_the_same_model():
    one = fitted("constant-force", load=0.05)
    other = renamed(one, "constant-force", find("asymmetric-friction/dry"))
    assert other.model.values() == BASE | {"asymmetric-friction/dry.dry": 0.05}
    assert other.free[-1] == "asymmetric-friction/dry.dry"
    from dashpot.simulate.core import core_of

    def run(model):
        start, force = np.array([0.01, 0.0]), np.zeros(200)
        return core_of(model).record(np.array([*model.values().values()]), start, force, 200, 1e-3, 1e-3)

    assert np.array_equal(run(one.model), run(other.model))


@pytest.mark.parametrize(("stiffness", "name"), [(0.5, "clearance"), (4.0, "two-sided-stop")])
def test_a_clearance_stiffer_than_the_spring_is_a_stop(stiffness, name):
    one = fitted("clearance", stiffness=stiffness * 6400.0, gap=1e-3)
    wider = replace(one, model=generalised(one.model, "clearance"))
    assert wider.model.values() == BASE | {
        "two-sided-stop.stiffness": stiffness * 6400.0,
        "two-sided-stop.position": 1e-3,
        "two-sided-stop.damping": 0.0,
        "two-sided-stop.offset": 0.0,
    }
    # chance on the held-out recordings does not decide between a law and a case of it
    round_ = best(trial(one, 100.0, 300.0), trial(wider, 94.0, 100.0))
    assert round_.best is not None
    assert round_.best.effect == name


def test_what_takes_away_nothing_is_not_taken():
    one = fitted("quadratic-drag", coefficient=1.0)
    assert best(trial(replace(one, residuals=LEFT))).best is None
    assert best(trial(one, gain=1.0)).best is None
    assert best(trial(one, holdout_gain=-1.0)).best is None

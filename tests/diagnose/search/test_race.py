"""The race: promises, patience, what leaves and what arrives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.measure import NEAR, Measure
from dashpot.diagnose.search.race import PATIENCE, Entry, race, started
from dashpot.diagnose.search.residual_test import times_the_noise
from dashpot.identify.data import data_of
from dashpot.identify.measured_motion import probes
from dashpot.identify.structure import shapes_of
from dashpot.model.laws import find
from dashpot.model.terms import with_term


@pytest.fixture(scope="module")
def plain(rig):
    """Data of a rig with nothing missing, and its model."""
    case = rig("none")
    return data_of(case.training, case.model), case.model


def bent(model, **factors: float):
    known = model.parameters()
    return model.with_parameters(
        {name: replace(known[name], value=known[name].value * factor) for name, factor in factors.items()}
    )


def times(start):
    return max(times_the_noise(start.fitted.residuals, start.model, start.data))


@pytest.fixture(scope="module")
def there(plain):
    """The maximum, and the measure that it gives."""
    data, model = plain
    start = started(Entry((), model), data, Measure())
    assert start is not None
    measure = race([start], Measure(), None, data.points)
    return start.fitted, measure


def test_a_start_that_is_off_arrives_at_the_noise(plain):
    data, model = plain
    start = started(Entry((), bent(model, viscous=1.3, omega0=1.003)), data, Measure())
    assert start is not None
    assert not start.near
    measure = race([start], Measure(), None, data.points)
    assert start.resting
    assert start.near
    assert measure.noise is not None
    assert times(start) < 1.05
    assert start.model.values()["viscous"] == pytest.approx(model.viscous.value, rel=0.05)


def test_what_cannot_reach_the_best_leaves_without_a_step(plain, there):
    (data, model), (fitted, measure) = plain, there
    best = measure.value(fitted.residuals)
    off = bent(model, viscous=1.2)
    hopeless = started(Entry((), off, hoped=best - 20.0), data, measure)
    hopeful = started(Entry((), off, hoped=best + 20.0), data, measure)
    assert hopeless is not None
    assert hopeful is not None
    race([hopeless, hopeful], measure, fitted, data.points)
    assert hopeless.steps == 0
    assert not hopeless.looked
    assert hopeful.looked


def test_a_promise_is_looked_for_before_a_start_leaves(plain, there):
    """One that is told better than was hoped of it has no bound yet."""
    (data, model), (fitted, measure) = plain, there
    start = started(Entry((), bent(model, viscous=1.0001), hoped=-1e12, fixed=("viscous",)), data, measure)
    assert start is not None
    assert start.ceiling == np.inf
    race([start], measure, doubled(fitted, 1e-3), data.points)
    assert start.looked
    assert start.steps == 0
    assert start.ceiling < start.value + 1e6


def doubled(fitted, factor):
    """A structure that leaves so much of what one leaves."""
    return replace(fitted, residuals=tuple(factor * residual for residual in fitted.residuals))


@pytest.mark.parametrize("patience", [0, PATIENCE])
def test_far_from_the_truth_a_start_is_given_its_steps(plain, there, patience):
    data, model = plain
    start = started(Entry((), bent(model, viscous=2.0, omega0=1.02), patience=patience), data, Measure())
    assert start is not None
    assert times(start) > NEAR
    race([start], Measure(), doubled(there[0], 1e-9), data.points)
    assert start.steps == patience


def test_the_first_that_comes_to_the_noise_gives_the_measure_of_all(plain):
    data, model = plain
    good = started(Entry((), bent(model, viscous=1.001)), data, Measure())
    bad = started(Entry((), bent(model, omega0=1.2), fixed=("omega0",)), data, Measure())
    assert good is not None
    assert bad is not None
    measure = race([good, bad], Measure(), None, data.points)
    assert measure.noise is not None
    assert good.measure is bad.measure is measure
    assert good.value > bad.value
    assert not bad.near


def test_what_a_linear_rig_promises_it_keeps(plain):
    """Near the maximum the response is linear in the unknowns: one step comes to what it promised."""
    data, model = plain
    start = started(Entry((), bent(model, viscous=1.01)), data, Measure())
    assert start is not None
    start.look()
    promised, before = start.ceiling - start.value, start.value
    start.step()
    assert promised > 10.0
    assert start.value - before == pytest.approx(promised, rel=0.1)


def test_shapes_are_freed_before_a_law_leaves_far_from_the_noise(plain, there):
    data, model = plain
    grown = with_term(bent(model, omega0=1.05), "hysteresis", hysteresis_values(data))
    start = started(Entry(("hysteresis",), grown, fixed=shapes_of(grown), patience=1), data, Measure())
    assert start is not None
    assert start.locked
    race([start], Measure(), doubled(there[0], 1e-9), data.points)
    assert not start.locked
    assert start.steps <= 1 + PATIENCE


def hysteresis_values(data) -> dict[str, float]:
    """A weak slider in parallel, its shape as the library has it."""
    law = find("hysteresis")
    values = probes(law, data.scales)[0]
    return values | {p.name: 0.1 * p.natural(data.scales) for p in law.parameters if p.strength}

"""The race: promises, patience, what leaves and what arrives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.race import NEAR, PATIENCE, race, started
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


def test_a_start_that_is_off_arrives_at_the_noise(plain):
    data, model = plain
    start = started((), bent(model, viscous=1.3, omega0=1.003), data)
    assert start is not None
    assert not start.near
    race([start], -np.inf, data.points)
    assert start.resting
    assert start.near
    assert max(start.ratios) < 1.05
    assert start.model.values()["viscous"] == pytest.approx(model.viscous.value, rel=0.05)


def test_what_cannot_reach_the_best_leaves_without_a_step(plain):
    data, model = plain
    there = started((), model, data)
    assert there is not None
    race([there], -np.inf, data.points)
    bar = there.value - 0.5 * there.count * np.log(data.points)
    off = bent(model, viscous=1.2)
    hopeless = started((), off, data, hoped=there.value - 20.0)
    hopeful = started((), off, data, hoped=there.value + 20.0)
    assert hopeless is not None
    assert hopeful is not None
    race([hopeless, hopeful], bar, data.points)
    assert hopeless.steps == 0
    assert not hopeless.looked
    assert hopeful.looked


def test_a_promise_is_looked_for_before_a_start_leaves(plain):
    """One that is told better than was hoped of it has no bound yet."""
    data, model = plain
    start = started((), model, data, hoped=-1e12)
    assert start is not None
    assert start.ceiling == np.inf
    race([start], start.value + 1e6, data.points)
    assert start.looked
    assert start.steps == 0
    assert start.ceiling < start.value + 1e6


@pytest.mark.parametrize("patience", [0, PATIENCE])
def test_far_from_the_truth_a_start_is_given_its_steps(plain, patience):
    data, model = plain
    start = started((), bent(model, viscous=2.0, omega0=1.02), data, patience=patience)
    assert start is not None
    assert max(start.ratios) > NEAR
    race([start], start.value + 1e9, data.points)
    assert start.steps == patience


def test_what_a_linear_rig_promises_it_keeps(plain):
    """Near the maximum the response is linear in the unknowns: one step comes to what it promised."""
    data, model = plain
    start = started((), bent(model, viscous=1.01), data)
    assert start is not None
    start.look()
    promised, before = start.ceiling - start.value, start.value
    start.step()
    assert promised > 10.0
    assert start.value - before == pytest.approx(promised, rel=0.1)


def test_shapes_are_freed_before_a_law_leaves_far_from_the_noise(plain):
    data, model = plain
    grown = with_term(bent(model, omega0=1.05), "hysteresis", hysteresis_values(data))
    start = started(("hysteresis",), grown, data, fixed=shapes_of(grown), patience=1)
    assert start is not None
    assert start.locked
    race([start], start.value + 1e9, data.points)
    assert not start.locked
    assert start.steps <= 1 + PATIENCE


def hysteresis_values(data) -> dict[str, float]:
    """A weak slider in parallel, its shape as the library has it."""
    law = find("hysteresis")
    values = probes(law, data.scales)[0]
    return values | {p.name: 0.1 * p.natural(data.scales) for p in law.parameters if p.strength}

"""Two models: the parameter that moved is named, and nothing else; chance is not."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from dashpot.change import compare
from dashpot.change.comparison import holm
from dashpot.change.wording import as_json, describe, sentence
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.model.file import dumps, loads


@pytest.mark.parametrize("name", ["omega0", "cubic", "preload", "viscous", "dry"])
def test_the_one_that_moved_is_named_and_nothing_else(rig, drawn, name):
    named = []
    for seed in range(20):
        random = np.random.default_rng(seed)
        found = compare(drawn(random), drawn(random, rig.shifted(name, 12.0)))
        named.append(found.moved.best.moved)
        assert found.changed
    assert named.count((name,)) >= 19


def test_a_change_that_its_own_error_hides_shows_beside_what_it_trades_against(rig, model):
    """omega0 is known to one part, but not apart from cubic: alone, its shift is one error."""
    found = compare(model(), model(rig.values + rig.shifted("omega0", 2.0)))
    shift = found.shifts[0]
    assert abs(shift.errors) < 2.0
    assert found.moved.best.moved == ("omega0",)
    (first, _), (second, _) = found.explained["omega0"]
    assert second - first == pytest.approx(2 * rig.errors[0], rel=0.01)
    assert found.change_errors["omega0"] < 0.3 * rig.errors[0]


def test_what_cannot_be_told_apart_is_said(rig, model):
    """A shift along the ridge of omega0 and cubic is as well one of the one as of the other."""
    tight = rig.covariance.copy()
    tight[0, 1] = tight[1, 0] = -0.9999 * rig.errors[0] * rig.errors[1]
    ridge = np.array([1.0, -1.0, 0, 0, 0]) * rig.errors * 0.001
    found = compare(model(covariance=tight), model(rig.values + rig.shifted("omega0", 0.3) + ridge, tight))
    assert {found.moved.best.moved, *(rival.moved for rival in found.moved.rivals)} == {("omega0",), ("cubic",)}
    assert "or else" in sentence(found)


def test_chance_alone_is_named_as_rarely_as_it_should_be(drawn):
    named = 0
    for seed in range(400):
        random = np.random.default_rng(seed)
        named += bool(compare(drawn(random), drawn(random), level=0.05).moved.best.moved)
    assert 8 <= named <= 36  # 20 expected; beyond three standard deviations


def test_with_repeats_chance_alone_is_named_no_oftener(drawn):
    """Repeats scatter by ten times the stated errors of viscous; six of them teach it."""
    spread = np.array([0, 0, 0, 0.1, 0])
    alone = taught = 0
    for seed in range(40):
        random = np.random.default_rng(seed)
        models = [drawn(random, spread=spread) for _ in range(8)]
        alone += bool(compare(*models[:2], level=0.05).moved.best.moved)
        taught += bool(compare(*models[:2], [models[2:]], level=0.05).moved.best.moved)
    assert alone > 25
    assert taught <= 6


def test_where_models_leave_more_than_noise_what_did_not_move_is_the_measure(rig, drawn):
    """All errors are five times what is stated: nothing is named; a large change of one still is."""
    named = []
    for seed in range(20):
        random = np.random.default_rng(seed)
        how = {"inflation": 25.0, "over_noise": 20.0}
        first, second = drawn(random, **how), drawn(random, **how)
        assert compare(first, second).moved.best.moved == ()
        named.append(compare(first, drawn(random, rig.shifted("dry", 200.0), **how)).moved.best.moved)
    assert named.count(("dry",)) >= 17
    assert all(name in ((), ("dry",)) for name in named)


def test_laws_that_appear_and_vanish_are_named(model):
    drag = {"effects": ("quadratic-drag",), "quadratic-drag.coefficient": 3.0}
    found = compare(model(), model(**drag))
    assert found.appeared == ("quadratic-drag",)
    assert found.changed
    assert sentence(found) == "quadratic-drag appeared; no parameter that both have is seen to have moved."
    assert compare(model(**drag), model()).vanished == ("quadratic-drag",)


def test_the_same_model_has_not_changed(model):
    found = compare(model(), model())
    assert not found.changed
    assert sentence(found).startswith("Nothing moved")
    assert all(shift.chance == 1.0 for shift in found.shifts)
    assert json.loads(json.dumps(as_json(found), allow_nan=False))["moved"] == []
    assert "viscous" in describe(found)


def test_models_that_cannot_be_compared_are_refused(model):
    bare = replace(model(), identified=replace(model().identified, covariance=None))
    bare = bare.with_parameters({n: replace(p, std=None) for n, p in bare.parameters().items()})
    with pytest.raises(BadInput, match="no parameter has a standard error"):
        compare(model(), bare)
    text = dumps(model(name="wheel"))
    for metres, radians in (("unit: m}", "unit: rad}"), ("m/s2", "rad/s2"), ("m2.s2", "rad2.s2"), ("kg", "N.s2/rad")):
        text = text.replace(metres, radians)
    turning = loads(text)
    with pytest.raises(BadInput, match="wheel has"):
        compare(model(), turning)


def test_holm_is_that_of_the_book():
    np.testing.assert_allclose(holm(np.array([0.01, 0.04, 0.03, 0.005])), [0.03, 0.06, 0.06, 0.02])


def test_a_rig_whose_dry_friction_grew(recorded):
    """From recordings by an integrator of another kind."""
    from dashpot.examples.truth import TRUTH

    models = [
        identify([recorded({**TRUTH, "dry": dry}, begin=(8e-3, 0.0), seconds=3.0, seed=seed)]).oscillator
        for seed, dry in enumerate((0.015, 0.0155))
    ]
    found = compare(*models)
    assert found.moved.best.moved == ("dry",)
    assert not found.moved.rivals
    (first, _), (second, _) = found.explained["dry"]
    assert second - first == pytest.approx(0.0005, rel=0.1)

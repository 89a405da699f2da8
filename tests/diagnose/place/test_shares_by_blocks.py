"""Shares with errors: the jackknife against closed forms, shares against forces put in by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.place.equation_error import equation_error
from dashpot.diagnose.place.free_form import KINDS, explained, rows_of
from dashpot.diagnose.place.shares_by_blocks import SAID, _Products, depends_on, groups_of, jackknife
from dashpot.diagnose.place.what_it_follows import symptoms
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator
from dashpot.model.oscillator import Response
from dashpot.model.terms import with_term

from .test_smoother import VALUES, recorded


def told(*stretches):
    found = depends_on(symptoms(stretches))
    assert found is not None
    return found


def share_of(found, kind):
    return next(share for share in found.shares if share.kind == kind)


def test_of_a_mean_the_jackknife_is_the_mean_and_its_standard_error():
    x = np.random.default_rng(0).standard_normal(30)
    without = (x.sum() - x) / (x.size - 1)
    made, size = np.array([x.mean(), *without]), np.array([30.0, *[29.0] * 30])
    estimate, error = jackknife(made, size)
    assert estimate == pytest.approx(x.mean(), abs=1e-12)
    assert error == pytest.approx(np.std(x, ddof=1) / np.sqrt(x.size), rel=1e-10)


def test_of_groups_of_unequal_weight_it_is_the_weighted_mean():
    random = np.random.default_rng(1)
    x, weight = random.standard_normal(30), random.uniform(1.0, 9.0, 30)
    whole = np.sum(weight * x) / np.sum(weight)
    without = (np.sum(weight * x) - weight * x) / (np.sum(weight) - weight)
    estimate, error = jackknife(np.array([whole, *without]), np.array([weight.sum(), *(weight.sum() - weight)]))
    assert estimate == pytest.approx(whole, rel=1e-9)
    assert error == pytest.approx(np.std(x) / np.sqrt(x.size), rel=0.3)


def test_a_bias_that_falls_with_the_number_is_taken_off():
    x = np.random.default_rng(2).standard_normal(40)
    without = np.array([np.var(np.delete(x, i)) for i in range(x.size)])
    estimate, _ = jackknife(np.array([np.var(x), *without]), np.array([40.0, *[39.0] * 40]))
    assert estimate == pytest.approx(np.var(x, ddof=1), rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "force"),
    [
        ("displacement", lambda s: 4e3 * np.maximum(s.x - 2e-3, 0.0)),
        ("velocity", lambda s: 60.0 * s.v * np.abs(s.v)),
        ("damping by position", lambda s: 2e6 * s.x**2 * s.v),
        ("time", lambda s: 3e2 * s.x * s.time),
        ("force", lambda s: 3.0 * np.clip(s.drive, -0.8, 0.8)),
        ("tone", lambda s: 0.3 * np.cos(2 * np.pi * 3.37 * s.time)),
    ],
)
def test_a_force_of_one_kind_is_all_of_it_and_nothing_adds(kind, force, stretch):
    found = told(stretch(force, name="a"), stretch(force, name="b", seed=1))
    assert found.first.kind == kind
    assert found.first.share == pytest.approx(1.0, abs=0.02)
    assert not found.those("adds")
    assert {share.kind for share in found.those("nothing")} >= {"memory", "amplitude"} - {kind}


def test_of_two_kinds_each_has_its_share_and_the_other_adds_the_rest(stretch):
    def both(s):
        return 4e3 * np.maximum(s.x - 2e-3, 0.0) + 250.0 * s.v * np.abs(s.v)

    stretches = [stretch(both, name="a"), stretch(both, name="b", seed=1)]
    found, rows = told(*stretches), rows_of(stretches)
    left = float(rows.left @ rows.left)
    for kind in ("displacement", "velocity", "displacement and velocity"):
        share = share_of(found, kind)
        plain = explained(rows, KINDS[kind](rows) * rows.weight[:, None]) / left
        assert share.share == pytest.approx(plain, abs=max(3 * share.std, 0.01))
    assert share_of(found, "displacement and velocity").share == pytest.approx(1.0, abs=0.01)
    assert found.first.share < 1.0 or found.first.kind == "displacement and velocity"


def test_the_errors_cover_what_noise_makes_of_a_share(stretch):
    """Half of the force follows the velocity, the other half nothing: of eight draws the errors are the spread's."""

    def wandering(seed):
        def force(s):
            other = np.random.default_rng(100 + seed).standard_normal(s.n)
            law = s.v * np.abs(s.v)
            rows = rows_of([stretch(lambda _: law, cycles=80, noise=1e-6)])
            return law * rows.weight[0] / np.std(rows.left) + other

        return force

    found = [share_of(told(stretch(wandering(k), cycles=80, seed=k)), "velocity") for k in range(8)]
    shares, errors = np.array([s.share for s in found]), np.array([s.std for s in found])
    assert np.std(shares) < 2.0 * np.mean(errors) < 6.0 * np.std(shares)
    assert np.mean(shares) == pytest.approx(0.5, abs=0.05)


def test_of_a_simulated_rig_with_a_stop_all_is_the_displacement_s():
    """Through the engine and the smoother: what noise hides of the force is not taken for another cause."""
    base = Oscillator.from_values(VALUES)
    stop = with_term(base, "one-sided-stop", {"stiffness": 8e3, "position": 2e-3, "damping": 0.0})
    recording = recorded(stop, seconds=20.0)
    family = replace(base, response=Response(recording.quantity, recording.unit))
    stretches, _ = equation_error(family, data_of([recording], family))
    found = told(*stretches)
    assert found.told
    assert found.first.kind == "displacement"
    assert abs(found.first.share - 1.0) < 2 * found.first.std < 0.2
    assert {"time", "velocity", "force", "memory"} <= {share.kind for share in found.those("nothing")}


def test_groups_are_whole_blocks_in_order_and_of_like_power(stretch):
    rows = rows_of([stretch(lambda s: 60.0 * s.v * np.abs(s.v), name="a"), stretch(name="quiet", seed=1)])
    group = groups_of(rows)
    assert np.all(np.diff(group) >= 0)
    assert np.array_equal(np.unique(group), np.arange(group[-1] + 1))
    for block in np.unique(rows.block):
        assert np.unique(group[rows.block == block]).size == 1
    power = np.bincount(group, rows.left**2)
    blocks = np.bincount(rows.block, rows.left**2)
    assert np.max(power) < np.sum(power) / 40 + np.max(blocks)


def test_a_base_that_moves_is_named_in_place_of_the_force(stretch):
    signature = symptoms([stretch(lambda s: 3.0 * np.clip(s.drive, -0.8, 0.8))])
    found = depends_on(signature, base_moves=True)
    assert found is not None
    assert found.first.kind == "base"


def test_of_one_block_nothing_is_said(stretch):
    assert depends_on(symptoms([stretch(lambda s: 60.0 * s.v * np.abs(s.v), cycles=4)])) is None


def test_only_what_is_said_is_no_kind_that_decides():
    assert not SAID.keys() & KINDS.keys()


def test_a_column_that_one_group_alone_has_takes_nothing_from_the_others():
    """In all but that group its products are what rounding leaves of them, of either sign."""
    random, groups = np.random.default_rng(5), 4
    columns, target = random.standard_normal((groups, 50, 2)), random.standard_normal((groups, 50))
    columns[1:, :, 1] = 0.0
    normal, along = np.einsum("gni,gnj->gij", columns, columns), np.einsum("gni,gn->gi", columns, target)
    normal[0, 1, 1] += 1e-13  # which the total does not keep
    power = np.ones((groups, 2))
    made = _Products({"a": np.array([0]), "b": np.array([1])}, normal, along, along, power, np.ones(groups)).without()
    rounding = replace(made, along=made.along + 1e-15 * random.standard_normal(made.along.shape))
    taken = rounding.taken(["a", "b"], rounding.along)
    assert taken[1] == pytest.approx(rounding.taken(["a"], rounding.along)[1], abs=1e-6)
    assert np.all(np.abs(taken) < 1e3)

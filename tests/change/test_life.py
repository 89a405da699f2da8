"""The life of a rig: what changed, and at which point; recordings of others, where they are at hand."""

from __future__ import annotations

import json
import os
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from dashpot.change import Point, compare, watch
from dashpot.change.life_wording import as_json, describe, sentences
from dashpot.change.steps import drift_of, steps_of
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.model import Oscillator
from dashpot.recording import read

DATA = Path(os.environ.get("DASHPOT_DATA", Path(__file__).resolve().parents[3] / "shared" / "data"))
STEP = np.array([0, 0, 0, 0.5, 0])  # of viscous
SPREAD = np.array([0.2, 0, 0, 0.05, 0])


def life(drawn, shifts, seed=0, **more):
    random = np.random.default_rng(seed)
    return watch([Point(f"t{i}", drawn(random, shift, SPREAD), **more) for i, shift in enumerate(shifts)])


def test_a_step_is_named_at_its_point_without_marked_repeats(drawn):
    right = 0
    for seed in range(8):
        found = life(drawn, [0.0 * STEP] * 9 + [STEP] * 7, seed)
        assert found.repeatability.source == "neighbours"
        right += found.moved.best.moved == ("viscous",) and [s.state for s in found.steps] == [9]
    assert right >= 7
    assert "viscous changes between t8 and t9" in " ".join(sentences(found))


def test_where_nothing_happened_nothing_is_named(drawn):
    assert sum(life(drawn, [0.0 * STEP] * 14, seed).changed for seed in range(12)) <= 1


def test_marked_repeats_tell_scatter_from_change(drawn):
    random = np.random.default_rng(3)
    points = [
        Point(f"{state}-{i}", drawn(random, shift * STEP, SPREAD), state)
        for state, shift in (("new", 0.0), ("worn", 1.0), ("mended", 0.0))
        for i in range(5)
    ]
    found = watch(points)
    assert found.repeatability.source == "repeats"
    assert found.repeatability.learnt == 12
    assert found.moved.best.moved == ("viscous",)
    assert [(found.label(s.state - 1), found.label(s.state)) for s in found.steps] == [
        ("new", "worn"),
        ("worn", "mended"),
    ]
    told = as_json(found)
    assert json.loads(json.dumps(told, allow_nan=False))["changes"][0]["at"] == "worn"
    assert "viscous [1/s] *" in describe(found)


def test_a_drift_is_told_as_one(drawn):
    found = life(drawn, [0.15 * i * STEP for i in range(16)])
    assert found.moved.best.moved == ("viscous",)
    slope, error = found.drifts["viscous"]
    assert slope == pytest.approx(0.075, abs=4 * error)


def test_times_put_points_in_order(model):
    days = ["2026-03-31T00:00:00+00:00", "2025-01-01T00:00:00+00:00"]
    found = watch([Point(day, model(), when=day) for day in days])
    assert [point.name for point in found.points] == sorted(days)


def test_a_law_that_appears_is_told(model):
    drag = {"effects": ("quadratic-drag",), "quadratic-drag.coefficient": 3.0}
    found = watch([Point("a", model()), Point("b", model()), Point("c", model(**drag))])
    assert found.changed
    assert sentences(found)[-1] == "quadratic-drag appears at c."


def test_one_model_has_no_life(model):
    with pytest.raises(BadInput, match="two or more"):
        watch([Point("a", model())])


def test_steps_are_those_of_the_row():
    random = np.random.default_rng(0)
    values = np.concatenate([np.zeros(10), np.full(5, 8.0), np.full(12, 3.0)]) + random.standard_normal(27)
    found = steps_of("x", values, np.ones(27), 1e6, 1e-3)
    assert [step.state for step in found] == [10, 15]
    assert abs(found[0].after - 8.0) < 1.5
    assert steps_of("x", random.standard_normal(200), np.ones(200), 1e6, 1e-3) == ()
    assert drift_of(values, np.ones(27), 1e-3) is None
    assert drift_of(np.arange(6.0), np.ones(6), 1e-3)[0] == pytest.approx(1.0)


def of_file(name, fixed=None, **options):
    if not (DATA / name).exists():
        pytest.skip(f"{name} is not at hand: DASHPOT_DATA says where it is")
    return identify([read(DATA / name, **options)], name=name.split(".")[0], fixed=fixed or {}).oscillator


@cache
def wheel(gap):
    """The columns bear each other's names; see the gallery."""
    return of_file(f"driven_wheel_{gap}mm.csv.gz", force="phi_rad", force_unit="V", response="driver_rad")


def frame(load):
    name = f"friction_frame_{load}g.csv.gz"
    return of_file(name, {"mass": 3.0799}, force="force_N", response="x_mm")


@pytest.mark.long
def test_of_a_wheel_with_a_magnet_at_two_gaps_the_damping_moved():
    found = compare(wheel(5), wheel(1))
    assert found.moved.best.moved == ("viscous",)
    assert not found.moved.rivals
    (far, _), (near, _) = found.explained["viscous"]
    assert 3.8 < near / far < 4.8


@pytest.mark.long
def test_of_a_wheel_with_a_magnet_at_four_gaps_the_damping_moved_each_time():
    found = watch([Point(f"{gap} mm", wheel(gap)) for gap in (5, 3, 2, 1)])
    assert found.moved.best.moved == ("viscous",)
    assert not found.moved.rivals
    assert [step.state for step in found.steps] == [1, 2, 3]


@pytest.mark.long
def test_of_a_frame_with_four_contact_loads_the_dry_friction_moved():
    found = watch([Point(f"{load} g", frame(load)) for load in (250, 350, 450, 550)])
    assert found.moved.best.moved == ("dry",)
    assert not found.moved.rivals
    values, errors = found.values("dry")
    ratio = values / np.array([250, 350, 450, 550])
    assert np.all(np.abs(ratio - ratio.mean()) < 3 * errors / 250 + 0.15 * ratio.mean())


def test_a_friction_that_steps_is_told_in_newtons():
    """The mass does not move, so that its value over the whole life is what the friction is a product with."""
    random, names = np.random.default_rng(5), ("mass", "omega0", "viscous", "dry")
    errors = np.array([1e-3, 0.01, 0.02, 0.004])
    points = []
    for i in range(14):
        true = np.array([0.5, 80.0, 5.0, 0.3 if i < 8 else 0.44])
        values = dict(zip(names, true + errors * random.standard_normal(4), strict=True))
        model = Oscillator.from_values({"cubic": 0.0, "preload": 0.0} | values)
        known = {name: replace(model.parameters()[name], std=float(e)) for name, e in zip(names, errors, strict=True)}
        points.append(Point(f"t{i}", model.with_parameters(known)))
    found = watch(points)
    assert found.moved.best.moved == ("dry",)
    said = " ".join(sentences(found))
    before, after = map(
        float, re.findall(r"dry changes between t7 and t8: friction from ([\d.]+) to ([\d.]+) N \(", said)[0]
    )
    assert before == pytest.approx(0.15, rel=0.02)
    assert after == pytest.approx(0.22, rel=0.02)
    (change,) = as_json(found)["changes"]
    assert change["machine"]["quantity"] == "friction"
    assert change["machine"]["to"] == pytest.approx(after, rel=1e-4)
    assert change["to"] == pytest.approx(0.44, rel=0.02)

"""What was said of recordings is asked again beside the best structure: decays that differ, a force that is held."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.diagnose.asked_again import Change, asked_again
from dashpot.diagnose.search.weigh import judged
from dashpot.examples.force import chirp
from dashpot.identify import identify
from dashpot.identify.faults.spread import alike
from dashpot.identify.problem.data import data_of
from dashpot.model import Oscillator
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from dashpot.recording.fact import changed
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import force_between

FS, OMEGA, TOP = 100.0, 2 * math.pi * 2.0, 0.1
FREE = Oscillator.from_values({"omega0": OMEGA, "viscous": 0.06, "dry": 0.0, "cubic": 0.0, "preload": 0.0})
DRAG = with_term(FREE, "quadratic-drag", {"coefficient": 2.0})
DRIVEN = Oscillator.from_values(FREE.values() | {"mass": 0.8, "viscous": 0.6})


def decay(seed: int, start: float, touched: tuple[float, ...] = (), *, model: Oscillator = DRAG) -> Recording:
    """A decay of eighty cycles with drag; a touch takes 7 % of displacement and speed."""
    core, values = core_of(model), np.array(list(model.values().values()))
    edges = [0, *(round(time * FS) for time in touched), round(40 * FS)]
    x, parts = np.array([start, 0.0]), []
    for a, b in pairwise(edges):
        made = core.record(values, x, None, b - a + 2, 1 / FS, internal_step(model, model.values(), TOP))
        parts.append(made[: b - a])
        x = 0.93 * np.array([made[b - a], 0.5 * FS * (made[b - a + 1] - made[b - a - 1])])
    noise = 1e-4 * TOP * np.random.default_rng(seed).standard_normal(edges[-1])
    return Recording(f"decay {seed}", FS, np.concatenate(parts) + noise, free=True)


def sweep(seed: int, level: float, hold: str) -> Recording:
    n, values = 2000, DRIVEN.values()
    force = chirp(level, 1.0, 3.0 * FS / n, np.arange(n) / FS, 1 / FS)[:, 0]
    between = force_between(force, 1 / FS, hold, 4.0)
    step = internal_step(DRIVEN, values, TOP)
    x = core_of(DRIVEN).record(np.array(list(values.values())), np.zeros(2), between, n, 1 / FS, step)
    return Recording(f"sweep {seed}", FS, x + 1e-4 * np.random.default_rng(seed).standard_normal(n), force=force)


def beside(structure: Oscillator, recordings: list[Recording], given: list[Recording] | None = None) -> Change | None:
    """What is asked for beside a structure that a search ended with."""
    data = data_of(recordings, structure)
    family: Any = SimpleNamespace(model=DRIVEN)
    case: Any = SimpleNamespace(
        recordings=tuple(recordings), given=tuple(given or recordings), model=structure, family=family
    )
    fitted = replace(judged(structure, data), free=tuple(structure.parameters()))
    found: Any = SimpleNamespace(fitted=fitted, weighing=SimpleNamespace(data=data))
    return asked_again(case, found)


def test_what_differs_beside_the_family_alone_differs_no_more():
    """A viscous damping that stood in for a drag in decays of different height."""
    recordings = [decay(1, 0.1), changed(decay(2, 0.06), differs=(("viscous", 0.02),))]
    change = beside(DRAG, recordings)
    assert change == Change(alike=True)
    assert [r.differs for r in change.of(recordings)] == [r.differs for r in alike(recordings)]
    assert all(size == 0.0 for recording in change.of(recordings) for _, size in recording.differs)
    assert str(change) == "as recordings of a rig in which nothing differs"
    assert beside(DRAG, change.of(recordings)) is None


@pytest.mark.parametrize("part", [1e-2, 3e-5])
def test_what_differs_beside_the_best_structure_too_still_does(part):
    """Also where the other would leave only noise to the eye."""
    stiffer = Oscillator.from_values(FREE.values() | {"omega0": (1.0 + part) * OMEGA})
    stiffer = with_term(stiffer, "quadratic-drag", {"coefficient": 2.0})
    other = changed(decay(2, 0.06, model=stiffer), differs=(("omega0", part * OMEGA),))
    assert beside(DRAG, [decay(1, 0.1), other]) is None


@pytest.mark.parametrize("parameter", ["time-delay.delay", "actuator-lag.time"])
def test_a_lag_of_half_a_sample_is_a_hold(parameter):
    recordings = [sweep(1, 1.0, "zero"), sweep(2, 2.0, "zero")]
    law, name = parameter.split(".")
    late = with_term(DRIVEN, law, {name: 0.5 / FS})
    change = beside(late, recordings)
    assert change == Change("zero")
    assert str(change) == "with a force that is held from sample to sample"
    assert {r.hold for r in change.of(recordings)} == {"zero"}
    assert beside(late, recordings, given=[changed(r, hold="smooth") for r in recordings]) is None


def test_a_smooth_force_is_not_held():
    assert beside(DRIVEN, [sweep(1, 1.0, "smooth"), sweep(2, 2.0, "smooth")]) is None


@pytest.mark.long
def test_a_drag_is_named_beside_decays_that_were_touched_and_differ_in_nothing():
    """Beside Eq. 17 alone the viscous damping of the three decays would differ by 117 %."""
    training = [decay(1, 0.1), decay(2, 0.06, (15.0, 23.0))]
    diagnosis = diagnose(identify(training, doubted=False).oscillator, training, [decay(3, 0.08)])
    assert [effect.law for effect in diagnosis.effects] == ["quadratic-drag"]
    assert not any("differs" in note for note in diagnosis.notes)
    values = diagnosis.model.parameters()
    assert values["quadratic-drag.coefficient"].value == pytest.approx(2.0, abs=3.5 * 0.0005)
    assert values["viscous"].value == pytest.approx(0.06, abs=3.5 * values["viscous"].std)
    assert all(record.nrmse_after < 1.5 * record.noise_floor for record in diagnosis.records)

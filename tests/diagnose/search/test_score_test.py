"""The two screens: the score near the truth, the regression far from it."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.search.score_test import Screen
from dashpot.identify.data import data_of, likelihood, noise_spectra
from dashpot.identify.measured_motion import Regression, probes
from dashpot.identify.structure import Structure
from dashpot.model.law import Scales
from dashpot.model.laws import LIBRARY, find
from dashpot.model.terms import with_term


@pytest.mark.long
def test_the_regression_finds_the_gap_that_the_base_model_bent_itself_around(rig):
    case = rig("single", "clearance")
    data = data_of(case.training, case.model)
    regression = Regression(data, case.model)
    best = regression.guesses(list(LIBRARY.values()))[0]
    # the two have one equation; the place of the onset is what the base model could not have told
    assert best.effect in ("clearance", "two-sided-stop")
    gap = best.values.get("clearance.gap") or best.values["two-sided-stop.position"]
    assert gap == pytest.approx(case.truth["parameters"]["clearance_gap"], rel=0.1)


def test_the_score_promises_what_a_small_effect_then_gains(rig):
    case = rig("none")
    data = data_of(case.training, case.model)
    fitted = Structure(case.model, data).fit(settle=True)
    # a drag so small that the response is linear in it
    drag = 0.01 * case.model.viscous.value / (data.scales.length * data.scales.omega)
    disturbed = with_term(fitted.model, "quadratic-drag", {"coefficient": drag})
    structure = Structure(disturbed, data)
    moved = structure.problem.residuals(structure.state(fitted.initial))
    shifted = tuple(r - (m - r) for r, m in zip(fitted.residuals, moved, strict=True))
    from dataclasses import replace

    segments = tuple(
        replace(s, response=s.response - r + n)
        for s, r, n in zip(data.segments, fitted.residuals, shifted, strict=True)
    )
    changed = replace(data, segments=segments)
    base = Structure(fitted.model, changed).fit(
        fitted.initial, noise=noise_spectra(fitted.residuals, fitted.model, data)
    )
    start = {s.effect: s for s in Screen(base, changed).starts([find("quadratic-drag")])}["quadratic-drag"]
    best = Structure(start.model, changed).fit(
        start.initial, noise=noise_spectra(base.residuals, base.model, changed), tolerance=1e-3
    )
    assert best.model.values()["quadratic-drag.coefficient"] == pytest.approx(drag, rel=0.5)
    assert start.promise == pytest.approx(best.likelihood - base.likelihood, rel=0.25, abs=3.0)


def test_probes_are_natural_sizes_times_what_the_law_says():
    scales = Scales(length=2e-3, omega=100.0, force=5.0, response=2e-3, duration=10.0, mass=1.0, lines=(60.0,))
    gaps = [probe["gap"] for probe in probes(find("clearance"), scales)]
    assert gaps == pytest.approx([2e-3 * p for p in find("clearance").parameters[1].probes])
    assert [probe["frequency"] for probe in probes(find("tonal-disturbance"), scales)] == [60.0]


def test_a_law_that_cannot_be_seen_is_not_tried(rig):
    case = rig("none")
    from dataclasses import replace

    decays = [replace(r, force=None) for r in case.training if r.name == "ringdown"]
    model = replace(case.model, mass=None)
    data = data_of(decays, model)
    screen = Screen(Structure(model, data).fit(settle=True), data)
    assert not screen.applies(find("actuator-lag"))
    assert screen.applies(find("quadratic-drag"))


def test_the_likelihood_of_a_model_that_does_not_simulate_is_none(rig):
    case = rig("none")
    data = data_of(case.training, case.model)
    residuals = tuple(np.full(s.n, np.nan) for s in data.segments)
    assert likelihood(residuals, case.model, data) == -np.inf

"""The missing force beside the named law, on rigs of another integrator."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose.place.missing_force import latent_forces
from dashpot.identify.data import data_of
from dashpot.identify.structure import Structure
from dashpot.model.laws import find
from dashpot.model.terms import with_term


def fits(case, effect: str, values: dict[str, float] | None = None):
    """The family's best, and the best with an effect, begun from nothing of it or from values."""
    data = data_of(case.training, case.model)
    family = Structure(case.model, data).fit(settle=True)
    start = with_term(family.model, effect, values or {p.name: 0.0 for p in find(effect).parameters})
    return data, family, Structure(start, data).fit(family.initial, most=30)


def agreement(force) -> float:
    """What part of the named force the smoother finds."""
    return float(force.named @ force.force / (force.named @ force.named))


def test_the_smoother_finds_the_drag_that_the_law_names(rig):
    data, family, mended = fits(rig("single", "quadratic-drag"), "quadratic-drag")
    forces = latent_forces(family, data, mended.model)
    assert {force.file for force in forces} == {"sweep_high", "sweep_low", "ringdown"}
    loudest = max(forces, key=lambda force: np.std(force.force))
    assert agreement(loudest) == pytest.approx(1.0, abs=0.1)
    assert np.corrcoef(loudest.force, loudest.named)[0, 1] > 0.9
    drag = mended.model.values()["quadratic-drag.coefficient"]
    assert loudest.named == pytest.approx(
        drag * loudest.velocity * np.abs(loudest.velocity), abs=0.1 * np.ptp(loudest.named)
    )


@pytest.mark.long
def test_a_disturbance_has_its_own_phase_in_each_recording(rig):
    case = rig("single", "tonal-disturbance")
    truth = case.truth["parameters"]
    values = {"amplitude": truth["tone"], "frequency": truth["tone_omega"]}
    data, family, mended = fits(case, "tonal-disturbance", values)
    for force in latent_forces(family, data, mended.model):
        assert np.corrcoef(force.force, force.named)[0, 1] > 0.9
        assert np.sqrt(2) * np.std(force.named) == pytest.approx(truth["tone"], rel=0.01)  # its peak has noise on it


@pytest.mark.long
def test_a_delay_is_the_difference_of_two_forces(rig):
    case = rig("single", "time-delay")
    (delay,) = (value for name, value in case.truth["parameters"].items() if name.endswith("_delay"))
    data, family, mended = fits(case, "time-delay", {"delay": delay})
    by_file = {force.file: force for force in latent_forces(family, data, mended.model)}
    assert np.corrcoef(by_file["sweep_high"].force, by_file["sweep_high"].named)[0, 1] > 0.8
    assert not np.any(by_file["ringdown"].named)


def test_nothing_is_named_where_the_sensor_is_to_blame_or_nobody(rig):
    data, family, mended = fits(rig("single", "constant-force"), "sensor-offset")
    assert all(force.named is None for force in latent_forces(family, data, mended.model))
    plain = latent_forces(family, data, None)
    assert all(force.named is None for force in plain)
    assert all(np.all(force.std > 0) and force.force.shape == force.time.shape for force in plain)

"""A rig that its base drives: parameters without a mass, a model that simulates it, and physics that is missing."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.face.simulation import along
from dashpot.face.workflow import diagnosed, identified
from dashpot.model import Oscillator
from dashpot.model.file import dumps
from dashpot.model.physical import machine
from dashpot.model.show import describe, parameter_cells
from dashpot.recording import recordings_of
from dashpot.report.parameters import equation_blocks
from scipy.integrate import solve_ivp

FS, SECONDS = 200.0, 20.0
TRUE = {"omega0": 2 * np.pi * 5.0, "cubic": 2e5, "viscous": 1.0}
T = np.arange(round(FS * SECONDS)) / FS


def base(t, order, level):
    """A sweep of 3 to 7 Hz."""
    turn, pace, rise = 2 * np.pi * (3.0 * t + 0.1 * t**2), 2 * np.pi * (3.0 + 0.2 * t), 2 * np.pi * 0.2
    swept = (np.sin(turn), np.cos(turn) * pace, np.cos(turn) * rise - np.sin(turn) * pace**2)
    return 2e-3 * level * swept[order]


def shaken(seed, level=1.0, drag=0.0, quantity="displacement", cubic=TRUE["cubic"]):
    """Arrays of one recording, over the ground; the drag is between the mass and its base."""

    def rates(t, y):
        law = TRUE["viscous"] * y[1] + TRUE["omega0"] ** 2 * y[0] + cubic * y[0] ** 3 + drag * y[1] * abs(y[1])
        return [y[1], -law - base(t, 2, level)]

    begin = [0.0, -base(0.0, 1, level)]
    y = solve_ivp(rates, (0.0, T[-1]), begin, t_eval=T, rtol=1e-10, atol=1e-13, max_step=0.01).y
    order = 0 if quantity == "displacement" else 2
    x, u = (y[0], rates(T, y)[1])[order // 2] + base(T, order, level), base(T, order, level)
    rng = np.random.default_rng(seed)
    x, u = (signal + 1e-3 * np.std(signal) * rng.standard_normal(T.size) for signal in (x, u))
    names = ("x_m", "base_m") if order == 0 else ("acc_m/s2", "base_acc_m/s2")
    return {"time_s": T, names[0]: x, names[1]: u}


@pytest.mark.parametrize("quantity", ["displacement", "acceleration"])
def test_parameters_are_within_their_errors_and_there_is_no_mass(quantity):
    recordings = recordings_of(shaken(1, quantity=quantity))
    found = identified(lambda: recordings)
    assert found.oscillator.mass is None
    assert found.oscillator.is_base_driven
    for name, value in TRUE.items():
        parameter = found.oscillator.parameters()[name]
        assert abs(parameter.value - value) < 3.5 * parameter.std
        assert parameter.std < 0.01 * value
    assert max(s.over_noise for s in found.fit.segments) < 1.2
    assert "its base moves it" in dumps(found.oscillator)
    assert parameter_cells(found.oscillator)[0][:2] == ("mass", "unknown")


def test_a_mass_cannot_be_stated():
    recordings = recordings_of(shaken(1))
    with pytest.raises(BadInput, match="has no mass to state"):
        identified(lambda: recordings, mass=3.0)


@pytest.mark.long
def test_what_is_missing_between_mass_and_base_is_named():
    training, held = recordings_of(shaken(1, drag=0.5), shaken(2, 0.5, drag=0.5)), recordings_of(shaken(3, 0.7, 0.5))
    family = identified(lambda: training).oscillator
    found, fmu = diagnosed(family, training, held)
    assert [effect.effect for effect in found.effects] == ["quadratic-drag"]
    assert found.model.mass is None
    assert found.model.values()["quadratic-drag.coefficient"] == pytest.approx(0.5, rel=0.02)
    assert fmu is not None


def test_a_mode_that_takes_part_by_a_factor_of_its_own_keeps_it():
    """The tip of a cantilever moves 1.57 times what one mass on a spring would: a linear mode, seen from the base."""
    arrays = shaken(1, quantity="displacement", cubic=0.0)
    arrays["x_m"] = arrays["base_m"] + 1.57 * (arrays["x_m"] - arrays["base_m"])
    recordings = recordings_of(arrays, relative=False)
    found = identified(lambda: recordings)
    mass = found.oscillator.mass
    assert mass is not None
    assert mass.unit == "1"
    assert abs(1.0 / mass.value - 1.57) < 3.5 * 1.57 * mass.std / mass.value
    assert any("counts 1.57 times" in note for note in found.notes)


def test_a_model_with_a_mass_is_simulated_along_a_base():
    """Per unit mass the equation is the same, whatever force its mass was identified by."""
    values = {"mass": 3.0, "preload": 0.0, "dry": 0.0} | TRUE
    (recording,) = recordings_of(shaken(1))
    made = along(Oscillator.from_values(values), [recording])
    assert np.std(made.response - recording.response) < 0.01 * np.std(recording.response)


def test_a_base_that_moves_one_end_of_a_spring_tells_what_that_spring_moves():
    """Two springs alike: the base's displacement drives through the one, and both pull back."""
    share, dry = 0.5 * TRUE["omega0"] ** 2, 0.3

    def rates(t, y):
        law = TRUE["viscous"] * y[1] + TRUE["omega0"] ** 2 * y[0] + dry * np.tanh(y[1] / 1e-4)
        return [y[1], share * base(t, 0, 1.0) - law]

    y = solve_ivp(rates, (0.0, T[-1]), [0.0, 0.0], t_eval=T, rtol=1e-8, atol=1e-12, max_step=0.01).y[0]
    rng = np.random.default_rng(4)
    x, u = (s + 1e-3 * np.std(s) * rng.standard_normal(T.size) for s in (y, base(T, 0, 1.0)))
    recordings = recordings_of({"time_s": T, "x_m": x, "base_m": u})
    model = identified(lambda: recordings).oscillator
    parameters = model.parameters()
    for name, value in {"mass": 1 / share, "omega0": TRUE["omega0"], "viscous": TRUE["viscous"], "dry": dry}.items():
        assert abs(parameters[name].value - value) < 3.5 * (parameters[name].std or 0.0)
    assert (model.driven_through, parameters["mass"].unit, model.force_unit) == ("spring", "s2", "m")
    assert "over the stiffness of the spring that drives it" in describe(model)
    said = equation_blocks(model)[-1].text
    assert "the displacement of what moves the other end of the spring that drives it, F, in m" in said
    assert machine(model)["stiffness"].value == pytest.approx(2.0, rel=0.01)  # both springs, over the one
    assert np.std(along(model, recordings).response - x) < 1.2e-3 * np.std(x)

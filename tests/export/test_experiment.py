"""The default experiment: twenty cycles, readable numbers, and a tolerance with which model exchange is right."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from dashpot.export.description import describe_fmu
from dashpot.export.experiment import CYCLES, STEPS, TOLERANCE, Experiment, experiment
from dashpot.export.facts import Facts
from dashpot.model import Oscillator, Parameter
from dashpot.simulate.core import core_of
from dashpot.simulate.force import straight_lines
from fmpy import read_model_description, simulate_fmu


def test_the_paper_s_stand():
    assert experiment(2 * math.pi * 12.67) == Experiment(1.6, 8e-4, 1e-8)


@pytest.mark.parametrize("hertz", np.geomspace(1e-3, 1e6, 91))
def test_twenty_cycles_in_steps_of_about_a_hundredth_with_few_digits(hertz):
    made = experiment(2 * math.pi * hertz)
    cycle = 1 / hertz
    assert 0.66 < STEPS * made.step / cycle < 1.5
    assert CYCLES <= made.stop / cycle < 1.15 * CYCLES
    assert made.step == float(f"{made.step:.0e}")
    count = made.stop / made.step
    assert count == pytest.approx(round(count), rel=1e-12)
    assert len(repr(made.stop).strip("0.").replace(".", "").split("e")[0]) <= 4


@pytest.mark.parametrize("frequency", [0.0, math.nan, math.inf])
def test_without_a_frequency_a_cycle_is_a_second(frequency):
    assert experiment(frequency) == Experiment(20.0, 0.01)


def test_the_frequency_is_the_model_s_own_where_no_linear_spring_tells_it():
    """x'' + 1e8 x^3 at A = 9 mm: 2 pi / T with T = 7.4163 / (sqrt(k) A) (complete elliptic integral)."""
    values = {"omega0": 1.0, "cubic": 1e8, "preload": 0.0, "viscous": 0.0, "dry": 0.0}
    hard = replace(Oscillator.from_values(values), omega0=Parameter(1e-3, None, "rad/s"))
    omega = Facts(hard).natural[0]
    assert omega == pytest.approx(2 * math.pi * math.sqrt(1e8) * 9e-3 / 7.4163, rel=0.03)  # harmonic balance
    assert describe_fmu(Facts(hard)).experiment == experiment(omega)


@pytest.mark.parametrize("version", [2, 3])
def test_model_exchange_is_right_where_nothing_is_said(fmu_of, models, version):
    """FMPy takes the tolerance from the file; without one it takes 1e-5, and 7.7 % of the peak are wrong, here 0.3."""
    model, path = models["base"](), fmu_of(version)
    facts = Facts(model)
    made = experiment(facts.natural[0])
    n = round(made.stop / made.step) + 1
    signal = np.zeros(n, dtype=[("time", float), ("F", float)] + ([("F_rate", float)] if version == 3 else []))
    signal["time"] = np.arange(n) * made.step
    signal["F"] = np.sin(2 * np.pi * 12.67 * signal["time"])
    p = np.array(list(facts.values.values()))
    lines = straight_lines(signal["F"], made.step)
    expected = core_of(model).record(p, np.zeros(2), lines, n, made.step, facts.max_step)

    def error(tolerance: float | None) -> float:
        given = {"fmi_type": "ModelExchange", "output": ["x"], "output_interval": made.step}
        run = simulate_fmu(str(path), input=signal, relative_tolerance=tolerance, **given)
        x = np.interp(signal["time"], run["time"], run["x"])
        return float(np.max(np.abs(x - expected)) / np.max(np.abs(expected)))

    assert error(None) < 5e-3
    assert error(1e-5) > 5e-2


@pytest.mark.parametrize("version", [2, 3])
def test_an_importer_reads_it(fmu_of, version):
    given = read_model_description(str(fmu_of(version))).defaultExperiment
    assert (given.startTime, given.stopTime, given.stepSize) == ("0.0", "1.6", "0.0008")
    assert float(given.tolerance) == TOLERANCE

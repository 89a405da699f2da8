"""The page says what of a recording was not used, and why; and gives the machine's own units with errors."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.model import Oscillator
from dashpot.model.describing import natural_motion
from dashpot.model.oscillator import Range
from dashpot.model.physical import AMID, machine
from dashpot.model.show import as_json, describe
from dashpot.recording import Recording
from dashpot.report.chart import Box
from dashpot.report.page import identification_page
from dashpot.report.time_history import recording_figure
from dashpot.report.used import left, taken, unused, used_table


@pytest.fixture(scope="module")
def held(recorded):
    """A decay that is held for a second before it is let go."""
    decay = recorded(begin=(8e-3, 0.0), seconds=3.0)
    noise = 1e-6 * np.random.default_rng(3).standard_normal(500)
    return Recording("held", decay.fs, np.concatenate([8e-3 + noise, decay.response]))


@pytest.fixture(scope="module")
def found(held):
    return identify([held], fixed={"mass": TRUTH["mass"]})


def test_the_stretch_before_it_is_let_go_is_not_used_and_why(found):
    (table,) = used_table(found)
    ((name, share, where, why),) = table.rows
    assert name == "held"
    assert 40 < float(share.removesuffix(" %")) < 76
    assert re.match(r"0 to (0\.9|1\.0|1 )", where)
    assert "left out" in why


def test_the_picture_shades_what_was_taken_and_its_caption_says_what_was_left_and_why(found, held):
    ((kind, start, stop),) = taken(found, 0)
    assert kind == "free"
    assert 450 < start < 600
    where, why, lost = left(found, 0)
    assert lost == held.n - (stop - start)
    (panel,) = recording_figure(held, taken(found, 0)).panels
    boxes = [mark.x for mark in panel.marks if isinstance(mark, Box)]
    assert boxes == [(pytest.approx(start / held.fs), pytest.approx(stop / held.fs))]
    page = identification_page(found).html
    assert "what was fitted, blue where it is free" in page
    assert f"Left: {where}. {why[0].upper()}{why[1:]}" in page


def test_stretches_of_a_kind_that_follow_one_another_are_shaded_as_one():
    parts = [("free", 0, 50), ("driven", 50, 90), ("free", 300, 400), ("driven", 90, 200), ("driven", 210, 300)]
    fit = SimpleNamespace(
        segments=[SimpleNamespace(segment=SimpleNamespace(recording=0, kind=k, start=a, stop=b)) for k, a, b in parts]
    )
    expected = [("free", 0, 50), ("driven", 50, 200), ("driven", 210, 300), ("free", 300, 400)]
    assert taken(SimpleNamespace(fit=fit), 0) == expected  # pyright: ignore[reportArgumentType]


def test_what_no_stretch_covers():
    recording = Recording("x", 10.0, np.arange(100.0))
    assert unused(recording, []) == [(0, 100)]
    assert unused(recording, [(0, 50), (51, 100)]) == []
    assert unused(recording, [(10, 40), (30, 60)]) == [(0, 10), (60, 100)]


def test_the_page_has_both_tables(found):
    page = identification_page(found).html
    assert "Not used" in page
    assert "As the machine has it" in page
    assert "damping_ratio" in page


def test_the_machine_has_the_numbers_of_a_drawing():
    values = machine(Oscillator.from_values(TRUTH))
    m, w = TRUTH["mass"], TRUTH["omega0"]
    expected = {
        "total_mass": (m, "kg"),
        "stiffness": (m * w**2, "N/m"),
        "cubic_stiffness": (m * TRUTH["cubic"], "N/m3"),
        "preload_force": (m * TRUTH["preload"], "N"),
        "damping": (m * TRUTH["viscous"], "N.s/m"),
        "friction": (m * TRUTH["dry"], "N"),
        "natural_frequency": (w / (2 * np.pi), "Hz"),
        "damping_ratio": (TRUTH["viscous"] / (2 * w), "1"),
    }
    assert {name: p.unit for name, p in values.items()} == {name: unit for name, (_, unit) in expected.items()}
    assert {name: p.value for name, p in values.items()} == pytest.approx({n: v for n, (v, _) in expected.items()})
    assert all(p.std is None for p in values.values())


def test_errors_are_carried_over_as_draws_have_them():
    """With a strong correlation of mass and omega0, against the scatter of draws from the covariance."""
    rig = Oscillator.from_values(TRUTH)
    stds = {"mass": 0.01 * TRUTH["mass"], "omega0": 0.01 * TRUTH["omega0"]}
    cov = -0.9 * stds["mass"] * stds["omega0"]
    rows = ((stds["mass"] ** 2, cov), (cov, stds["omega0"] ** 2))
    known = {name: replace(p, std=stds.get(name)) for name, p in rig.parameters().items()}
    provenance = replace(rig.identified, parameters=("mass", "omega0"), covariance=rows)
    rig = replace(rig.with_parameters(known), identified=provenance)
    drawn = np.random.default_rng(1).multivariate_normal([TRUTH["mass"], TRUTH["omega0"]], rows, 200_000)
    values = machine(rig)
    assert values["stiffness"].std == pytest.approx(np.std(drawn[:, 0] * drawn[:, 1] ** 2), rel=0.02)
    assert values["friction"].std == pytest.approx(stds["mass"] * TRUTH["dry"])
    assert values["natural_frequency"].std == pytest.approx(stds["omega0"] / (2 * np.pi))


def test_without_a_mass_frequency_and_damping_ratio_are_told_alone():
    free = Oscillator.from_values({name: value for name, value in TRUTH.items() if name != "mass"})
    assert set(machine(free)) == {"natural_frequency", "damping_ratio"}
    assert set(as_json(free)["machine"]) == {"natural_frequency", "damping_ratio"}
    assert "As the machine has it\n  natural_frequency" in describe(free)


def test_amid_the_recorded_amplitudes_frequency_and_damping_are_known_best():
    """Of two parameters of which only a sum moves the rig there, each may be unknown and the sum is not."""
    rig = Oscillator.from_values(TRUTH)
    assert not set(AMID) & set(machine(rig))  # nobody says what was recorded
    names = ("omega0", "cubic")
    middle = 0.5 * (2e-3 + 6e-3)
    slopes = np.array([2 * TRUTH["omega0"], 0.75 * middle**2])  # of the frequency's square, Eq. 6
    along = 0.1 * np.array([1.0, -slopes[0] / slopes[1]])  # what leaves it as it is, rad/s and 1/(m2.s2)
    spread = np.outer(along, along) + 1e-12 * np.outer(slopes, slopes)
    stds = dict(zip(names, np.sqrt(np.diag(spread)), strict=True))
    known = rig.parameters()
    rig = replace(
        rig.with_parameters({n: replace(known[n], std=float(std)) for n, std in stds.items()}),
        amplitude=Range(2e-3, 6e-3, "m"),
        identified=replace(rig.identified, parameters=names, covariance=tuple(map(tuple, spread.tolist()))),
    )
    values = machine(rig)
    omega, h = (float(one[0]) for one in natural_motion(rig, [middle]))
    assert values["frequency_amid"].value == pytest.approx(omega / 2 / np.pi, rel=1e-12)
    assert values["damping_ratio_amid"].value == pytest.approx(h / omega, rel=1e-12)
    error = 1e-6 * float(slopes @ slopes) / (2 * omega) / (2 * np.pi)
    assert values["frequency_amid"].std == pytest.approx(error, rel=1e-2)
    assert values["natural_frequency"].std > 500 * error
    assert "natural frequency at 0.004 m, amid the recorded amplitudes" in describe(rig)
    for part, told in ((0.29, True), (0.31, False)):  # by a model that has lost the motion nothing is said of it
        recordings = ({"file": "decay.csv", "nrmse": part, "over_noise": 3.0},)
        fitted = replace(rig, identified=replace(rig.identified, recordings=recordings))
        assert ("frequency_amid" in machine(fitted)) is told

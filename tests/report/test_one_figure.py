"""What a model leaves of a recording is one figure, whoever says it; what is more than noise is said first."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from dashpot.diagnose.result import Diagnosis
from dashpot.diagnose.verdict import worst_of
from dashpot.face.model import Diagnosis as FrontDoor
from dashpot.face.model import Model
from dashpot.face.simulation import along
from dashpot.face.workflow import diagnosed as diagnosed_of
from dashpot.face.workflow import page_of_diagnosis
from dashpot.fleet.manifest import Entry
from dashpot.fleet.outcome import Outcome
from dashpot.fleet.table import Row
from dashpot.identify import Identification, hilbert_analysis, identify
from dashpot.identify.hilbert import hilbert_files
from dashpot.model.display import percent_text, times_text
from dashpot.model.file import dumps, load
from dashpot.model.fit_state import left_of
from dashpot.model.left import over
from dashpot.model.show import as_json, describe
from dashpot.recording import Recording
from dashpot.report.comparison import comparisons
from dashpot.report.effects import probability_text
from dashpot.report.fleet_page import fleet_page
from dashpot.report.hilbert_page import hilbert_page
from dashpot.report.page import identification_page


@cache
def dragged() -> Identification:
    """A decay with drag, that the family of Eq. 17 does not have: x'' + 0.3 x' + 40 x'|x'| + 2500 x = 0."""
    t = np.arange(4000) / 400.0
    x, v, seen, dt = 8e-3, 0.0, [], 1 / 3200.0

    def force(x: float, v: float) -> float:
        return -(0.3 * v + 40.0 * v * abs(v) + 2500.0 * x)

    for _ in range(t.size):
        seen.append(x)
        for _ in range(8):  # leapfrog, with friction at the middle of the step
            v += 0.5 * dt * force(x, v)
            x += dt * v
            v += 0.5 * dt * force(x, v)
    noise = 2e-6 * np.random.default_rng(7).standard_normal(t.size)
    decay = Recording("decay.csv", 400.0, np.array(seen) + noise)
    return identify([decay], name="drag")


def test_model_file_page_terminal_notebook_fleet_and_json_have_the_same_figures(tmp_path: Path):
    found = dragged()
    (left,) = left_of(found.oscillator)
    assert left.times > 1.5
    times, part = times_text(left.times), percent_text(100 * left.part)
    (shown,) = comparisons(found, None)
    assert (shown.nrmse, shown.ratio) == (left.part, left.times)
    page = re.sub(r"<[^>]+>", " ", identification_page(found).html.partition('<script type="application/json"')[0])
    assert f"{times} times the noise" in page
    assert f"{part} of the motion" in page
    assert set(re.findall(r"([\d.]+) times the noise", page)) == {times}
    for said in (describe(found.oscillator), repr(Model(found.oscillator))):
        assert f"{times} times the noise, {part} of the motion" in " ".join(said.split())
    (tmp_path / "rig.yaml").write_text(dumps(found.oscillator))
    assert left_of(load(tmp_path / "rig.yaml")) == [left]
    (told,) = json.loads(json.dumps(as_json(found.oscillator)))["identified"]["recordings"]
    assert (told["nrmse"], told["over_noise"]) == (left.part, left.times)
    outcome = Outcome("0" * 32, "drag", "good", "", recordings=(told,), model="rig.yaml")
    row = Row(Entry("drag", "drag", None, None, ("decay.csv",)), outcome, tmp_path)
    assert f"{part} ({times} × noise)" in fleet_page("fleet.yaml", [row]).html


def test_the_hilbert_page_terminal_and_json_have_the_same_figures(identifications):
    recordings = identifications["stand"]().recordings
    analysis = hilbert_analysis(recordings)
    fit = analysis.freevib
    assert fit is not None
    assert fit.over_noise**2 == pytest.approx(fit.misfit)
    told = hilbert_files.as_json(analysis, recordings)["freevib"]["laws"]
    assert max(law["over_noise"] for law in told if law["law"] in (fit.both.law, fit.damping.law)) == fit.over_noise
    times = times_text(fit.over_noise)
    assert f"leave {times} times the noise" in hilbert_files.describe(analysis, recordings)
    row = re.search(r"times the noise</th>(.*?)</tr>", hilbert_page(analysis, recordings).html, re.DOTALL)
    assert row is not None
    assert times in row.group(1)


def test_a_hilbert_page_says_first_that_no_error_would_hold():
    t, omega, most = np.arange(6000) / 1000.0, 80.0, 8e-3
    noise = 1e-6 * np.random.default_rng(0).standard_normal(t.size)
    envelope = most * np.exp(-0.5 * t)
    for drag, warned in ((5.0, True), (0.0, False)):  # drag by the square of the speed, in its closed form
        x = envelope / (1 + 4 * drag * omega * most * t / (3 * np.pi)) * np.cos(omega * t) + noise
        recordings = [Recording("decay.csv", 1000.0, x)]
        analysis = hilbert_analysis(recordings)
        assert analysis.freevib is not None
        lead, _, rest = hilbert_page(analysis, recordings).html.partition("<h2>")
        assert ('<p class="warn">' in lead) is warned
        assert (f"{times_text(analysis.freevib.over_noise)} times the noise of FREEVIB" in lead) is warned
        assert "dashpot identify decay.csv -o rig.yaml" in lead
        table = rest.partition("</table>")[0]
        assert ("±" in table) is not warned
        assert "∞" not in rest


def test_the_first_thing_that_a_page_says_is_that_more_than_noise_is_left():
    lead = identification_page(dragged(), files=("rig.yaml",)).html.partition("<h2>")[0]
    assert '<p class="warn">' in lead
    assert "the standard errors below may not hold" in lead
    assert "dashpot diagnose rig.yaml decay.csv -o diagnosis" in lead


def test_where_noise_is_left_the_next_step_is_another(identifications):
    lead = identification_page(identifications["stand"](), files=("rig.yaml",)).html.partition("<h2>")[0]
    assert '<p class="good">' in lead
    assert '<p class="warn">' not in lead
    assert "dashpot verify rig.fmu sweep.csv decay.csv" in lead


def test_a_diagnosis_begins_with_the_law_in_the_units_of_the_machine(hand_made):
    diagnosis = hand_made.missing()
    lead = page_of_diagnosis(replace(diagnosis, effects=(replace(diagnosis.effects[0], odds=99.0),)), None)
    words = re.sub(r"<[^>]+>", " ", lead.html.partition("<h2>")[0])
    # 0.5 1/m per unit mass, 0.3 kg; the errors of both, a thousandth each, in quadrature
    assert "coefficient 0.15000 ± 0.00021 N·s²/m²" in words
    assert "99 %" in words
    assert "cubic-damping" in words


def test_only_files_that_are_there_are_named(hand_made):
    diagnosis = hand_made.missing()
    named = page_of_diagnosis(diagnosis, b"an FMU").html
    assert "Files made with this report: diagnosis.json, model.yaml, model.fmu, next_experiment.csv." in named
    less = page_of_diagnosis(replace(diagnosis, experiment=replace(diagnosis.experiment, signal=None)), None).html
    assert "Files made with this report: diagnosis.json, model.yaml." in less


def test_a_probability_has_the_nines_that_its_odds_are_worth():
    assert probability_text(1.0) == "50 %"
    assert probability_text(999.0) == "99.9 %"
    assert probability_text(float("inf")) == "more than 99.9999 %"


@cache
def diagnosed() -> Diagnosis:
    found = dragged()
    return diagnosed_of(found.oscillator, found.recordings, ())[0]


def test_a_diagnosis_has_the_same_figures_in_sentence_page_terminal_python_and_json():
    """Each recording's figures are one pair, before and after, whoever says them."""
    diagnosis = diagnosed()
    worst = worst_of(diagnosis.records)
    told = diagnosis.as_json()["fit"]
    (row,) = [r for r in (*told["train"], *told["holdout"]) if r["file"] == worst.file]
    for left, key in ((worst.left_before, "nrmse_before"), (worst.left_after, "nrmse_after")):
        assert (left.part, left.noise) == (row[key], pytest.approx(row["noise_floor"]))
        assert left.times == pytest.approx(row[key] / row["noise_floor"])
    before, after = (percent_text(100 * left.part) for left in (worst.left_before, worst.left_after))
    assert f"falls from {before.removesuffix(' %')} to {after} of the motion in {worst.file}" in diagnosis.sentence
    page = re.sub(
        r"<[^>]+>", " ", page_of_diagnosis(diagnosis, None).html.partition('<script type="application/json"')[0]
    )
    clause = (
        f"the old model leaves {before} of the motion ({times_text(worst.left_before.times)} times the noise), the new "
        f"one {after} of the motion ({times_text(worst.left_after.times)} times the noise)"
    )
    for said in (page, repr(FrontDoor(diagnosis))):
        assert clause in " ".join(said.split())
    known = {times_text(left.times) for r in diagnosis.records for left in (r.left_before, r.left_after)}
    assert diagnosis.location is not None
    (off,) = re.findall(r"off by up to ([\d.]+) times the noise", diagnosis.location.statement)
    assert off in known


def test_a_simulation_and_a_verification_have_the_figure_of_the_model_file(tmp_path):
    """Of a decay that is one stretch from its first sample to its last they are of the same samples."""
    found = dragged()
    (left,), (decay,) = left_of(found.oscillator), found.recordings
    simulated = along(found.oscillator, [decay])
    assert simulated.nrmse == pytest.approx(left.part, rel=0.02)
    checked = Model(found.oscillator).verify(decay)
    (check,) = checked.recordings
    assert check.nrmse == checked.as_json()["recordings"][0]["nrmse"] == pytest.approx(left.part, rel=0.02)
    assert over(check.nrmse, check.noise_floor) == pytest.approx(left.times, rel=0.05)

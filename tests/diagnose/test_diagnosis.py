"""The whole diagnosis, blind, on rigs made by an integrator of their own."""

from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose import diagnose, tell
from dashpot.diagnose.repair_trial import FITTED_TO_ALL
from dashpot.diagnose.tell import _why_untried
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify.identification import identify
from dashpot.model import Response, oscillator_with
from dashpot.model.file import dumps, loads
from dashpot.model.library import find
from dashpot.recording import Recording
from dashpot.verify.fmu_run import FmuRun


def long(value: str):
    """A further case, for `make test-all`: each is a whole diagnosis."""
    return pytest.param(value, marks=pytest.mark.long)


@pytest.fixture(scope="module")
def drag(rig, tmp_path_factory):
    """The diagnosis of a rig with drag, made once: the case, what was found, and the FMU of the mended model."""
    case, fmu = rig("single", "quadratic-drag"), tmp_path_factory.mktemp("drag") / "mended.fmu"
    return case, diagnose(case.model, case.training, case.holdout, fmu=fmu), fmu


@pytest.mark.parametrize("effect", [long("clearance"), "quadratic-drag", long("tonal-disturbance")])
def test_a_concealed_effect_is_named_and_mended(rig, drag, effect, tmp_path):
    if effect == "quadratic-drag":
        case, diagnosis, fmu = drag
    else:
        case, fmu = rig("single", effect), tmp_path / "mended.fmu"
        diagnosis = diagnose(case.model, case.training, case.holdout, fmu=fmu)
    assert diagnosis.verdict == "missing-physics"
    assert diagnosis.effects[0].effect == effect
    assert fmu.stat().st_size > 0
    for record in diagnosis.records:
        if record.holdout:
            floor = case.truth["recordings"][record.file]["noise_floor"]
            assert record.nrmse_after < 1.15 * floor
            assert record.nrmse_after < record.nrmse_before
    assert loads(dumps(diagnosis.model)).values() == diagnosis.model.values()
    assert [r.name for r in diagnosis.recordings] == [r.name for r in (*case.training, *case.holdout)]


@pytest.mark.parametrize("noise", ["white", long("ar1"), long("quantised")])
def test_noise_is_not_physics(rig, noise):
    case = rig("none", noise=noise)
    diagnosis = diagnose(case.model, case.training, case.holdout)
    assert diagnosis.effects == ()
    assert diagnosis.verdict == "consistent"


def test_the_file_of_a_diagnosis_has_the_agreed_form(drag):
    case, diagnosis, _ = drag
    document = json.loads(json.dumps(diagnosis.as_json(), allow_nan=False))
    assert document["format"] == "dashpot-diagnosis/1"
    assert {"verdict", "effects", "location", "fit", "parameter_shift", "considered", "next_experiment"} <= set(
        document
    )
    assert [set(row) for row in document["fit"]["holdout"]] == [
        {"file", "nrmse_before", "nrmse_after", "noise_floor"}
    ] * len(case.holdout)
    assert document["effects"][0]["parameters"]["coefficient"]["unit"] == "1/m"
    assert {
        "path",
        "statement",
        "displacement",
        "velocity",
        "amplitude",
        "frequency_hz",
        "time_s",
        "recordings",
    } <= set(document["location"])
    # what drag does not explain, dry friction had to: it comes back
    assert document["parameter_shift"]["dry"]["std"] > 0
    considered = {row["effect"] for row in document["considered"]}
    assert "cubic-damping" in considered
    assert "quadratic-drag" not in considered


def test_what_cannot_be_split_is_fitted_whole(rig):
    case = rig("none")
    decay = case.training[2]
    cycles = 8 * 2 * np.pi / case.model.omega0.value
    diagnosis = diagnose(case.model, [replace(decay.slice(0, round(cycles * decay.fs)), name="short decay")])
    assert any("nothing could be held out" in note for note in diagnosis.notes)
    assert not any(record.holdout for record in diagnosis.records)


@pytest.mark.parametrize("kind", [("none",), pytest.param(("single", "quadratic-drag"), marks=pytest.mark.long)])
def test_without_held_out_recordings_stretches_of_each_are_held_out(rig, kind, tmp_path):
    case, fmu = rig(*kind), tmp_path / "mended.fmu"
    diagnosis = diagnose(case.model, case.training, fmu=fmu)
    assert any("no recording was held out" in note for note in diagnosis.notes)
    assert any(record.holdout for record in diagnosis.records)
    assert [(r.name, r.n) for r in diagnosis.recordings] == [(r.name, r.n) for r in case.training]  # none is cut
    assert fmu.exists() == (kind != ("none",)) == (FITTED_TO_ALL in diagnosis.notes)
    if kind == ("none",):  # the model is then that of the whole recordings, and no longer of the stretches
        assert diagnosis.effects == ()
        used = diagnosis.model.identified.recordings
        assert [entry["file"] for entry in used] == [recording.name for recording in case.training]
        sizes = {name: parameter.std for name, parameter in diagnosis.before.parameters().items()}
        assert all(parameter.std < sizes[name] for name, parameter in diagnosis.model.parameters().items())
    else:  # so are the mended one, its effects and its FMU
        used = diagnosis.model.identified.recordings
        assert [entry["file"] for entry in used] == [recording.name for recording in case.training]
        (effect,) = diagnosis.effects
        assert effect.parameters == dict(diagnosis.model.terms[0].parameters)
        with FmuRun(fmu) as run:
            assert run.model.values() == diagnosis.model.values()


def test_a_model_of_these_very_recordings_stays_as_it_is(rig):
    case = rig("none")
    decay = replace(case.training[2], sha256="0" * 64)
    model = identify([decay], doubted=False).oscillator
    diagnosis = diagnose(model, [decay])
    assert diagnosis.effects == ()
    assert any(record.holdout for record in diagnosis.records)
    assert diagnosis.model is model


@pytest.mark.long
def test_the_best_of_models_that_follow_nothing_is_not_named(rig, monkeypatch, tmp_path):
    case = rig("single", "quadratic-drag")
    monkeypatch.setattr("dashpot.diagnose.repair_trial.POOR_NRMSE", 0.0)
    monkeypatch.setattr("dashpot.diagnose.repair_trial.ABOVE_NOISE", 0.5)
    diagnosis = diagnose(case.model, case.training, case.holdout, fmu=tmp_path / "mended.fmu")
    assert diagnosis.effects == ()
    assert diagnosis.verdict == "unexplained"
    assert any("(quadratic-drag) follows no recording either" in note for note in diagnosis.notes)
    assert not (tmp_path / "mended.fmu").exists()
    assert all(record.nrmse_after == record.nrmse_before for record in diagnosis.records)


@pytest.mark.long
def test_recordings_of_another_rig_are_refused(rig):
    case, other = rig("single", "quadratic-drag"), rig("none")
    with pytest.raises(BadInput, match="not of the model's rig"):
        diagnose(other.model, case.training, case.holdout)


def test_another_unit_is_refused(rig):
    case = rig("none")
    angle = Recording(name="angle", fs=500.0, response=np.ones(50), quantity="velocity", unit="rad/s")
    with pytest.raises(BadInput, match="--quantity"):
        diagnose(case.model, [angle])


def test_decays_alone_leave_the_mass_of_the_model_as_it_is(rig):
    case = rig("none")
    diagnosis = diagnose(case.model, [case.training[2]])
    assert diagnosis.before.values()["mass"] == case.model.values()["mass"]
    assert diagnosis.before.omega0.value == pytest.approx(case.model.omega0.value, rel=0.01)
    assert diagnosis.effects == ()


@pytest.mark.long
def test_a_rig_that_was_changed_before_the_held_out_recordings_is_told_apart(rig):
    case, other = rig("none"), rig("none", noise="quantised")
    changed = diagnose(case.model, case.training, other.holdout)
    assert changed.effects == ()
    assert any("another rig" in note for note in changed.notes)


@pytest.mark.long
def test_one_held_out_recording_that_jumps_is_no_other_rig(rig):
    """A bifurcation may go either way by a hair: the others still agree."""
    case = rig("single", "quadratic-drag")
    multisine, sweep = case.holdout
    jumped = np.array(sweep.response)
    n = jumped.size
    part = slice(n // 2, n // 2 + n // 10)
    jumped[part] += 0.2 * np.std(jumped) * np.sin(2 * np.pi * 0.03 * np.arange(jumped[part].size))
    diagnosis = diagnose(case.model, case.training, [multisine, replace(sweep, response=jumped)])
    assert not any("another rig" in note for note in diagnosis.notes)
    assert diagnosis.effects[0].effect == "quadratic-drag"


@pytest.mark.parametrize(("after", "words"), [(0.1, "falls from 50 to 10 %"), (0.6, "rises from 50 to 60 %")])
def test_an_error_that_rises_is_not_said_to_fall(after, words):
    from dashpot.diagnose.result import Effect, RecordFit
    from dashpot.diagnose.verdict import sentence_of

    nothing = np.zeros(1)
    record = RecordFit("end", True, 0.5, after, 0.05, nothing, nothing, nothing, nothing, None, Response())
    stop = Effect("one-sided-stop", "one-sided-stop", "spring", {})
    assert words in sentence_of("missing-physics", [stop], "there remains more", [record], [], [])


@pytest.mark.parametrize(
    ("effect", "driven", "asked", "words"),
    [
        ("asymmetric-friction/dry", True, False, "it is fitted as constant-force"),
        ("actuator-lag", False, False, "none was recorded"),
        ("actuator-backlash", True, False, "where all others fail"),
        ("actuator-backlash", True, True, "no prediction from any of its probes"),
        ("tonal-disturbance", True, False, "no line stands out"),
        ("clearance", True, False, "nothing spoke for it"),
    ],
)
def test_why_a_law_was_never_put_in_is_said_as_it_is(effect, driven, asked, words):
    segment = SimpleNamespace(force=object() if driven else None)
    weighing = SimpleNamespace(data=SimpleNamespace(segments=[segment]))
    assert words in _why_untried(find(effect), weighing, asked_rugged=asked)


@pytest.mark.parametrize(("odds", "first"), [((10.0, 9.0), "cubic-damping"), ((10.0, 1.1), "quadratic-drag")])
def test_named_first_is_what_most_is_expected_from(monkeypatch, odds, first):
    """Its share times its probability: that one is a little surer says less than that the other takes half more."""
    laws, shares = ("quadratic-drag", "cubic-damping"), {"quadratic-drag": 0.6, "cubic-damping": 0.9}
    stands = {law: SimpleNamespace(odds=one, rivals=()) for law, one in zip(laws, odds, strict=True)}
    monkeypatch.setattr(tell, "standing", lambda law, *_: stands[law])
    values = TRUTH | {"quadratic-drag.coefficient": 2.0, "cubic-damping.coefficient": 3.0}
    model = oscillator_with(values, effects=laws)
    found = SimpleNamespace(
        selected=SimpleNamespace(laws=laws),
        fitted=SimpleNamespace(model=model),
        candidates={},
        weighing=SimpleNamespace(parts=()),
        share_of=shares.__getitem__,
    )
    effects, unnamed = tell._effects(found, model)
    assert effects[0].effect == first
    assert len(effects) == 2
    assert not unnamed

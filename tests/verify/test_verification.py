"""The proof itself: it passes what is right, fails what is wrong, and knows the noise."""

from __future__ import annotations

import zipfile
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.rig import force, paper_stand
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import acceleration, recording_of
from dashpot.export import export
from dashpot.model import Oscillator, Response
from dashpot.model.file import dumps
from dashpot.recording import Recording
from dashpot.simulate.force import smooth_force, straight_lines
from dashpot.verify.fmu_run import FmuRun
from dashpot.verify.score import standard_errors
from dashpot.verify.verification import verify
from scipy.integrate import solve_ivp

FS, N = 1000.0, 12_000
NOISE = 2e-6


def model_of(quantity="displacement", **changed):
    unit = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}[quantity]
    return Oscillator.from_values(TRUTH | changed, response=Response(quantity, unit))


@cache
def clean(quantity, kind, initial):
    """By the reference integrator, which shares nothing with the FMU."""
    sweep = (1.0, 8.0, 18.0) if kind == "sweep" else None
    return recording_of(
        sweep=sweep, begin=initial, fs=FS, seconds=N / FS, quantity=quantity, noise=0.0, name=f"{kind}.csv"
    )


def recording(quantity="displacement", kind="sweep", noise=NOISE, force_noise=0.0, seed=0, initial=(0.0, 0.0)):
    random, record = np.random.default_rng(seed), clean(quantity, kind, initial)
    response = record.response + noise * random.standard_normal(N)
    force = None if record.force is None else record.force + force_noise * random.standard_normal(N)
    return replace(record, response=response, force=force)


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "rig.fmu"
    export(model_of(), path)
    return path


@pytest.mark.long
def test_an_fmu_of_fmi_3_proves_as_well(fmu, tmp_path):
    newer = export(model_of(), tmp_path / "rig3.fmu", version=3)[0]
    for record in (recording(), recording(kind="decay", initial=(8e-3, 0.1))):
        (old,), (new,) = verify(fmu, [record]).recordings, verify(newer, [record]).recordings
        assert verify(newer, [record]).passed
        assert new.nrmse == pytest.approx(old.nrmse, rel=1e-3)
    with FmuRun(fmu) as two, FmuRun(newer) as three:
        force = smooth_force(np.asarray(recording().force), 1 / FS, 40.0)
        for _ in range(2):  # an instance serves again and again
            x2, x3 = two.record(force, N, 1 / FS), three.record(force, N, 1 / FS)
        assert np.max(np.abs(x3 - x2)) < 1e-5 * np.max(np.abs(x2))  # straight lines for the cubics of the force


def test_a_right_model_passes_and_the_noise_floor_is_the_noise(fmu):
    record = recording()
    result = verify(fmu, [record])
    (check,) = result.recordings
    assert result.passed
    assert check.nrmse == pytest.approx(NOISE / np.std(record.response), rel=0.05)
    assert check.noise_floor == pytest.approx(NOISE / np.std(record.response), rel=0.05)
    assert check.backbone_max_error_hz < 0.02
    assert result.sentence() == "rig.fmu reproduces sweep.csv to within its noise"


def test_noise_on_the_force_belongs_to_the_floor(fmu):
    (check,) = verify(fmu, [recording(noise=1e-7, force_noise=1e-2)]).recordings
    assert check.passed
    assert check.nrmse == pytest.approx(check.noise_floor, rel=0.15)


@pytest.mark.parametrize(
    "changed",
    [{"mass": TRUTH["mass"] * 1.002}, {"cubic": 0.0}, pytest.param({"dry": 0.0}, marks=pytest.mark.long)],
)
def test_a_wrong_model_fails(tmp_path, changed):
    export(model_of(**changed), tmp_path / "wrong.fmu")
    result = verify(tmp_path / "wrong.fmu", [recording()])
    assert not result.passed
    assert "does not reproduce sweep.csv" in result.sentence()


def test_the_criterion_that_failed_is_named_with_its_figures(tmp_path):
    export(model_of(mass=TRUTH["mass"] * 1.002), tmp_path / "wrong.fmu")
    result = verify(tmp_path / "wrong.fmu", [recording()])
    (check,) = result.recordings
    assert check.failed[0].startswith(f"an NRMSE of {check.nrmse:.3g} is left where noise alone leaves")
    assert f"more than {check.nrmse_limit:.3g} once in a thousand" in result.sentence()
    assert check.score is None


def test_a_parameter_that_no_rms_tells_is_told_by_the_score(tmp_path):
    """A mass that is off by six of the standard errors that this recording leaves it."""
    record = recording(noise=1e-5, force_noise=1e-2)
    by = 6.0 * standard_errors(model_of(), record)["mass"]
    export(model_of(mass=TRUTH["mass"] + by), tmp_path / "wrong.fmu")
    (check,) = verify(tmp_path / "wrong.fmu", [record]).recordings
    assert check.nrmse < check.nrmse_limit
    assert not check.passed
    assert not check.score.passed
    (sentence,) = check.failed
    assert sentence == check.score.sentence()


def test_bursts_with_ten_micrometres_and_a_per_cent_of_noise_pass(fmu):
    pieces = force("bursts")[:10_000]
    x, true, random = paper_stand(pieces), pieces[:, 0], np.random.default_rng(0)
    shown = true + 1e-2 * np.max(np.abs(true)) * random.standard_normal(x.size)
    record = Recording(name="bursts.csv", fs=FS, response=x + 1e-5 * random.standard_normal(x.size), force=shown)
    (check,) = verify(fmu, [record]).recordings
    assert check.failed == ()
    assert 0.0 < check.backbone_over_limit < 1.0


def test_a_force_column_that_holds_only_noise_does_not_drive_the_fmu(fmu):
    record = recording(kind="decay", initial=(7e-3, 0.3))
    noisy = replace(record, force=0.05 * np.random.default_rng(5).standard_normal(N))
    (check,) = verify(fmu, [noisy]).recordings
    assert check.passed
    assert check.nrmse < 1.1 * NOISE / np.std(check.measured)


def test_a_model_whose_own_errors_explain_the_difference_passes(tmp_path):
    wrong = model_of(omega0=TRUTH["omega0"] * 1.002)
    known = {"omega0": replace(wrong.omega0, std=0.002 * TRUTH["omega0"])}
    export(wrong, tmp_path / "exact.fmu")
    export(wrong.with_parameters(known), tmp_path / "honest.fmu")
    exact, honest = (verify(tmp_path / f"{name}.fmu", [recording()]).recordings[0] for name in ("exact", "honest"))
    assert not exact.passed
    assert honest.passed
    assert honest.noise_floor == pytest.approx(exact.noise_floor, rel=0.05)
    assert honest.nrmse_limit > 10 * exact.nrmse_limit


def test_an_fmu_that_is_not_its_model_file_is_judged_by_its_own_response(tmp_path, fmu):
    """The file inside says another mass: nothing of it counts, and the FMU itself passes or fails."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(tmp_path / "other.fmu", "w") as target:
        for name in source.namelist():
            content = source.read(name)
            target.writestr(name, dumps(model_of(mass=0.4)) if name.endswith("model.yaml") else content)
    (check,) = verify(tmp_path / "other.fmu", [recording()]).recordings
    assert check.passed
    assert check.score is None


def test_a_tenth_is_what_the_level_of_noise_is_not_known_by(fmu):
    record = recording()
    strict, usual = (verify(fmu, [record], **ratio).recordings[0] for ratio in ({"noise_ratio": 1.0}, {}))
    assert usual.nrmse_limit == pytest.approx(1.1 * strict.nrmse_limit)
    just = strict.nrmse / strict.nrmse_limit
    assert verify(fmu, [record], noise_ratio=1.01 * just).passed
    assert not verify(fmu, [record], noise_ratio=0.99 * just).passed


def test_a_decay_from_an_unknown_state_is_followed_to_its_noise(fmu):
    record = recording(kind="decay", initial=(7e-3, 0.3))
    (check,) = verify(fmu, [record]).recordings
    assert check.passed
    assert check.nrmse < 1.1 * NOISE / np.std(check.measured)


def test_a_sweep_that_is_already_moving_when_the_recording_starts(fmu):
    (check,) = verify(fmu, [recording(initial=(3e-3, -0.2))]).recordings
    assert check.passed


@pytest.mark.parametrize("quantity", [pytest.param("velocity", marks=pytest.mark.long), "acceleration"])
def test_velocity_and_acceleration(tmp_path, quantity):
    export(model_of(quantity), tmp_path / "rig.fmu")
    noise = 1e-3 * np.std(recording(quantity, noise=0.0).response)
    (check,) = verify(tmp_path / "rig.fmu", [recording(quantity, noise=noise)]).recordings
    assert check.nrmse < 1.1 * check.noise_floor


@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_a_recording_is_held_against_the_output_of_its_unit(fmu, quantity):
    """A model of displacements; its FMU has the motion's derivatives as outputs too."""
    noise = 1e-3 * np.std(recording(quantity, noise=0.0).response)
    (check,) = verify(fmu, [recording(quantity, noise=noise)]).recordings
    assert check.response.quantity == quantity
    assert check.nrmse < 1.1 * check.noise_floor


def test_a_unit_that_no_output_has_is_refused_with_those_there_are(fmu):
    with pytest.raises(BadInput, match=r"records displacement in V; .* gives x in m, displacement in m, velocity in m"):
        verify(fmu, [replace(recording(), unit="V")])


def test_what_sensors_show_beside_the_motion_is_left_aside_and_said(fmu):
    """A zero, a drift and a load cell that is off: settings of amplifiers, for which no model is to blame."""
    record = recording()
    t = np.arange(N) / FS
    off = replace(record, response=record.response + 1e-3 + 1e-4 * (t - t.mean()), force=record.force + 0.5)
    said = []
    result = verify(fmu, [off], progress=said.append)
    assert result.passed
    besides = result.recordings[0].besides
    figures = [float(words.split(" by " if "drifts" in words else " shows ")[1].split()[0]) for words in besides]
    assert figures == pytest.approx([1.0, 0.1, 0.5], rel=1e-2)
    assert [unit in words for unit, words in zip((" mm", " mm/s", " N"), besides, strict=True)] == [True] * 3
    assert [words in " ".join(said) for words in besides] == [True] * 3
    assert verify(fmu, [record]).recordings[0].besides == ()


def test_a_recording_with_neither_force_nor_decay_is_refused(fmu):
    steady = Recording(name="steady.csv", fs=FS, response=np.sin(80 * np.arange(N) / FS))
    with pytest.raises(BadInput, match="neither a force nor a free decay"):
        verify(fmu, [steady])


@pytest.mark.parametrize("quantity", [pytest.param("displacement", marks=pytest.mark.long), "acceleration"])
@pytest.mark.parametrize("version", [pytest.param(2, marks=pytest.mark.long), 3])
def test_an_fmu_is_fed_as_the_recordings_of_its_model_ran(tmp_path, quantity, version):
    """A force that is held from sample to sample, at twenty samples a cycle."""
    fs, n = 250.0, 3000
    force = np.sin(2 * np.pi * (8.0 * np.arange(n) / fs + 5.0 * (np.arange(n) / fs) ** 2 / 12))
    model = replace(model_of(quantity), hold="zero")
    export(model, tmp_path / "rig.fmu", version=version)
    x, v = integrate_pieces(TRUTH, force[:-1, None], 1 / fs)
    y = x if quantity == "displacement" else acceleration(TRUTH, x, v, force)
    noise = 1e-3 * np.std(y) * np.random.default_rng(0).standard_normal(n)
    held = Recording(
        name="held.csv", fs=fs, response=y + noise, force=force, quantity=quantity, unit=model.response.unit
    )
    (check,) = verify(tmp_path / "rig.fmu", [held]).recordings
    assert check.nrmse < 1.1 * check.noise_floor
    (check,) = verify(tmp_path / "rig.fmu", [replace(held, hold="smooth")]).recordings
    assert check.nrmse > 10 * check.noise_floor


def test_the_python_fmu_agrees_with_the_native_one(tmp_path, fmu):
    export(model_of(), tmp_path / "python.fmu", backend="python")
    force = straight_lines(np.sin(2 * np.pi * 11 * np.arange(2000) / FS), 1 / FS)
    with FmuRun(fmu) as native, FmuRun(tmp_path / "python.fmu") as python:
        a, b = native.record(force, 2000, 1 / FS), python.record(force, 2000, 1 / FS)
    assert np.max(np.abs(a - b)) < 1e-4 * np.max(np.abs(a))


def test_one_fmu_runs_over_many_recordings_without_remembering(fmu):
    record = recording(noise=0.0)
    force = straight_lines(np.asarray(record.force), 1 / FS)
    with FmuRun(fmu) as run:
        first = run.record(force, 3000, 1 / FS)
        run.record(force, 3000, 1 / FS, np.array([5e-3, 0.1]))
        assert np.array_equal(run.record(force, 3000, 1 / FS), first)


def test_an_fmu_of_fmi_3_is_refused_by_name(tmp_path, fmu):
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(tmp_path / "three.fmu", "w") as target:
        for entry in source.namelist():
            content = source.read(entry)
            if entry == "modelDescription.xml":
                content = content.replace(b'fmiVersion="2.0"', b'fmiVersion="3.0"')
            target.writestr(entry, content)
    with pytest.raises(BadInput, match=r"three\.fmu"):
        FmuRun(tmp_path / "three.fmu")


def test_the_json_holds_what_the_design_says(fmu):
    result = verify(fmu, [replace(recording(), name="a.csv")]).as_json()
    assert set(result) == {"fmu", "recordings", "pass"}
    (check,) = result["recordings"]
    before = {"file", "nrmse", "noise_floor", "backbone_max_error_hz", "besides", "pass"}
    assert set(check) == before | {"nrmse_limit", "backbone_over_limit", "score", "failed"}
    assert set(check["score"]) == {"parameter", "unit", "value", "asks", "gain", "chance", "pass"}
    assert check["failed"] == []


#: A law's force per unit mass and the rate of its inner state, from displacement, velocity, inner state and parameters.
MEMORIES = {
    "viscoelastic": lambda x, v, q, p: (p["stiffness"] * (x - q), p["rate"] * (x - q)),
    "hysteresis": lambda x, v, z, p: (
        p["stiffness"] * z,
        v * (1 - abs(z / p["limit"]) ** p["exponent"] * (p["loading"] * np.sign(v * z) + 1 - p["loading"])),
    ),
    "tonal-disturbance": lambda x, v, phase, p: (-p["amplitude"] * np.cos(phase), p["frequency"]),
}


def with_memory(model, effect, begin, duration, force):
    """(n,) times and displacements of Eq. 17 without its jumps, beside a law with a memory: by scipy."""
    values = model.values()
    p = {name.partition(".")[2]: value for name, value in values.items() if name.startswith(effect)}

    def rates(t, state):
        x, v, inner = state
        memory, rate = MEMORIES[effect](x, v, inner, p)
        spring = values["omega0"] ** 2 * x + values["cubic"] * x**3
        return v, force(t) / values["mass"] - values["viscous"] * v - spring - memory, rate

    t = np.arange(round(duration * FS)) / FS
    solved = solve_ivp(rates, (0, duration), begin, "DOP853", t, rtol=1e-9, atol=1e-12, max_step=1 / FS)
    return t, solved.y[0]


@pytest.mark.parametrize(
    ("effect", "start", "begin"),
    [
        ("viscoelastic", (5e-3, 0.0, -3e-3), (5e-3, 0.0, 2e-3)),  # its inner state starts from the displacement
        pytest.param("hysteresis", (5e-3, 0.2, 1e-3), (5e-3, 0.2, 1e-3), marks=pytest.mark.long),
        pytest.param("tonal-disturbance", (0.0, 0.0, 2.0), (0.0, 0.0, 2.0), marks=pytest.mark.long),
    ],
)
def test_a_recording_that_starts_with_a_memory_is_followed(tmp_path, with_law, effect, start, begin):
    model = with_law(effect, preload=0.0, dry=0.0)
    t, x = with_memory(model, effect, begin, 4.0, lambda t: np.sin(2 * np.pi * (8.0 * t + 1.5 * t**2)))
    noise = NOISE * np.random.default_rng(0).standard_normal(t.size)
    force = np.sin(2 * np.pi * (8.0 * t + 1.5 * t**2))
    record = Recording(name="burst.csv", fs=FS, response=x + noise, force=force, start=1.5)
    export(model, tmp_path / "rig.fmu")
    (check,) = verify(tmp_path / "rig.fmu", [record]).recordings
    assert check.nrmse < 1.1 * check.noise_floor


def test_more_start_values_than_the_fmu_has_are_refused(fmu):
    with FmuRun(fmu) as run:
        assert run.starts == ["x0", "v0"]
        run.record(None, 3, 1 / FS, np.array([1e-3, 0.0, 0.0]))
        with pytest.raises(BadInput, match="3 start values where the FMU has 2 to set"):
            run.record(None, 3, 1 / FS, np.array([1e-3, 0.0, 1e-3]))

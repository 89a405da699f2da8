"""A Model from Python: made of whatever is a recording, with everything a command does as a method."""

from __future__ import annotations

import json

import dashpot
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face.model import Model
from dashpot.recording import recordings_of

FS = 500.0


@pytest.fixture(scope="module")
def sweep(recorded):
    """A sweep of the paper's stand by the integrator that is not the product's."""
    return recorded(TRUTH, sweep=(1.0, 8.0, 18.0), fs=FS, seconds=8.0)


@pytest.fixture(scope="module")
def model(sweep):
    return dashpot.identify(sweep, name="stand")


@pytest.fixture
def plain():
    return dashpot.Model.from_values(TRUTH, name="stand")


def test_a_model_has_the_numbers_of_the_rig(model):
    for name, true in TRUTH.items():
        assert abs(model[name].value - true) < 5 * model[name].std, name
    assert model["friction"].value == pytest.approx(TRUTH["mass"] * TRUTH["dry"], rel=0.02)


def test_arrays_files_and_recordings_give_the_same_model(model, sweep, tmp_path):
    file = tmp_path / "sweep.csv"
    columns = {"time_s": sweep.time, "force_N": sweep.force, "displacement_m": sweep.response}
    np.savetxt(file, np.column_stack(list(columns.values())), "%.17g", ",", header=",".join(columns), comments="")
    from dashpot.identify import identify

    expected = model["omega0"].value
    assert identify([file]).oscillator.omega0.value == pytest.approx(expected, rel=1e-9)
    assert dashpot.identify(columns)["omega0"].value == pytest.approx(expected, rel=1e-9)


def given(sweep):
    x, force, t = np.array(sweep.response), np.array(sweep.force), sweep.time
    sep5 = [
        {"name": "x", "data": x, "fs": FS, "unit_str": "m", "quantity": "displacement"},
        {"name": "force", "data": force, "fs": FS, "unit_str": "N", "quantity": "force"},
    ]
    return {
        "arrays by name": (({"time_s": t, "force_N": force, "displacement_m": x},), {}),
        "two arrays": ((x,), {"fs": FS, "force": force}),
        "numbers": (([float(v) for v in x],), {"fs": FS, "force": force}),
        "SEP 5": ((sep5,), {}),
        "a recording": ((sweep,), {}),
        "a list": (([sweep],), {}),
        "by a name of its own": (({"sweep": sweep},), {}),
    }


@pytest.mark.parametrize("what", given(dashpot.Recording("x", FS, np.arange(9.0), np.arange(9.0))))
def test_what_is_a_recording(sweep, what):
    things, options = given(sweep)[what]
    (read,) = recordings_of(*things, **options)
    assert read.fs == pytest.approx(FS)
    np.testing.assert_allclose(read.response, sweep.response, rtol=1e-12)
    np.testing.assert_allclose(read.force, sweep.force, rtol=1e-12)


@pytest.mark.parametrize("thing", ["absent.csv", dashpot.examples.recordings()["bursts"]])
def test_an_option_that_there_is_not_is_told_whatever_is_read(thing):
    with pytest.raises(TypeError, match="no option 'forse'; did you mean force"):
        dashpot.read(thing, forse="none")


@pytest.mark.parametrize(
    ("things", "options", "said"),
    [
        ((), {}, "no recording was given"),
        (("absent.csv",), {}, "absent.csv"),
        ((["absent.csv"],), {}, "absent.csv"),
        ((np.zeros(100),), {}, "give its sampling frequency with fs"),
        ((np.zeros((100, 3)),), {"fs": 100.0}, r"shape \(100, 3\) does not say"),
        ((7,), {}, "int is no kind of recording"),
        ((None,), {}, "NoneType is no kind of recording"),
        (({"x_mm": "text"},), {}, "text"),
    ],
)
def test_what_is_none_is_refused_in_one_sentence(things, options, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match=said) as refused:
        dashpot.identify(*things, **options)
    assert "\n" not in str(refused.value)


def test_the_plain_function_refuses_in_a_sentence_too():
    from dashpot.identify import identify

    with pytest.raises(BadInput, match=r"absent\.csv"):
        identify(["absent.csv"])


def test_a_model_prints_in_a_few_lines(model):
    lines = repr(model).splitlines()
    assert len(lines) < 22
    assert max(map(len, lines)) < 120
    assert any(line.startswith("  damping_ratio") for line in lines)
    assert len(repr(model.identification)) < 500
    assert len(repr(model.identification.measured)) < 200
    assert repr(model.identification.recordings[0]).startswith("<Recording ")


def test_results_show_themselves_in_a_notebook(model, sweep):
    for shown in (model, model.simulate(sweep)):
        html = shown._repr_html_()
        assert "<svg" in html
        assert "<script" not in html
        assert len(html) < 400_000


def test_a_model_without_a_range_shows_its_numbers_alone(plain):
    assert "<svg" not in plain._repr_html_()
    assert "&lt;b&gt;&amp;" in plain.renamed("<b>&")._repr_html_()
    with pytest.raises(BadInput, match="does not say which amplitudes"):
        plain.plot()


def test_a_simulation_along_a_recording(model, sweep, tmp_path):
    simulation = model.simulate(sweep)
    assert simulation.nrmse < 0.01
    assert simulation.lost is None
    path = simulation.save(tmp_path / "response.csv")
    assert path.read_text().startswith("time_s,force_N,displacement_m,simulated_displacement_m\n")


def test_a_force_of_ones_own_is_answered_as_the_integrator_does(sweep, plain):
    """From rest, the same force: what is left is the sensor's noise."""
    simulation = plain.simulate(force=np.array(sweep.force), fs=FS)
    assert np.std(simulation.response - sweep.response) < 2e-3 * np.std(sweep.response)
    assert simulation.nrmse is None


def test_free_motion_of_a_linear_rig_is_the_closed_form(tmp_path):
    omega, viscous = 40.0, 0.8
    rig = {"omega0": omega, "cubic": 0.0, "preload": 0.0, "viscous": viscous, "dry": 0.0}
    simulation = dashpot.Model.from_values(rig).simulate(initial=(2e-3, 0.0), seconds=2.0, fs=400.0)
    turn, t = np.sqrt(omega**2 - viscous**2 / 4), simulation.time
    exact = 2e-3 * np.exp(-viscous * t / 2) * (np.cos(turn * t) + viscous / (2 * turn) * np.sin(turn * t))
    np.testing.assert_allclose(simulation.response, exact, atol=1e-9)
    assert simulation.save(tmp_path / "free.csv").read_text().startswith("time_s,displacement_m\n")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({}, "give the sampling frequency"),
        ({"fs": 100.0}, "how many seconds"),
        ({"fs": 100.0, "force": np.zeros((3, 3))}, "one column"),
        ({"fs": 100.0, "seconds": 0.001}, "at least two"),
    ],
)
def test_a_simulation_of_nothing_is_refused(plain, options, said):
    with pytest.raises(BadInput, match=said):
        plain.simulate(**options)


def test_the_backbone_of_a_linear_rig_is_its_frequency():
    rig = {"omega0": 40.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.8, "dry": 0.0}
    curve = dashpot.Model.from_values(rig).backbone([1e-3, 2e-3])
    np.testing.assert_allclose(curve.frequency, 40.0 / (2 * np.pi))
    np.testing.assert_allclose(curve.damping_ratio, 0.01)
    assert "1 % damping at 1 mm" in repr(curve)


def test_saved_is_loaded(model, tmp_path):
    path = model.save(tmp_path / "rig.yaml")
    again = dashpot.load(path)
    assert again["omega0"].value == model["omega0"].value
    assert again.identification is None
    report = model.save(tmp_path / "rig.html").read_text(encoding="utf-8")
    assert "<title>Identification of stand</title>" in report
    with pytest.raises(BadInput, match="this model has none"):
        again.save(tmp_path / "again.html")
    with pytest.raises(BadInput, match="use export"):
        model.save(tmp_path / "rig.fmu")
    assert json.loads(json.dumps(model.as_json()))["machine"]["natural_frequency"]["unit"] == "Hz"


def test_a_model_by_its_file_and_a_mistyped_parameter(plain, tmp_path):
    path = plain.save(tmp_path / "rig.yaml")
    assert dashpot.linearise(path, amplitude=1e-3).A.shape == (2, 2)
    with pytest.raises(KeyError, match="did you mean friction"):
        plain["frition"]
    with pytest.raises(BadInput, match=r"\{\} is no model"):
        dashpot.linearise({})


def test_the_model_verifies_as_an_fmu(model, sweep):
    proof = model.verify(sweep)
    assert proof.passed
    assert repr(proof).count("\n") == 1


@pytest.mark.long  # tests/face/test_hilbert.py and the example of its docstring have a case each
def test_hilbert_writes_what_the_command_does(tmp_path):
    analysis = dashpot.hilbert(dashpot.examples.recordings()["bursts"], part="0:8")
    assert [path.name for path in analysis.save(tmp_path / "curves")] == ["curves.csv", "hilbert.json", "report.html"]
    assert "<svg" in analysis._repr_html_()
    assert repr(analysis).startswith("FREEVIB")


@pytest.mark.parametrize(
    ("quantity", "unit", "said"),
    [
        ("displacement", "mm", "the numbers are in SI; give them and the unit in m"),
        ("displacement", "m/s2", "measures acceleration, and the response is a displacement"),
        ("displacement", "foo", "unit 'foo' is not known"),
        ("displacement", "kg", "unit 'kg' is not known"),
    ],
)
def test_a_unit_that_the_response_cannot_have_is_refused(quantity, unit, said):
    with pytest.raises(BadInput, match=said):
        Model.from_values(TRUTH, quantity=quantity, unit=unit)


def test_a_model_is_asked_for_names_as_a_mapping_is():
    model = Model.from_values(TRUTH)
    assert "dry" in model
    assert "friction" in model
    assert "no" not in model
    assert list(model) == list(model.parameters)

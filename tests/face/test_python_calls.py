"""Calls as Python has them: help that shows them, pickles for other processes, errors in the words of arguments."""

from __future__ import annotations

import logging
import multiprocessing
import pickle
import pydoc
import re
import subprocess
import sys
from functools import partial
from importlib.util import find_spec

import dashpot
import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.face.python_words import in_python
from dashpot.recording import Reading

FOLDERS = ["identify", "diagnose", "verify", "simulate", "export"]
BURSTS = dashpot.examples.recordings("paper-stand")["bursts"]


@pytest.fixture(scope="module")
def model() -> dashpot.Model:
    return dashpot.identify(BURSTS, part="0:15", name="stand")


@pytest.mark.parametrize("name", FOLDERS)
def test_help_shows_the_call_with_its_arguments(name):
    text = pydoc.render_doc(getattr(dashpot, name), renderer=pydoc.plaintext)
    assert f"dashpot.{name} - {name}(...)" in text
    assert f"    {name}(\n" in text
    assert "PACKAGE CONTENTS" in text
    if name == "identify":
        assert "        fixed: Mapping[str, float | str] | None = None,\n" in text
        assert all(f"        {way}: " in text for way in Reading.__annotations__)
        assert "parameters that keep a value, by name" in text


def test_help_is_the_same_in_a_fresh_python_and_imports_nothing_before():
    code = "import sys, dashpot; heavy = 'numpy' in sys.modules; print(heavy, dashpot.identify.__doc__[:13])"
    run = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["False", "identify(...)"]


@pytest.mark.parametrize("name", [*FOLDERS, "read", "look", "hilbert", "linearise", "load"])
def test_calls_are_handed_to_other_processes(name):
    call = getattr(dashpot, name)
    assert pickle.loads(pickle.dumps(call)) is call
    if find_spec("cloudpickle"):  # what Dask and joblib pickle with
        import cloudpickle

        assert cloudpickle.loads(cloudpickle.dumps(call)) is call


def test_results_come_back_from_other_processes(model):
    recording = dashpot.read(BURSTS, part="0:3")[0]
    simulation = model.simulate(recording)
    for thing in (model, model.identification, recording, simulation, model.linearise(1e-3), model.backbone()):
        back = pickle.loads(pickle.dumps(thing))
        assert type(back) is type(thing)
        assert repr(back) == repr(thing)
    back = pickle.loads(pickle.dumps(model))
    assert back.oscillator == model.oscillator
    assert np.array_equal(pickle.loads(pickle.dumps(simulation)).response, simulation.response)
    assert np.array_equal(pickle.loads(pickle.dumps(recording)).response, recording.response)
    assert np.array_equal(back.simulate(recording).response, simulation.response)


def decays() -> list[dict[str, np.ndarray]]:
    t = np.arange(1500) / 500.0
    noise = np.random.default_rng(1).normal(size=(2, t.size)) * 1e-6
    return [
        {"time_s": t, "x_m": 5e-3 * np.exp(-h * t) * np.cos(60.0 * t) + e}
        for h, e in zip((2.0, 3.0), noise, strict=True)
    ]


def test_a_pool_identifies():
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        models = pool.map(dashpot.identify, decays())
    assert [m["viscous"].value / 2 for m in models] == pytest.approx([2.0, 3.0], rel=1e-2)


def test_joblib_identifies():
    joblib = pytest.importorskip("joblib", reason="joblib is not installed")
    call = joblib.delayed(partial(dashpot.identify, every=True))
    models = joblib.Parallel(n_jobs=1)(call(one) for one in decays())
    assert [m["viscous"].value / 2 for m in models] == pytest.approx([2.0, 3.0], rel=1e-2)


@pytest.mark.parametrize(
    ("sentence", "wanted"),
    [
        ("leave the force out with --force none", "leave the force out with force='none'"),
        ("(--fix cubic=0) to go on", "(fixed={'cubic': 0}) to go on"),
        ("--fix NAME=VALUE", "fixed={'NAME': VALUE}"),
        ("give it with --mass KG", "give it with mass=KG"),
        ("choose with --time", "choose with time="),
        ("with --time 1 --response 2", "with time=1 response=2"),
        ("(--part FROM:TO)", "(part='FROM:TO')"),
        ("(--with time-delay)", "(laws='time-delay')"),
        ("--calibration response=-1 turns it", "calibration={'response': -1} turns it"),
        ("state --unit mm if so", "state unit='mm' if so"),
        ("with --quantity and --unit", "with quantity= and unit="),
        ("--hold zero says so", "hold='zero' says so"),
        ("--absolute", "relative=False"),
        ("leave out --fmi 3", "leave out version=3"),
        ("--force-unit states another", "force_unit= states another"),
        ("--mode 99: there is", "mode=99: there is"),
        ("1 -- 2, a--b, pip install --upgrade", "1 -- 2, a--b, pip install --upgrade"),
    ],
)
def test_options_are_said_as_arguments(sentence, wanted):
    assert in_python(sentence) == wanted


def test_errors_speak_python(model):
    x = np.cos(np.arange(4000) / 20)
    for call, said in (
        (lambda: dashpot.identify(BURSTS, part="0:15", mode=99), "mode=99: there is no such mode"),
        (lambda: dashpot.read(BURSTS, force=np.zeros(5)), "so force= names its column"),
        (lambda: dashpot.read(x), "with fs, in Hz, or its times with time, in s"),
        (lambda: model.simulate({"time_s": np.arange(4000) / 1e3, "v_m_s": x, "a": x}), "response="),
        (lambda: model.export("rig.ssp", version=3), "leave out version=3"),
    ):
        with pytest.raises(dashpot.BadInput) as caught:
            call()
        assert said in str(caught.value)
        assert "--" not in str(caught.value)


def test_the_command_line_keeps_its_words(tmp_path):
    command = [
        sys.executable,
        "-P",
        "-m",
        "dashpot",
        "identify",
        str(BURSTS),
        "--part",
        "0:15",
        "--mode",
        "99",
        "-o",
        "m.yaml",
    ]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert "--mode 99: there is no such mode" in run.stderr


def test_a_force_has_its_times(model):
    t = np.arange(500) / 1000.0
    force = np.sin(80 * t)
    wanted = model.simulate(force=force, fs=1000.0)
    assert np.allclose(model.simulate(force=force, time=t).response, wanted.response, rtol=1e-9, atol=1e-15)
    assert np.array_equal(model.simulate(force=force, fs="1 kHz").response, wanted.response)
    with pytest.raises(dashpot.BadInput, match="do not go on in even steps"):
        model.simulate(force=force, time=t**2)
    with pytest.raises(dashpot.BadInput, match=r"shape \(500,\), the times \(3,\)"):
        model.simulate(force=force, time=t[:3])
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    series = pandas.Series(force, index=t)
    assert np.allclose(model.simulate(force=series).response, wanted.response, rtol=1e-9, atol=1e-15)


def test_what_is_known_goes_in_with_its_unit():
    fixed = {"friction": "4.05 mN", "natural_frequency": "12.67 Hz"}
    model = dashpot.identify(BURSTS, part="0:15", fixed=fixed, mass="270 g")
    assert model["dry"].value == pytest.approx(0.015, rel=1e-12)
    assert model["omega0"].value == pytest.approx(2 * np.pi * 12.67, rel=1e-12)
    assert model["dry"].std is None
    with pytest.raises(dashpot.BadInput, match=r"friction = 0\.15 N is a product with the mass, which is not given"):
        dashpot.identify(BURSTS, part="0:15", fixed={"friction": "0.15 N"})


def test_linearise_takes_the_amplitude_first():
    model = dashpot.Model.from_values(TRUTH)
    assert np.array_equal(model.linearise(1e-3).A, model.linearise(amplitude=1e-3).A)
    assert np.array_equal(dashpot.linearise(model, 1e-3).A, model.linearise(1e-3).A)
    with pytest.raises(TypeError, match="did you mean frequency"):
        model.linearise(1e-3, frequncy=2.0)


def test_what_is_tried_goes_to_the_logger(caplog):
    with caplog.at_level(logging.INFO, logger="dashpot"):
        dashpot.identify(decays()[0])
    assert caplog.records
    assert all(record.name.startswith("dashpot.") for record in caplog.records)
    said = [record.getMessage() for record in caplog.records]
    assert any(re.match(r"without .*: log-odds|every member stays", line) for line in said)

"""The reference result inside an FMU: met by the FMU under FMPy and by an independent integrator, within validity."""

from __future__ import annotations

import io
import re
import subprocess
import sys
import zipfile
import zlib
from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.export import reference as module
from dashpot.export.description import describe_fmu
from dashpot.export.facts import Facts
from dashpot.export.fmu import export_fmu
from dashpot.export.reference import FOLDER, Reference, reference, reference_result
from dashpot.model import Range
from fmpy import simulate_fmu
from fmpy.util import read_csv

LAWS = [
    "hysteresis",
    "tonal-disturbance",
    "stiffness-drift",
    "actuator-dead-zone",
    "actuator-backlash",
    "two-sided-stop",
]


def result_of(model) -> dict[str, bytes]:
    """The files of the reference result of a model."""
    facts = Facts(model)
    return reference_result(facts, describe_fmu(facts))


def column(files: dict[str, bytes], name: str) -> np.ndarray:
    """A table of the reference by its columns."""
    return np.genfromtxt(io.BytesIO(files[f"{FOLDER}/{name}"]), delimiter=",", names=True)


def distance(result, expected, names=("x", "displacement", "velocity", "acceleration")) -> float:
    """Largest difference of the columns, each over its peak."""
    return max(float(np.max(np.abs(result[n] - expected[n])) / np.max(np.abs(expected[n]))) for n in names)


def within(folder, path) -> dict[str, bytes]:
    """The reference out of an archive, its input also as a file."""
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist() if name.startswith(FOLDER)}
    (folder / "input.csv").write_bytes(files[f"{FOLDER}/input.csv"])
    return files


@pytest.mark.parametrize("kind", ["base", "massless", "drag", "velocity", "acceleration"])
def test_the_fmu_under_fmpy_meets_it_with_the_force_held(fmus, tmp_path, kind):
    files = within(tmp_path, fmus(kind, "native"))
    expected = column(files, "output_held.csv")
    result = simulate_fmu(
        str(fmus(kind, "native")),
        input=read_csv(tmp_path / "input.csv"),
        output_interval=expected["time"][1],
        stop_time=expected["time"][-1],
    )
    assert result.size == expected.size
    assert distance(result, expected) < 1e-6


@pytest.mark.parametrize("backend", ["native", "python"])
@pytest.mark.parametrize("kind", ["base", "acceleration"])
def test_the_fmu_meets_it_with_the_force_in_straight_lines(fmus, instances, tmp_path, kind, backend):
    files = within(tmp_path, fmus(kind, backend))
    expected, force = column(files, "output_straight.csv"), column(files, "input.csv")["F"]
    names = expected.dtype.names[1:]
    rows = instances(kind, backend).start(F=force[0]).record(force, expected["time"][1], *names)
    result = {name: np.array(rows)[:, i] for i, name in enumerate(names)}
    assert distance(result, expected) < 1e-6


@pytest.mark.parametrize("effect", LAWS)
def test_laws_of_every_kind_are_met(with_law, tmp_path, effect):
    path = export_fmu(with_law(effect), tmp_path / "rig.fmu")
    expected = column(within(tmp_path, path), "output_held.csv")
    given = {"output_interval": expected["time"][1], "stop_time": expected["time"][-1]}
    assert distance(simulate_fmu(str(path), input=read_csv(tmp_path / "input.csv"), **given), expected) < 1e-6


def test_an_integrator_that_shares_no_code_meets_it(models):
    files = result_of(models["base"]())
    expected, force = column(files, "output_straight.csv"), column(files, "input.csv")["F"]
    x, v = integrate(models["base"]().values(), force, float(expected["time"][1]))
    assert distance({"displacement": x, "velocity": v}, expected, ("displacement", "velocity")) < 1e-6


def test_the_command_in_its_readme_repeats_it(fmus, tmp_path):
    files = within(tmp_path, fmus("base", "native"))
    words = files[f"{FOLDER}/README.txt"].decode()
    (command,) = re.findall(r"fmpy (simulate .*)", words)
    arguments = command.replace("FILE.fmu", str(fmus("base", "native"))).split()
    subprocess.run(
        [sys.executable, "-P", "-m", "fmpy", *arguments, "--output-file", "out.csv"], cwd=tmp_path, check=True
    )
    assert distance(read_csv(tmp_path / "out.csv"), column(files, "output_held.csv")) < 1e-6


def test_it_stays_within_validity_and_says_what_it_is(models):
    model = replace(models["base"](), amplitude=Range(2e-4, 4e-3, "m"), frequency=Range(10.0, 14.0, "Hz"))
    result = reference(Facts(model))
    assert isinstance(result, Reference)
    assert (result.start, result.end) == (10.0, 14.0)
    assert 0.45 * 4e-3 <= np.max(np.abs(result.straight[:, 1])) <= 0.9 * 4e-3
    assert np.max(np.abs(result.force)) == pytest.approx(result.level, rel=1e-2)
    assert np.max(np.abs(result.held - result.straight)) > 0
    files = result_of(model)
    words = files[f"{FOLDER}/README.txt"].decode()
    assert "from 10 to 14 Hz" in words
    assert "valid to 0.004 m" in words
    # the formula that it states is the input
    level, start, bend = map(float, re.findall(r"F\(t\) = (\S+) N sin\(2 pi \((\S+) t \+ (\S+) t\^2\)\)", words)[0])
    given = column(files, "input.csv")
    assert np.allclose(
        given["F"], level * np.sin(2 * np.pi * (start * given["time"] + bend * given["time"] ** 2)), atol=1e-5
    )


def test_it_is_small_and_the_same_every_time(models):
    for kind in models:
        files = result_of(models[kind]())
        assert files == result_of(models[kind]())
        assert sum(len(zlib.compress(content)) for content in files.values()) < 40_000
        assert b"nan" not in b"".join(content for name, content in files.items() if name.endswith(".csv"))


def test_without_a_compiler_it_is_the_same(models, monkeypatch):
    expected = reference(Facts(models["acceleration"]()))
    monkeypatch.setattr(module, "find_compiler", lambda: None)
    result = reference(Facts(models["acceleration"]()))
    assert isinstance(result, Reference)
    assert isinstance(expected, Reference)
    assert result.level == expected.level
    for rows, expected_rows in ((result.straight, expected.straight), (result.held, expected.held)):
        assert np.max(np.abs(rows - expected_rows) / np.max(np.abs(expected_rows), axis=0)) < 1e-6


def test_where_there_is_none_it_is_said(models, with_law):
    feeding = models["base"]().with_parameters({"viscous": replace(models["base"]().viscous, value=-200.0)})
    assert "no sweep from rest was found" in result_of(feeding)[f"{FOLDER}/README.txt"].decode()
    fast = with_law("sensor-lag", **{"sensor-lag.time": 1e-9})
    files = result_of(fast)
    assert list(files) == [f"{FOLDER}/README.txt"]
    assert "needs internal steps of" in files[f"{FOLDER}/README.txt"].decode()
    nowhere = replace(models["base"](), amplitude=Range(0.0, 0.0, "m"))
    assert isinstance(reference(Facts(nowhere)), str)

"""Readers of other installed packages: a small one, and broken ones, as distributions on the path."""

from __future__ import annotations

import gzip
import sys

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read, read_records
from dashpot.recording.formats import installed

READER = """
import numpy as np

def read(name, content):
    if not content.startswith(b"WAVY"):
        raise ValueError("it does not begin with WAVY")
    rate, rows = np.frombuffer(content[4:12], "<f8")[0], np.frombuffer(content[12:], "<f8").reshape(-1, 2)
    return {"fs": rate, "force_N": rows[:, 0], "x_mm": rows[:, 1]}

def runs(name, content):
    one = read(name, content)
    return {"first": one, "second": one | {"x_mm": 2 * one["x_mm"]}}

def nothing(name, content):
    return 7

constant = 3
"""
T = np.arange(1500) / 500.0
X, F = 4e-3 * np.exp(-2 * T) * np.cos(70 * T), np.sin(2 * np.pi * (4 + 3 * T) * T)
CONTENT = b"WAVY" + np.array([500.0]).tobytes() + np.column_stack([F, 1e3 * X]).tobytes()


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Puts a package with readers on the path, as pip leaves it."""

    def install(**points):
        folder = tmp_path / "packages"
        told = folder / "wavy-1.0.dist-info"
        told.mkdir(parents=True)
        (told / "METADATA").write_text("Metadata-Version: 2.1\nName: wavy\nVersion: 1.0\n")
        lines = [f"[{installed.GROUP}]", *(f"{name} = {value}" for name, value in points.items())]
        (told / "entry_points.txt").write_text("\n".join(lines) + "\n")
        (folder / "dashpot_wavy.py").write_text(READER)
        monkeypatch.syspath_prepend(str(folder))

    yield install
    sys.modules.pop("dashpot_wavy", None)


def test_its_files_are_read_as_any_other(package, tmp_path):
    package(wvy="dashpot_wavy:read", Runs="dashpot_wavy:runs")
    (tmp_path / "rec.wvy").write_bytes(CONTENT)
    (tmp_path / "rec.WVY.gz").write_bytes(gzip.compress(CONTENT))
    for name in ("rec.wvy", "rec.WVY.gz"):
        recording = read(tmp_path / name)
        np.testing.assert_allclose(recording.response, X, rtol=1e-15)
        np.testing.assert_allclose(recording.force, F, rtol=1e-15)
        assert (recording.fs, recording.unit, recording.name) == (500.0, "m", name)
    (tmp_path / "rec.runs").write_bytes(CONTENT)
    assert [recording.name for recording in read_records(tmp_path / "rec.runs")] == [
        "rec.runs#first",
        "rec.runs#second",
    ]
    np.testing.assert_allclose(read(f"{tmp_path / 'rec.runs'}#second").response, 2 * X, rtol=1e-15)


@pytest.mark.parametrize(
    ("named", "says"),
    [
        ("dashpot_wavy:read", r"cannot be read by wavy \(dashpot\.readers: wvy\): it does not begin with WAVY; export"),
        ("dashpot_wavy:absent", r"wavy \(dashpot\.readers: wvy\): cannot be imported \(AttributeError: .*\); correct"),
        ("dashpot_no_such:read", r"cannot be imported \(ModuleNotFoundError: .*\); correct the package, or uninstall"),
        ("dashpot_wavy:constant", r"is a int and no function; name what reads \(name, content\)"),
        ("dashpot_wavy:nothing", r"int is no kind of recording; .* \(given by wavy \(dashpot\.readers: wvy\)\)"),
    ],
)
def test_what_is_wrong_with_it_is_one_sentence(package, tmp_path, named, says):
    package(wvy=named)
    (tmp_path / "rec.wvy").write_bytes(b"something else")
    with pytest.raises(BadInput, match=says) as caught:
        read(tmp_path / "rec.wvy")
    assert "\n" not in str(caught.value)


def test_a_kind_that_nobody_reads_names_those_that_are_read(package, tmp_path):
    package(wvy="dashpot_wavy:read")
    (tmp_path / "rec.odd").write_bytes(b"x")
    with pytest.raises(BadInput, match=r"files of the kind '\.odd' cannot be read; supported are \.csv, .*\.wvy, each"):
        read(tmp_path / "rec.odd")


def test_a_package_takes_no_kind_that_is_read_already(package, tmp_path):
    package(csv="dashpot_wavy:nothing")
    rows = "\n".join(f"{t!r},{x!r}" for t, x in zip(T.tolist(), X.tolist(), strict=True))
    (tmp_path / "rec.csv").write_text(f"time_s,x_m\n{rows}\n")
    assert read(tmp_path / "rec.csv").n == T.size

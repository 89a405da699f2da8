"""Which back-end an export takes, and what it says where it cannot take the native one."""

from __future__ import annotations

import zipfile

import pytest
from dashpot.errors import BadInput, ToolchainMissing
from dashpot.export import export
from dashpot.export.backend import choose_backend
from dashpot.export.platforms import PLATFORMS, own_platform, parse_platforms


def test_what_is_asked_for_is_taken():
    assert choose_backend(None) == "native"
    assert choose_backend("native") == "native"
    assert choose_backend("python") == "python"


def test_without_a_compiler_the_model_runs_in_python_and_that_is_said(no_compiler, models, tmp_path):
    said = []
    (path,) = export(models["base"](), tmp_path / "rig.fmu", progress=said.append)
    (sentence,) = said
    for word in ("no C compiler", "Python with the package casadi", "slower", "co-simulation only", "pip install"):
        assert word in sentence
    with zipfile.ZipFile(path) as archive:
        assert "resources/step.casadi" in archive.namelist()
        assert "needs Python with the package casadi" in archive.read("documentation/index.html").decode()


def test_without_a_listener_it_is_a_warning(no_compiler):
    with pytest.warns(UserWarning, match="runs its model in Python"):
        assert choose_backend(None) == "python"


@pytest.mark.parametrize("asked", [{"backend": "native"}, {"platforms": parse_platforms("all")}])
def test_what_was_asked_for_by_name_is_not_replaced(no_compiler, models, tmp_path, asked):
    with pytest.raises(ToolchainMissing, match="no C compiler was found"):
        export(models["base"](), tmp_path / "rig.fmu", **asked)
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_is_refused():
    with pytest.raises(BadInput, match="'native' or 'python'"):
        choose_backend("java")
    with pytest.raises(BadInput, match="leave the platforms out"):
        choose_backend("python", PLATFORMS)


@pytest.mark.parametrize(
    ("name", "asked", "words"),
    [
        ("rig.fmu", {"version": 4}, "use 2 or 3"),
        ("rig.fmu", {"version": 3, "backend": "python"}, "leave out --fmi 3"),
        ("rig.ssp", {"version": 3}, "leave out --fmi 3"),
    ],
)
def test_a_version_that_cannot_be_is_refused(models, tmp_path, name, asked, words):
    with pytest.raises(BadInput, match=words):
        export(models["base"](), tmp_path / name, **asked)
    assert list(tmp_path.iterdir()) == []


def test_a_platform_that_cannot_be_built_here_is_refused_with_how_to_have_it(no_zig, models, tmp_path, monkeypatch):
    monkeypatch.setattr("dashpot.simulate.compiler.find_compiler", lambda: "cc")
    others = [p for p in PLATFORMS if p != own_platform()]
    with pytest.raises(ToolchainMissing, match=rf"no compiler for {others[0].name}.*pip install"):
        export(models["base"](), tmp_path / "rig.fmu", platforms=PLATFORMS)
    assert list(tmp_path.iterdir()) == []

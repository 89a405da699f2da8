from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest
from dashpot.errors import ToolchainMissing
from dashpot.simulate.compiler import find_compiler, machine_compiler, shared_library
from dashpot.simulate.zig import zig_version

ANSWER = {"a.c": '__attribute__((visibility("default"))) int answer(void) { return 42; }\n'}


@pytest.fixture(autouse=True)
def own_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path / "cache"))


def test_a_library_is_built_once_and_then_taken_from_the_cache():
    first = shared_library(ANSWER, "a.c")
    stamp = first.stat().st_mtime_ns
    assert ctypes.CDLL(str(first)).answer() == 42
    assert shared_library(ANSWER, "a.c") == first
    assert first.stat().st_mtime_ns == stamp
    assert list(first.parent.iterdir()) == [first]  # nothing left over


def test_what_the_compiler_says_is_passed_on_and_nothing_stays(tmp_path):
    with pytest.raises(ToolchainMissing, match="failed"):
        shared_library({"a.c": "not C"}, "a.c")
    assert list((tmp_path / "cache" / "compiled").iterdir()) == []


def test_no_compiler_is_said_with_what_to_do(no_compiler):
    assert find_compiler() is None
    assert machine_compiler() is None
    with pytest.raises(ToolchainMissing, match=r"install gcc or clang.*pip install"):
        shared_library(ANSWER, "a.c")


def test_the_same_texts_are_compiled_once(monkeypatch):
    shared_library(ANSWER, "a.c")
    monkeypatch.setattr(subprocess, "Popen", None)
    shared_library(ANSWER, "a.c")
    with pytest.raises(TypeError):  # other flags are another library
        shared_library(ANSWER, "a.c", flags=("-DX",))


@pytest.mark.skipif(zig_version() is None, reason="the package ziglang is not installed")
def test_zig_is_this_machines_compiler_where_there_is_no_other(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    library = shared_library(ANSWER, "a.c")
    assert ctypes.CDLL(str(library)).answer() == 42
    assert list((tmp_path / "cache" / "compiled").iterdir()) == [library]
    with pytest.raises(ToolchainMissing, match=r"of the package ziglang failed: .*error"):
        shared_library({"a.c": "not C"}, "a.c")


def test_the_second_command_of_a_day_compiles_nothing(monkeypatch, tmp_path):
    """What the first has compiled is loaded by a process of its own, on a machine without a compiler."""
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path))
    program = (
        "import dashpot; from dashpot.examples.virtual_recording import recording_of;"
        "from dashpot.simulate import compiler;{}"
        "print(dashpot.identify(recording_of(begin=(9e-3, 0.0), seconds=2.0)).parameters['omega0'].value)"
    )
    nothing = "compiler._compile = None;"
    said = [
        subprocess.run([sys.executable, "-P", "-c", program.format(how)], capture_output=True, text=True, check=True)
        for how in ("", nothing)
    ]
    assert said[0].stdout == said[1].stdout != ""

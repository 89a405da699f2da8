from __future__ import annotations

import ctypes

import pytest
from dashpot.errors import ToolchainMissing
from dashpot.simulate.compiler import find_compiler, shared_library

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
    assert not list((tmp_path / "cache").glob("core-*"))


def test_no_compiler_is_said_with_what_to_do(monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    assert find_compiler() is None
    with pytest.raises(ToolchainMissing, match="install gcc or clang"):
        shared_library(ANSWER, "a.c")

"""Sentences are held against the file word by word, and written there on request."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import pytest


@pytest.fixture
def sentences():
    """The module that holds them."""
    return sys.modules["sentences"]


@pytest.fixture
def node():
    return SimpleNamespace(nodeid="tests/a.py::test_words[old]", stash=pytest.Stash())


def test_a_sentence_reads_as_the_file_has_it_word_by_word(sentences, node):
    held = sentences.Sentences(False, bool)
    held.table = {"tests/a.py::test_words": {"old": "m.yaml: is empty"}}
    held.reads(node, "m.yaml: is empty", "old")
    with pytest.raises(AssertionError):
        held.reads(node, "m.yaml: is empty.", "old")
    with pytest.raises(AssertionError, match="--write-sentences"):
        held.reads(node, "m.yaml: is empty", "new")


def test_what_a_run_gives_replaces_its_tests_and_no_others(sentences, node, monkeypatch, tmp_path):
    monkeypatch.setattr(sentences, "SENTENCES", tmp_path / "sentences.yaml")
    run = sentences.Sentences(True, lambda test: "gone" not in test)
    run.table = {"tests/a.py::test_words": {"old": "x"}, "tests/b.py::test": {"it": "y"}, "gone": {"it": "z"}}
    run.reads(node, "line 1: 'a' has no unit: write 1/s\nline 2: - é", "new")
    run.pytest_runtest_logreport(SimpleNamespace(sentences=node.stash[sentences.GIVEN]))
    run.pytest_terminal_summary()
    assert sentences.known(tmp_path / "sentences.yaml") == {
        "tests/a.py::test_words": {"new": "line 1: 'a' has no unit: write 1/s\nline 2: - é"},
        "tests/b.py::test": {"it": "y"},
    }
    with pytest.raises(AssertionError, match="two texts"):
        run.pytest_runtest_logreport(SimpleNamespace(sentences=[("tests/a.py::test_words", "new", "another")]))


def test_every_test_in_the_file_is_there(sentences):
    assert [test for test in sentences.known() if not sys.modules["lanes"].exists(test)] == []

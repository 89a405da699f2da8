"""The text of an error, whatever stands in it."""

from __future__ import annotations

from dashpot.errors import LONGEST, BadInput


def test_a_long_sentence_keeps_what_and_what_to_do():
    name = "n" * 6000
    text = str(BadInput(f"sweep.csv: column {name} is not there; name it with --response\nline two"))
    first, second = text.split("\n")
    assert first.startswith("sweep.csv: column nnn")
    assert first.endswith("nnn is not there; name it with --response")
    assert " [...] " in first
    assert len(first) <= LONGEST
    assert second == "line two"
    as_long_as_may_be = "x" * LONGEST
    assert str(BadInput(as_long_as_may_be)) == as_long_as_may_be


def test_what_would_steer_a_terminal_is_not_printed():
    assert str(BadInput("a\x1b[2Jb\r\nc")) == "a\ufffd[2Jb\ufffd\nc"

"""What a terminal shows while a command works."""

from __future__ import annotations

import io
import sys
import threading

from dashpot.commands import waiting
from dashpot.commands.waiting import Waiting


class Terminal(io.StringIO):
    """A stream that says when a text with some words was written to it."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: dict[str, threading.Event] = {}

    def isatty(self) -> bool:
        return True

    def write(self, text: str) -> int:
        for words, event in list(self.heard.items()):
            if words in text:
                event.set()
        return super().write(text)

    def waits_for(self, words: str) -> threading.Event:
        return self.heard.setdefault(words, threading.Event())


def terminal_of(patch):
    """The streams as a terminal has them, and a wait of nothing taken for a long one."""
    stream = Terminal()
    patch.setattr("sys.stderr", stream)
    patch.setattr("sys.stdout", Terminal())
    patch.setattr(Waiting.__init__, "__defaults__", (0.0, 0.01))
    return stream


def test_a_long_wait_is_told_and_goes_before_other_words(monkeypatch):
    terminal = terminal_of(monkeypatch)

    with waiting.waiting_shown():
        shown = terminal.waits_for("… maximum likelihood (")
        waiting.doing("maximum likelihood")
        assert shown.wait(20)
        print("note: something", file=sys.stderr)
        before, _, after = terminal.getvalue().partition("note: something")
        assert before.endswith("\r\x1b[K")
    assert terminal.getvalue().endswith("\r\x1b[K") or after == "\n"
    assert sys.stderr is terminal


def test_a_work_whose_parts_are_known_has_a_bar_with_the_time_to_go(monkeypatch):
    terminal = terminal_of(monkeypatch)
    now = [1000.0]
    monkeypatch.setattr(waiting.time, "monotonic", lambda: now[0])
    with waiting.waiting_shown():
        half = terminal.waits_for("[##########..........] 50 % a law (30 s, about 30 s to go)")
        later = terminal.waits_for("50 % another law (40 s, about 20 s to go)")
        after = terminal.waits_for("… something else (")
        with waiting.counted():
            now[0] = 1030.0
            waiting.doing("a law", 0.5)
            assert half.wait(20)
            now[0] = 1040.0
            waiting.doing("another law", 0.4)  # it never goes back
            assert later.wait(20)
        waiting.doing("something else")
        assert after.wait(20)


def test_a_result_on_stdout_takes_the_line_away(monkeypatch):
    terminal = terminal_of(monkeypatch)

    with waiting.waiting_shown():
        assert terminal.waits_for("… reading (").wait(20)
        waiting.silence()
        print("result")
        assert terminal.getvalue().endswith("\r\x1b[K")
        assert sys.stdout.getvalue() == "result\n"


def test_nothing_is_told_where_there_is_no_terminal(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr("sys.stderr", stream)
    with waiting.waiting_shown():
        waiting.doing("something")
        assert waiting._now is None
    assert stream.getvalue() == ""

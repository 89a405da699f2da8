"""What a terminal shows while a command works."""

from __future__ import annotations

import io
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from dashpot.commands import cli, terminal, waiting
from dashpot.commands.waiting import Waiting
from dashpot.examples.truth import TRUTH
from dashpot.face import workflow
from dashpot.model import Oscillator
from dashpot.model.file import save


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


def test_a_note_or_a_result_is_no_stage(monkeypatch):
    terminal_of(monkeypatch)
    with waiting.waiting_shown():
        now = waiting._now
        assert now is not None
        terminal.stage("maximum likelihood")
        terminal.say("note: decay.csv: the model leaves more than noise")
        terminal.say("written: rig.yaml")
        assert now.doing == "maximum likelihood"
        terminal.drawing()
        assert now.doing == workflow.WRITING


@pytest.fixture
def stages(monkeypatch):
    """What a terminal would show, in order."""
    seen: list[str] = []
    for module in (cli, terminal):
        monkeypatch.setattr(module, "doing", lambda what, _part=None: seen.append(what))
    return seen


@pytest.fixture
def decay(tmp_path):
    t = np.arange(1500) / 500.0
    x = 4e-3 * np.exp(-1.0 * t) * np.cos(60.0 * t) + 1e-6 * np.random.default_rng(0).standard_normal(t.size)
    rows = (f"{a:.3f},{b:.9g}" for a, b in zip(t, x, strict=True))
    (tmp_path / "decay.csv").write_text("\n".join(["time_s,x_m", *rows]))
    return tmp_path / "decay.csv"


@pytest.mark.parametrize("command", ["identify", "hilbert", "look"])
def test_files_are_written_under_a_stage_of_their_own(command, decay, stages, tmp_path):
    to = {"identify": ["-o", "m.yaml"], "hilbert": ["-o", "h"], "look": ["--page", "l.html"]}
    ways = [word if word.startswith("-") else str(tmp_path / word) for word in to[command]]
    ended = CliRunner().invoke(cli.cli, [command, str(decay), *ways])
    assert ended.exit_code == 0, ended.output
    assert stages[-1] == workflow.WRITING
    assert not [stage for stage in stages if stage.startswith(("note", "written"))]
    assert workflow.WRITING not in ended.output  # which is for a terminal alone


def test_a_diagnosis_that_is_done_is_written(decay, stages, tmp_path, monkeypatch):
    found = SimpleNamespace(verdict="consistent", as_json=dict)

    def write_diagnosis(*_):
        assert stages == [workflow.WRITING]
        return []

    monkeypatch.setattr(workflow, "diagnosed", lambda *_, **__: (found, None))
    monkeypatch.setattr(workflow, "write_diagnosis", write_diagnosis)
    save(Oscillator.from_values(TRUTH), tmp_path / "m.yaml")
    given = ["diagnose", str(tmp_path / "m.yaml"), str(decay), "-o", str(tmp_path / "d"), "--json"]
    ended = CliRunner().invoke(cli.cli, given)
    assert ended.exit_code == 0, ended.output

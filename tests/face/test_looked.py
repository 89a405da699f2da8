"""What dashpot.look gives in Python: dictionaries that print in words, show themselves, and are written as a page."""

from __future__ import annotations

import json
import re
from html import unescape
from pathlib import Path

import dashpot
import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.errors import BadInput

T = np.arange(3000) / 500.0
X = 5e-3 * np.exp(-1.0 * T) * np.cos(2 * np.pi * 12.67 * T) + 1e-6 * np.random.default_rng(0).normal(size=T.size)


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.savez("runs.npz", **{"fs": 500.0, "a/x_mm": 1e3 * X, "b/x_mm": 2e3 * X})
    return "runs.npz"


def ended(*arguments: str) -> int:
    try:
        main(list(arguments))
    except SystemExit as end:
        return int(end.code or 0)
    return 0


def command(text: str) -> list[str]:
    return [unescape(found) for found in re.findall(r'data-command="([^"]*)"', text)]


def test_it_is_what_the_command_prints_in_both_ways(file, capsys):
    looked = dashpot.look(file)
    assert ended("look", file, "--json") == 0
    assert json.loads(capsys.readouterr().out) == looked
    assert ended("look", file) == 0
    assert capsys.readouterr().out == f"{looked!r}\n"
    (left,) = looked[0]["recordings"][0]["left"] or [{"why": "none"}]
    assert set(left) <= {"start", "stop", "why"}


def test_a_notebook_shows_it_with_what_to_type_in_python(file):
    shown = dashpot.look(f"{file}#b", part="1:")._repr_html_()
    assert shown.startswith("<iframe srcdoc=")
    assert command(unescape(shown.partition("title=")[0])) == ["dashpot.identify('runs.npz#b'{})"]
    assert "<pre>runs.npz#b\n" in shown


def test_a_page_is_written_with_each_record_by_its_address(file, capsys):
    assert ended("look", file, "--page", "look.html") == 0
    assert capsys.readouterr().err == "written: look.html\n"
    text = Path("look.html").read_text(encoding="utf-8")
    tail = "{} -o rig.yaml --report rig.html"
    assert command(text) == [f"dashpot identify 'runs.npz#{name}'{tail}" for name in "ab"]
    typed = f", by: dashpot look {file} --page look.html"  # which a call from Python has not
    assert dashpot.look(file).save("other.html").read_text(encoding="utf-8") == text.replace(typed, "")


def test_nothing_is_written_where_nothing_can_be_read(file, tmp_path):
    assert ended("look", file, "--response", "y", "--page", "look.html") == 2
    assert ended("look", "absent.csv", "--page", "look.html") == 2
    assert ended("look", file, "--page", file) == 2
    assert [path.name for path in tmp_path.iterdir()] == [file]


def test_whatever_is_a_recording_can_be_looked_at(file):
    (recording,) = dashpot.read(X, fs=500.0)
    (entry,) = dashpot.look(recording)
    assert (entry["record"], entry["recordings"][0]["motion"]) == ("recording 1", "decay")
    assert command(unescape(dashpot.look(recording)._repr_html_())) == ["dashpot.identify(...{})"]
    (of_file,) = dashpot.read(f"{file}#a")
    assert command(unescape(dashpot.look(of_file)._repr_html_())) == ["dashpot.identify('runs.npz#a'{})"]
    looked = dashpot.look({"time_s": T, "x_m": X}, part=(1.0, 4.0))
    assert looked[0]["recordings"][0]["duration"] == pytest.approx(3.0)
    said = unescape(looked._repr_html_())
    assert command(said) == ["dashpot.identify(...{})"]
    assert 'data-whole="1:4"' in said
    with pytest.raises(BadInput, match="is no kind of recording"):
        dashpot.look(object())

"""Several files behind one --holdout are all held out; none of them becomes training."""

from __future__ import annotations

from pathlib import Path

import click
import pytest
from dashpot.commands import cli
from dashpot.commands.several_values import written_out

HOLDOUT = {"--holdout"}
MODEL = """format: dashpot-model/1
name: rig
mass: {value: 0.27, unit: kg}
omega0: {value: 79.6, unit: rad/s}
cubic: {value: 4.6e5, unit: 1/(m2.s2)}
preload: {value: 0.074, unit: m/s2}
viscous: {value: 5.0, unit: 1/s}
dry: {value: 0.015, unit: m/s2}
response: {quantity: displacement, unit: m}
"""


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("m a --holdout h -o D", "m a --holdout h -o D"),
        ("m a --holdout h i j -o D", "m a --holdout h --holdout i --holdout j -o D"),
        ("m a --holdout h i --holdout j", "m a --holdout h --holdout i --holdout j"),
        ("--holdout h i -o D m a", "--holdout h --holdout i -o D m a"),
        ("--holdout h i -- m a", "--holdout h --holdout i -- m a"),
        ("m a -- --holdout b c", "m a -- --holdout b c"),
        ("m --holdout=h a b", "m --holdout=h a b"),
        ("m --holdout h --unit mm i", "m --holdout h --unit mm i"),
        ("m a --holdout h -", "m a --holdout h --holdout -"),
        ("m a b", "m a b"),
    ],
)
def test_an_option_takes_all_words_up_to_the_next_option(line, expected):
    assert written_out(line.split(), HOLDOUT) == expected.split()


@pytest.mark.parametrize(
    "line", ["m a --holdout", "m a --holdout -o D", "m a --holdout --holdout h", "m --holdout -- a"]
)
def test_an_option_without_a_value_is_told(line):
    with pytest.raises(click.BadOptionUsage, match="--holdout"):
        written_out(line.split(), HOLDOUT)


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """Runs ``dashpot diagnose`` up to the reading of the recordings: gives the names of training and held-out files."""
    monkeypatch.chdir(tmp_path)
    Path("model.yaml").write_text(MODEL)
    read: list[list[str]] = []

    def reading(files, options, say):
        read.append([str(file) for file in files])
        if len(read) == 2:
            raise click.exceptions.Exit(0)
        return []

    monkeypatch.setattr(cli, "read_all", reading)

    def run(line: str) -> list[list[str]]:
        read.clear()
        cli.main(["diagnose", *line.split()])
        return read

    return run


@pytest.mark.parametrize(
    "line",
    [
        "model.yaml a.csv b.csv --holdout c.csv d.csv -o out",
        "model.yaml a.csv b.csv -o out --holdout c.csv d.csv",
        "model.yaml a.csv b.csv --holdout c.csv --holdout d.csv -o out",
        "--holdout c.csv d.csv -o out model.yaml a.csv b.csv",
        "--holdout c.csv d.csv --unit mm model.yaml a.csv b.csv -o out",
        "-o out --holdout c.csv d.csv -- model.yaml a.csv b.csv",
        "model.yaml --holdout=c.csv a.csv b.csv --holdout=d.csv -o out",
    ],
)
def test_diagnose_holds_out_every_file_behind_it(asked, line):
    assert asked(line) == [["a.csv", "b.csv"], ["c.csv", "d.csv"]]


def test_training_that_was_named_behind_it_is_missed_and_not_held_out_in_silence(asked, capsys):
    with pytest.raises(SystemExit) as ended:
        asked("model.yaml --holdout c.csv a.csv b.csv -o out")
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert "RECORDINGS" in said
    assert "--holdout takes all files up to the next option; name the others before it" in said


def test_where_it_was_not_given_it_is_not_blamed(asked, capsys):
    with pytest.raises(SystemExit):
        asked("model.yaml")
    said = capsys.readouterr().err
    assert "Missing argument 'RECORDINGS...'" in said
    assert "takes all files" not in said


def test_the_help_says_so(capsys):
    cli.main(["diagnose", "--help"])
    words = " ".join(capsys.readouterr().out.split())
    assert "--holdout REC... Recordings to judge by" in words
    assert "all up to the next option; may be given several times" in words

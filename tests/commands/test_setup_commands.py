"""doctor, completion, --quiet, --verbose, the examples of the commands' help, colours."""

from __future__ import annotations

import json
import logging
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import dashpot
import numpy as np
import pytest
from dashpot.commands.cli import cli, main
from dashpot.commands.command_examples import EXAMPLES
from dashpot.commands.command_groups import GROUPS
from dashpot.commands.terminal import coloured, print_json
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face import doctor
from dashpot.model.laws import LIBRARY


def run(capsys, *arguments):
    code = 0
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as ended:
        code = ended.code or 0
    return code, *capsys.readouterr()


# doctor ---------------------------------------------------------------------------------------------------------------


def test_the_doctor_finds_what_is_there(capsys):
    code, out, _ = run(capsys, "doctor", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["good"] is True
    findings = {finding["what"]: finding for finding in found["findings"]}
    assert {"Python", "numpy", "C compiler", "FMUs for", "cache", "size", "hdf5"} <= set(findings)
    assert re.match(r"\d{3} MB \(casadi \d+, scipy \d+, ", findings["size"]["words"])
    assert findings["numpy"]["needed"]
    assert not findings["hdf5"]["needed"]
    code, out, _ = run(capsys, "doctor")
    assert out.splitlines()[-1] == "all that is needed is there"
    assert "\x1b" not in out


def test_every_command_stands_under_a_heading_of_the_help(capsys):
    _, out, _ = run(capsys, "-h")
    grouped = [name for names in GROUPS.values() for name in names]
    assert set(cli.commands) <= set(grouped)
    assert len(grouped) == len(set(grouped))
    shown = re.findall(r"^  ([\w-]+)  ", out.partition("Begin:")[2], re.MULTILINE)
    assert shown == [name for name in grouped if name in cli.commands]


def test_readers_that_are_installed_are_named(monkeypatch):
    def broken():
        raise BadInput("wavy: cannot be imported\nin two lines")

    readers = [(".wvy", "wavy (a)", lambda: print), (".csv", "wavy (b)", lambda: print), (".odd", "wavy (c)", broken)]
    monkeypatch.setattr("dashpot.recording.formats.installed.installed_readers", lambda: iter(readers))
    found = [(finding.what, finding.good, finding.words) for finding in doctor._readers()]
    assert found == [
        ("wavy (a)", True, "reads .wvy"),
        ("wavy (b)", False, "is not asked: dashpot reads .csv itself"),
        ("wavy (c)", False, "wavy: cannot be imported"),
    ]


def test_without_a_compiler_the_exit_code_says_so(capsys, no_compiler):
    code, out, _ = run(capsys, "doctor")
    assert code == 1
    assert "✗ C compiler" in out
    assert "apt-get install gcc" in out
    assert out.splitlines()[-1] == "not in order: C compiler"


def test_a_package_that_is_missing_or_old_is_told(monkeypatch):
    versions = {"numpy": "1.20.1", "scipy": "1.18.0"}

    def version(name):
        if name in versions:
            return versions[name]
        raise doctor.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(doctor.metadata, "version", version)
    assert doctor._found("numpy", ">=1.26") == (False, "1.20.1, and 1.26 or newer is needed")
    assert doctor._found("scipy", "!=1.18.0,>=1.12")[1].startswith("1.18.0, which does not work")
    assert doctor._found("absent", ">=1") == (False, "not installed")
    found = {finding.what: finding for finding in doctor._packages()}
    assert not found["numpy"].good
    assert found["numpy"].needed


def test_a_cache_that_cannot_be_written_is_told(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path / "file"))
    found = doctor._cache()
    assert not found.good
    assert "set DASHPOT_CACHE" in found.words


def test_colours_are_left_out_where_nobody_wants_them(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert coloured("x", "red").startswith("\x1b[31m")
    monkeypatch.setenv("NO_COLOR", "1")
    assert coloured("x", "red") == "x"


# completion -----------------------------------------------------------------------------------------------------------


def completed(words, last):
    """What bash would be told of a line whose last word is begun so."""
    told = {"COMP_WORDS": " ".join(["dashpot", *words, last]), "COMP_CWORD": str(len(words) + 1)}
    environment = {**os.environ, **told, "_DASHPOT_COMPLETE": "bash_complete"}
    line = [sys.executable, "-P", "-m", "dashpot"]
    said = subprocess.run(line, env=environment, capture_output=True, text=True, check=False).stdout
    return {line.partition(",")[2] for line in said.splitlines()}


def test_commands_options_and_laws_are_completed():
    assert completed([], "li") == {"linearise"}
    assert {"--fault", "--fix", "--force"} & completed(["identify"], "--f") >= {"--fix", "--force"}
    assert completed(["identify", "--with"], "qu") == {name for name in LIBRARY if name.startswith("qu")}


@pytest.mark.parametrize(
    ("shell", "word"), [("bash", "complete -o"), ("zsh", "#compdef dashpot"), ("fish", "complete")]
)
def test_what_a_shell_reads_is_printed(capsys, shell, word):
    code, out, _ = run(capsys, "completion", shell)
    assert code == 0
    assert word in out
    assert "_DASHPOT_COMPLETE" in out


# help -----------------------------------------------------------------------------------------------------------------


def test_every_command_has_an_example_in_its_help(capsys):
    assert set(EXAMPLES) >= set(cli.commands)
    for name in cli.commands:
        code, out, _ = run(capsys, name, "--help")
        assert code == 0
        assert EXAMPLES[name][0] in out


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_the_examples_are_of_their_command_and_its_options(name):
    for text in EXAMPLES[name]:
        words = shlex.split(re.sub(r'^eval "\$\((.*)\)"$', r"\1", text).partition(" > ")[0].partition(" | ")[0])
        assert words[:2] == ["dashpot", name]
        known = {option for parameter in cli.commands[name].params for option in parameter.opts}
        assert {word for word in words if word.startswith("-")} <= known


def test_a_mistyped_command_and_option_have_a_close_match(capsys):
    code, _, err = run(capsys, "identfy", "x.csv")
    assert code == 2
    assert "identify" in err
    code, _, err = run(capsys, "identify", "x.csv", "--ouput", "rig.yaml")
    assert code == 2
    assert "--output" in err


# quiet ----------------------------------------------------------------------------------------------------------------


def decaying(tmp_path, recorded) -> Path:
    """A decay of two seconds in a file."""
    decay = recorded(begin=(8e-3, 0.0), seconds=2.0)
    columns = np.column_stack([decay.time, decay.response])
    np.savetxt(tmp_path / "decay.csv", columns, delimiter=",", header="time_s,x_m", comments="")
    return tmp_path / "decay.csv"


def test_quiet_says_the_result_alone(capsys, tmp_path, recorded):
    model, recording = tmp_path / "rig.yaml", decaying(tmp_path, recorded)
    dashpot.Model.from_values(TRUTH, name="rig").save(model)
    words = ("simulate", model, recording, "-o", tmp_path / "out.csv")
    assert run(capsys, *words, "--quiet") == (0, "", "")
    assert "written" in run(capsys, *words)[2]
    assert run(capsys, "simulate", model, tmp_path / "absent.csv", "-o", tmp_path / "out.csv", "-q")[2] != ""


# verbose --------------------------------------------------------------------------------------------------------------


def test_verbose_says_on_stderr_what_is_tried(capsys, tmp_path, recorded):
    words = ("identify", decaying(tmp_path, recorded), "-o", tmp_path / "rig.yaml", "--json")
    code, out, err = run(capsys, *words, "-v")
    assert code == 0
    assert "simulated: " in err
    assert json.loads(out)["name"] == "rig"
    assert "simulated: " not in run(capsys, *words)[2]  # said by the one command that asked for it
    assert logging.getLogger("dashpot").level == logging.NOTSET


def test_whatever_is_logged_is_a_line_of_stderr(capsys, monkeypatch):
    def checkup():
        logging.getLogger("dashpot.face.doctor").info("two\nlines of %d", 3)
        logging.getLogger("dashpot.face.doctor").debug("no fact")
        raise BadInput("nothing there")

    monkeypatch.setattr("dashpot.face.doctor.checkup", checkup)
    assert run(capsys, "doctor", "--verbose")[2].splitlines()[0] == "two lines of 3"
    assert "two lines" not in run(capsys, "doctor")[2]


@pytest.mark.parametrize("name", sorted(cli.commands))
def test_every_command_is_quiet_or_verbose_and_not_both(capsys, name):
    for words in (("-q", "-v"), ("--verbose", "--quiet")):
        code, _, err = run(capsys, name, *words)
        assert code == 2
        assert "--quiet and --verbose exclude each other" in err


def test_a_result_for_a_stream_that_the_caller_closed_is_no_fault(monkeypatch):
    monkeypatch.setattr("sys.stdout", None)  # as of `dashpot ... --json >&-`
    print_json({"mass": 1.0})

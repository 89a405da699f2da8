"""Each fault ends in one of the ends that a command has: never in a traceback."""

from __future__ import annotations

import errno
import io
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from dashpot.commands import cli
from dashpot.errors import BadInput, ToolchainMissing
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator
from dashpot.model.file import save


@pytest.fixture
def rig(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DASHPOT_TRACEBACK", raising=False)
    save(Oscillator.from_values(TRUTH, name="ω₀ → π"), tmp_path / "rig.yaml")
    return "rig.yaml"


@pytest.fixture(autouse=True)
def interruptible():
    """What nohup or a background job ignores is heard for a while."""
    kept = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, kept)


def raiser(problem):
    def load(*_, **__):
        raise problem

    return load


OURS = (
    r"dashpot: this is a fault of dashpot and not of your input \({}; \S+\.py, line \d+\); please write to those who "
    r"make dashpot, with the command, its files and what DASHPOT_TRACEBACK=1 before it shows\n"
)
#: What happens, the exit code, and all that is said.
ENDS = [
    (BadInput("a.csv: is odd; mend it"), 2, r"dashpot: a\.csv: is odd; mend it\n"),
    (ToolchainMissing("no compiler"), 2, r"dashpot: no compiler\n"),
    (MemoryError(), 2, r"dashpot: there is not enough memory for this; use a part of the recordings .*\n"),
    (
        OSError(errno.ENOSPC, "No space left on device", "x"),
        2,
        r"dashpot: x: No space left on device; check the room.*\n",
    ),
    (PermissionError(errno.EACCES, "Permission denied"), 2, r"dashpot: the system: Permission denied; check .*\n"),
    (RuntimeError("std::bad_alloc"), 2, r"dashpot: there is not enough memory for this; .*\n"),
    (BadInput("a\x1b[2J.csv: is odd"), 2, "dashpot: a\ufffd\\[2J\\.csv: is odd\n"),
    (TypeError("a\nb"), 2, OURS.format("TypeError: a b")),
    (ZeroDivisionError(), 2, OURS.format("ZeroDivisionError")),
    (RecursionError("too deep"), 2, OURS.format("RecursionError: too deep")),
    (OSError("no number"), 2, OURS.format("OSError: no number")),
    (KeyboardInterrupt(), 130, r"\s*"),
    (BrokenPipeError(), 0, ""),
    (SystemExit(1), 1, ""),
]


@pytest.mark.parametrize(("problem", "code", "says"), ENDS, ids=[repr(end[0])[:40] for end in ENDS])
def test_every_problem_has_an_end(rig, capfd, monkeypatch, problem, code, says):
    monkeypatch.setattr("dashpot.model.file.load", raiser(problem))
    with pytest.raises(SystemExit) as stop:
        cli.main(["show", rig])
    out, err = capfd.readouterr()
    assert (stop.value.code, out) == (code, "")
    assert re.fullmatch(says, err), err


def test_a_developer_sees_the_traceback(rig, capsys, monkeypatch):
    monkeypatch.setenv("DASHPOT_TRACEBACK", "1")
    monkeypatch.setattr("dashpot.model.file.load", raiser(TypeError("odd")))
    with pytest.raises(SystemExit):
        cli.main(["show", rig])
    assert "Traceback (most recent call last)" in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="of POSIX")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_is_an_interruption(rig, capsys, monkeypatch, number):
    monkeypatch.setattr("dashpot.model.file.load", lambda path: os.kill(os.getpid(), number))
    kept = signal.signal(number, signal.default_int_handler)  # what nohup or a background job ignores stays ignored
    try:
        with pytest.raises(SystemExit) as stop:
            cli.main(["show", rig])
        assert signal.getsignal(number) == signal.default_int_handler
    finally:
        signal.signal(number, kept)
    assert stop.value.code == 130
    assert capsys.readouterr().out == ""


def test_an_interruption_that_nothing_lets_through_comes_again(rig, capsys, monkeypatch):
    class Dying:
        def __del__(self):
            os.kill(os.getpid(), signal.SIGINT)

    def load(_):
        Dying()  # what is raised in it Python only prints
        time.sleep(60)

    monkeypatch.setattr("dashpot.model.file.load", load)
    with pytest.raises(SystemExit) as stop:
        cli.main(["show", rig])
    assert stop.value.code == 130
    assert "ignored" not in capsys.readouterr().err


def test_an_interruption_that_a_library_makes_its_own_fault_is_one(rig, capsys, monkeypatch):
    def load(_):
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        except KeyboardInterrupt:
            raise RuntimeError("stopped") from None

    monkeypatch.setattr("dashpot.model.file.load", load)
    with pytest.raises(SystemExit) as stop:
        cli.main(["show", rig])
    assert (stop.value.code, capsys.readouterr().err) == (130, "")


@pytest.mark.parametrize("problem", [None, KeyboardInterrupt(), BadInput("odd")], ids=repr)
def test_what_is_made_for_a_while_goes_with_the_command(rig, tmp_path, monkeypatch, problem):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)
    seen = []

    def load(_):
        seen.append(Path(tempfile.mkdtemp()))
        (seen[0] / "file").write_text("x")
        assert seen[0].is_relative_to(os.environ["TMPDIR"])
        raise problem or SystemExit(0)

    monkeypatch.setattr("dashpot.model.file.load", load)
    with pytest.raises(SystemExit):
        cli.main(["show", rig])
    assert seen[0].is_relative_to(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == [rig]
    assert os.environ["TMPDIR"] == str(tmp_path)


EARLY = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
class Interrupted:
    def find_spec(self, name, *_):
        if name == "click":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupted())
from dashpot.__main__ import main
main()
"""


@pytest.mark.skipif(os.name != "posix", reason="of POSIX")
def test_an_interruption_while_commands_are_loaded_ends_without_a_word():
    run = subprocess.run([sys.executable, "-P", "-c", EARLY], capture_output=True, check=False)
    assert (run.returncode, run.stdout, run.stderr) == (-signal.SIGINT, b"", b"")


def device(place):
    Path(place).symlink_to("/dev/zero")


@pytest.mark.skipif(os.name != "posix", reason="of POSIX")
@pytest.mark.parametrize("options", [["show", "place"], ["show", "rig.yaml", "--law", "place"]], ids=["model", "law"])
@pytest.mark.parametrize("make", [os.mkfifo, device], ids=["pipe", "device"])
def test_what_may_never_end_is_not_read(rig, capsys, make, options):
    make("place")
    with pytest.raises(SystemExit) as stop:
        cli.main(options)
    assert stop.value.code == 2
    assert "place: cannot be read (a pipe or a device, which may never end); check" in capsys.readouterr().err


@pytest.mark.parametrize("encoding", ["latin-1", "ascii", "cp1252", "utf-8"])
@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_terminal_of_another_encoding_shows_what_it_can(rig, monkeypatch, encoding, options):
    out = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(out, encoding=encoding))
    cli.main(["show", rig, *options])
    text = out.getvalue().decode("utf-8" if encoding == "ascii" else encoding)  # which click takes for a mistake
    assert "omega0" in text
    if options:
        assert json.loads(text)["name"] == "ω₀ → π"  # nothing is lost: JSON has escapes


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
def test_an_output_that_takes_nothing_is_said(rig, capsys, monkeypatch):
    with Path("/dev/full").open("w") as full:
        monkeypatch.setattr(sys, "stdout", full)
        monkeypatch.setattr(os, "dup2", lambda *_: None)
        with pytest.raises(SystemExit) as stop:
            cli.main(["show", rig])
        assert stop.value.code == 2
        assert "No space left on device" in capsys.readouterr().err
        monkeypatch.undo()
        with pytest.raises(OSError, match="No space"):
            full.close()


SHELL = {  # what is typed, the exit code, and whether the file is there
    "nobody reads": ("{} show rig.yaml | head -0; exit ${{PIPESTATUS[0]}}", 0, False),
    "nobody can be told": ("{} export rig.yaml a.c 2> /dev/full", 0, True),
    "nothing is open": ("{} export rig.yaml a.c <&- >&- 2>&-", 0, True),
    "no place to stand": ("mkdir g && cd g && rmdir ../g && {} show rig.yaml", 2, False),
    "no room for a file": ("ulimit -f 0; {} export rig.yaml a.c", 2, False),
    "an unknown language": ("LC_ALL=xx LANG=yy.zz COLUMNS=-5 {} export rig.yaml a.c", 0, True),
    "a foreign numpy beside it": ("echo 'raise SystemExit(3)' > numpy.py; {} export rig.yaml a.c", 0, True),
    "warnings are errors": ("PYTHONWARNINGS=error PYTHONOPTIMIZE=2 {} export rig.yaml a.c", 0, True),
}


@pytest.mark.skipif(not Path("/dev/full").exists() or not Path("/bin/bash").exists(), reason="of Linux")
@pytest.mark.parametrize(("typed", "code", "made"), SHELL.values(), ids=SHELL)
def test_a_shell_of_any_kind_gets_one_of_the_ends(rig, tmp_path, typed, code, made):
    command = typed.format(f"{sys.executable} -P -m dashpot")
    run = subprocess.run(["/bin/bash", "-c", command], capture_output=True, text=True, check=False, timeout=60)
    assert run.returncode == code, run.stderr
    assert "Traceback" not in run.stderr
    assert (tmp_path / "a.c").exists() == made
    assert run.stderr.count("dashpot: ") == (code == 2)


@pytest.mark.long
def test_a_drawing_needs_no_window(rig, tmp_path):
    run = [sys.executable, "-P", "-m", "dashpot", "watch", "rig.yaml", "rig.yaml", "--report", "new.html"]
    environment = os.environ | {"MPLBACKEND": "nonsense"}
    done = subprocess.run(run, capture_output=True, text=True, check=False, env=environment)
    assert "fault of dashpot" not in done.stderr

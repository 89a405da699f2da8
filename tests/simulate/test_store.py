"""Faults of the store of compiled things and of the compiler: each is repaired, gone around, or said in a sentence."""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest
from dashpot.errors import BadInput, ToolchainMissing
from dashpot.model import Oscillator
from dashpot.simulate import store
from dashpot.simulate.cache import cache_folder
from dashpot.simulate.compiler import loaded_library, machine_compiler, shared_library
from dashpot.simulate.law_source import law_source

ANSWER = {"a.c": '__attribute__((visibility("default"))) int answer(void) { return 42; }\n'}
WRONG = {"a.c": '__attribute__((visibility("default"))) int answer(void) { return 43; }\n'}
PROGRAM = f"from dashpot.simulate.compiler import loaded_library; print(loaded_library({ANSWER!r}, 'a.c').answer())"


@pytest.fixture(autouse=True)
def own_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("DASHPOT_CACHE", str(tmp_path / "cache"))


def elsewhere(**environment):
    """What another process says, which has loaded nothing yet."""
    run = [sys.executable, "-P", "-c", PROGRAM]
    return subprocess.run(run, env=os.environ | environment, capture_output=True, text=True, check=False, timeout=60)


def flipped(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def replaced(path):
    path.unlink()
    shutil.copy(shared_library(WRONG, "a.c"), path)


def linked(path):
    other = shared_library(WRONG, "a.c")
    path.unlink()
    path.symlink_to(other)


DAMAGE = {
    "empty": lambda path: path.write_bytes(b""),
    "cut": lambda path: path.write_bytes(path.read_bytes()[:5000]),
    "one bit": flipped,
    "a folder": lambda path: (path.unlink(), path.mkdir()),
    "foreign": replaced,
    "a link to a foreign one": linked,
    "longer": lambda path: path.write_bytes(path.read_bytes() + b"\0"),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_what_is_damaged_is_made_again(damage):
    first = shared_library(ANSWER, "a.c")
    sound = first.read_bytes()
    damage(first)
    second = shared_library(ANSWER, "a.c")
    assert second.read_bytes() == sound  # checked before anything is loaded
    assert not second.is_symlink()
    assert ctypes.CDLL(str(second)).answer() == 42


def test_the_store_is_its_users_alone(tmp_path):
    (tmp_path / "cache" / "compiled").mkdir(parents=True, mode=0o777)
    library = shared_library(ANSWER, "a.c")
    assert stat.S_IMODE(library.parent.stat().st_mode) == 0o700
    assert stat.S_IMODE(library.stat().st_mode) == 0o600


def test_a_store_of_another_user_is_gone_around(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(os, "geteuid", lambda: 54321)
    library = shared_library(ANSWER, "a.c")
    assert tmp_path not in library.parents
    assert ctypes.CDLL(str(library)).answer() == 42
    assert "belongs to another user; what is compiled is not kept: set DASHPOT_CACHE" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["file", "null", "proc"])
def test_a_store_that_cannot_be_written_is_gone_around(tmp_path, kind):
    place = {"file": str(tmp_path / "file" / "in-it"), "null": "/dev/null/cache", "proc": "/proc/1/cache"}[kind]
    (tmp_path / "file").write_text("a file")
    run = elsewhere(DASHPOT_CACHE=place)
    assert run.stdout == "42\n"
    assert re.fullmatch(r"note: .*: (cannot be written|is no folder).*; what is compiled is not kept: .*\n", run.stderr)


def test_a_user_without_a_home_can_compile():
    run = elsewhere(DASHPOT_CACHE="", XDG_CACHE_HOME="", HOME="/proc/none")
    assert run.stdout == "42\n"
    assert run.stderr.startswith("note: ")


@pytest.mark.skipif(sys.platform == "win32", reason="of Unix")
@pytest.mark.parametrize(
    "environment", [{"HOME": "", "XDG_CACHE_HOME": ""}, {"HOME": "here", "XDG_CACHE_HOME": "here"}]
)
def test_a_home_that_is_empty_or_relative_is_none(monkeypatch, environment):
    """Else the root of the disk, or whatever folder a command is started in, would be a cache."""
    import pwd

    monkeypatch.delenv("DASHPOT_CACHE", raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert cache_folder() == Path(pwd.getpwuid(os.getuid()).pw_dir) / ".cache" / "dashpot"
    monkeypatch.setattr(pwd, "getpwuid", lambda _uid: {}["nobody"])  # a user who is in no list, as in a container
    assert cache_folder() == Path("/nonexistent/dashpot")


def test_two_processes_may_make_the_same_at_once(tmp_path):
    run = [sys.executable, "-P", "-c", PROGRAM]
    several = [subprocess.Popen(run, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    assert [process.communicate(timeout=60)[0] for process in several] == ["42\n"] * 3
    assert not list((tmp_path / "cache" / "compiled").glob("build-*"))


def test_what_was_not_used_for_long_goes(monkeypatch):
    old, recent = shared_library(ANSWER, "a.c"), shared_library(WRONG, "a.c")
    left = old.parent / "build-left"
    left.mkdir()
    (old.parent / "a-file-of-somebody").write_text("")
    for path, days in ((old, store.KEPT_DAYS + 1), (recent, store.KEPT_DAYS - 1), (left, 2)):
        os.utime(path, (time.time() - 86400 * days,) * 2)
    monkeypatch.setattr(store, "MOST_BYTES", 10**9)
    third = shared_library({"a.c": "int third;"}, "a.c")
    assert {path.name for path in third.parent.iterdir()} == {recent.name, third.name, "a-file-of-somebody"}
    monkeypatch.setattr(store, "MOST_BYTES", 0)
    fourth = shared_library({"a.c": "int fourth;"}, "a.c")
    assert {path.name for path in third.parent.iterdir()} == {fourth.name, "a-file-of-somebody"}


def test_use_counts():
    library = shared_library(ANSWER, "a.c")
    os.utime(library, (time.time() - 86400 * 80,) * 2)
    shared_library(ANSWER, "a.c")
    assert time.time() - library.stat().st_mtime < 60


_MADE = 'while [ $# -gt 1 ]; do [ "$1" = -o ] && made=$2; shift; done'
COMPILERS = {
    "does nothing": ("exit 0", "says that all went well and made nothing"),
    "makes a text": (f"{_MADE}; echo text > $made", "no whole shared library"),
    "makes a piece": (f'cc "$@"; {_MADE}; head -c 9000 $made > piece; mv piece $made', "no whole shared library"),
    "fails in silence": ("exit 3", "it ended with code 3 and said nothing"),
    "crashes": ("kill -SEGV $$", "it ended with code -11"),
    "hangs": ("sleep 60 & sleep 60", "did not end within 0.3 s"),
    "waits for input": ("cat; exit 1", "it ended with code 1"),
    "floods": ("yes | head -c 3000000; exit 1", "y y y"),
    "is no program": (None, "cannot be started"),
}


@pytest.mark.skipif(os.name != "posix", reason="the compilers here are shell scripts")
@pytest.mark.parametrize(("script", "says"), COMPILERS.values(), ids=COMPILERS)
def test_a_compiler_that_does_not(monkeypatch, tmp_path, script, says):
    compiler = tmp_path / "compiler"
    compiler.write_text("\0no program" if script is None else f"#!/bin/sh\n{script}\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    monkeypatch.setenv("DASHPOT_COMPILER_SECONDS", "0.3" if "hangs" in says or "0.3" in says else "20")
    began = time.monotonic()
    with pytest.raises(ToolchainMissing, match=r"the C compiler .* failed: ") as raised:
        shared_library(ANSWER, "a.c")
    assert says in str(raised.value)
    assert "\n" not in str(raised.value)
    assert time.monotonic() - began < 20
    assert list((tmp_path / "cache" / "compiled").iterdir()) == []


def test_a_time_limit_that_is_no_number_is_said(monkeypatch):
    monkeypatch.setenv("DASHPOT_COMPILER_SECONDS", "soon")
    with pytest.raises(BadInput, match="DASHPOT_COMPILER_SECONDS is 'soon'; set it to a positive number"):
        shared_library(ANSWER, "a.c")


def test_what_does_not_load_is_said():
    if machine_compiler() is None:
        pytest.skip("no compiler")
    with pytest.raises(ToolchainMissing, match=r"what was compiled does not load .*set DASHPOT_CACHE"):
        loaded_library(
            {"a.c": "int missing(void); int answer(void) { return missing(); } int (*p)(void) = missing;"}, "a.c"
        )


def test_c_that_was_cut_short_is_never_compiled(monkeypatch):
    """CasADi reports nothing where the temporary folder is full."""
    from dashpot.examples.truth import TRUTH
    from dashpot.model.equations import equations

    eq = equations(Oscillator.from_values(TRUTH))
    whole = Path.read_text
    for read in (
        lambda path, **_: whole(path, **_)[:4096],
        lambda path, **_: whole(path, **_)[:-1],
        lambda path, **_: "",
    ):
        monkeypatch.setattr(Path, "read_text", read)
        with pytest.raises(BadInput, match="does not take the C code of the model; make room there"):
            law_source(eq)

"""Names of platforms, which folder is for which, and what this machine is called."""

from __future__ import annotations

import platform as machine
import sys

import pytest
from dashpot.errors import BadInput
from dashpot.export.platforms import PLATFORMS, folders, library_for_here, own_platform, parse_platforms

BY_NAME = {p.name: p for p in PLATFORMS}


def named(text):
    return [p.name for p in parse_platforms(text)]


def test_names_tuples_and_groups():
    assert named("all") == ["linux64", "linux-arm64", "win64", "darwin-x64", "darwin-arm64"]
    assert named(" win64, linux64 ,win64") == ["linux64", "win64"]  # in the order of the table, each once
    assert named("AARCH64-linux,x86_64-darwin") == ["linux-arm64", "darwin-x64"]
    assert named("darwin64") == ["darwin-x64", "darwin-arm64"]  # FMI 2's one folder is for both


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("win46", "unknown platform 'win46'; did you mean win64\\? Known are all, linux64, linux-arm64"),
        ("linux64,haiku", "unknown platform 'haiku'; known are all, linux64"),
        (" , ", "no platform is named"),
        ("", "no platform is named"),
    ],
)
def test_what_is_no_platform_is_refused_with_those_that_are(text, says):
    with pytest.raises(BadInput, match=says):
        parse_platforms(text)


@pytest.mark.parametrize(
    ("system", "processor", "word", "expected"),
    [
        ("Linux", "x86_64", 2**63 - 1, ("linux64", "linux64", "x86_64-linux", ".so")),
        ("Linux", "aarch64", 2**63 - 1, ("linux-arm64", "aarch64-linux", "aarch64-linux", ".so")),
        ("Windows", "AMD64", 2**63 - 1, ("win64", "win64", "x86_64-windows", ".dll")),
        ("Darwin", "x86_64", 2**63 - 1, ("darwin-x64", "darwin64", "x86_64-darwin", ".dylib")),
        ("Darwin", "arm64", 2**63 - 1, ("darwin-arm64", "darwin64", "aarch64-darwin", ".dylib")),
        # those that only their own compiler builds for
        ("Windows", "AMD64", 2**31 - 1, ("x86-windows", "win32", "x86-windows", ".dll")),
        ("Windows", "ARM64", 2**63 - 1, ("aarch64-windows", "aarch64-windows", "aarch64-windows", ".dll")),
        ("Linux", "i686", 2**31 - 1, ("x86-linux", "linux32", "x86-linux", ".so")),
        ("Linux", "riscv64", 2**63 - 1, ("riscv64-linux", "riscv64-linux", "riscv64-linux", ".so")),
        ("FreeBSD", "amd64", 2**63 - 1, ("x86_64-freebsd", "x86_64-freebsd", "x86_64-freebsd", ".so")),
    ],
)
def test_every_machine_has_a_name(monkeypatch, system, processor, word, expected):
    monkeypatch.setattr(machine, "system", lambda: system)
    monkeypatch.setattr(machine, "machine", lambda: processor)
    monkeypatch.setattr(sys, "maxsize", word)
    own = own_platform()
    assert (own.name, own.fmi2, own.fmi3, own.suffix) == expected
    assert (own.target is not None) == (own in PLATFORMS)


def test_folders_of_both_standards():
    assert {name: folders(p, PLATFORMS, 2) for name, p in BY_NAME.items()} == {
        "linux64": ("linux64",),
        "linux-arm64": ("aarch64-linux",),
        "win64": ("win64",),
        "darwin-x64": ("darwin64",),
        "darwin-arm64": ("darwin64",),
    }
    assert {folders(p, PLATFORMS, 3) for p in PLATFORMS} == {(p.fmi3,) for p in PLATFORMS}
    arm = BY_NAME["linux-arm64"]
    assert folders(arm, [arm, BY_NAME["win64"]], 2) == (
        "aarch64-linux",
        "linux64",
    )  # where FMPy looks on such a machine
    assert folders(arm, [arm], 3) == ("aarch64-linux",)


def test_the_binary_for_this_machine_is_found_in_its_own_folder_first(tmp_path, monkeypatch):
    monkeypatch.setattr("dashpot.export.platforms.own_platform", lambda: BY_NAME["linux-arm64"])
    assert library_for_here(tmp_path, "rig") is None
    for folder in ("linux64", "aarch64-linux"):  # the first is x86-64's
        (tmp_path / "binaries" / folder).mkdir(parents=True)
        (tmp_path / "binaries" / folder / "rig.so").touch()
    assert library_for_here(tmp_path, "rig") == tmp_path / "binaries/aarch64-linux/rig.so"
    assert library_for_here(tmp_path, "other") is None

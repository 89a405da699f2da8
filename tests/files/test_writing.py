"""Faults in writing: the files of one command appear together or not at all, and what was there before stays."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from dashpot.commands import cli
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.files import writing
from dashpot.files.writing import remove, together, writable, write
from dashpot.model import Oscillator
from dashpot.model.file import save

POSIX = pytest.mark.skipif(os.name != "posix", reason="of POSIX")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save(Oscillator.from_values(TRUTH, name="rig"), tmp_path / "rig.yaml")
    return tmp_path


def contents(folder):
    return {p.relative_to(folder).as_posix(): p.read_bytes() if p.is_file() else None for p in folder.rglob("*")}


def refused(capsys, folder, *arguments):
    """The one sentence; everything is as it was."""
    before = contents(folder)
    with pytest.raises(SystemExit) as stop:
        cli.main(list(arguments))
    out, err = capsys.readouterr()
    assert (stop.value.code, out) == (2, ""), err
    (line,) = [line for line in err.splitlines() if not line.startswith(("note: ", "the FMU runs on "))]
    assert line.startswith("dashpot: ")
    assert contents(folder) == before
    return line


def test_all_or_nothing(here):
    write(here / "a", "old")
    with pytest.raises(KeyError), together():  # noqa: PT012
        write(here / "a", "new")
        write(here / "new" / "deep" / "b", "new")
        remove(here / "rig.yaml")
        raise KeyError
    assert contents(here).keys() == {"a", "rig.yaml"}
    assert (here / "a").read_text() == "old"
    with together():
        write(here / "a", "new")
        write(here / "new" / "deep" / "b", "new")
        remove(here / "rig.yaml")
        assert (here / "a").read_text() == "old"
    assert contents(here) == {"a": b"new", "new": None, "new/deep": None, "new/deep/b": b"new"}


@pytest.mark.parametrize("broken", range(4))
@pytest.mark.parametrize("problem", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_a_fault_among_the_last_renames_puts_all_back(here, monkeypatch, broken, problem):
    for name in "abcd":
        write(here / name, f"old {name}")
    (here / "c").unlink()
    before, plain, count = contents(here), Path.replace, 0

    def replace(path, target):
        nonlocal count
        if Path(target).name in "abcd" and path.name.startswith(f".{Path(target).name}-"):
            count += 1
            if count == broken + 1:
                raise problem
        return plain(path, target)

    def all_four():
        with together():
            for name in "abcd":
                write(here / name, f"new {name}")

    monkeypatch.setattr(Path, "replace", replace)
    with pytest.raises(KeyboardInterrupt if isinstance(problem, KeyboardInterrupt) else BadInput):
        all_four()
    assert contents(here) == before


@pytest.mark.parametrize("fault", ["open", "write", "read back"])
def test_a_full_disk_leaves_the_former_file(here, monkeypatch, fault):
    write(here / "a", "old")
    full = OSError(errno.ENOSPC, "No space left on device")
    if fault == "read back":
        monkeypatch.setattr(Path, "read_bytes", lambda path: b"ol")
    else:

        class Full:
            def __enter__(self):
                return self

            def __exit__(self, *_):
                pass

            def write(self, data):
                raise full

        def open_(path, *_, **__):
            if fault == "open":
                raise full
            return Full()

        monkeypatch.setattr(Path, "open", open_)
    with pytest.raises(BadInput, match=r"a: .*(No space left on device|does not read back)"):
        write(here / "a", "new")
    monkeypatch.undo()
    assert contents(here).keys() == {"a", "rig.yaml"}
    assert (here / "a").read_text() == "old"


FULL = """
import resource, signal, sys
from dashpot.commands import cli
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
import dashpot.files.writing as writing
plain = writing.fill
def limited(*arguments):
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), resource.RLIM_INFINITY))
    try:
        plain(*arguments)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
writing.fill = limited
cli.main(sys.argv[2:])
"""


@POSIX
@pytest.mark.parametrize(
    "command",
    [
        "export rig.yaml a.casadi",
        pytest.param("export rig.yaml a.c a.ssp a.fmu --platform linux64", marks=pytest.mark.long),
    ],
)
def test_a_disk_that_is_really_full(here, command):
    """A file size limit stands in for it: the kernel then cuts the writing short in the same way."""
    write(here / "a.casadi", "old")
    before = contents(here)
    run = subprocess.run(
        [sys.executable, "-P", "-c", FULL, "4096", *command.split()], capture_output=True, text=True, check=False
    )
    assert run.returncode == 2, run.stderr
    assert "cannot be written (File too large); choose another place" in run.stderr
    assert "Traceback" not in run.stderr
    assert contents(here) == before


@POSIX
def test_umask_permissions_and_links_are_kept(here):
    before = os.umask(0o027)
    try:
        write(here / "a", "a")
    finally:
        os.umask(before)
    assert stat.S_IMODE((here / "a").stat().st_mode) == 0o640
    (here / "a").chmod(0o604)
    (here / "folder").mkdir()
    (here / "folder" / "link").symlink_to("../a")
    (here / "dangling").symlink_to("folder/new")
    write(here / "folder" / "link", "through the link")
    write(here / "dangling", "new")
    assert (here / "a").read_text() == "through the link"
    assert stat.S_IMODE((here / "a").stat().st_mode) == 0o604
    assert (here / "folder" / "link").is_symlink()
    assert (here / "folder" / "new").read_text() == "new"


def pipe(here):
    os.mkfifo(here / "place")


def device(here):
    (here / "place").symlink_to("/dev/null")


def circle(here):
    (here / "place").symlink_to("place")


def terminal(here):
    (here / "place").symlink_to("/dev/stdout")


@POSIX
@pytest.mark.parametrize(
    ("make", "says"),
    [
        (pipe, "a device or a pipe"),
        (device, "a device or a pipe"),
        (circle, "is a link that leads to itself"),
        (Path.mkdir, "is a folder"),
    ],
)
def test_only_regular_files_are_replaced(here, make, says):
    make(here / "place") if make is Path.mkdir else make(here)
    for action in (writable, lambda place: write(place, "x")):
        with pytest.raises(BadInput, match=says):
            action(here / "place")
    assert contents(here).keys() == {"rig.yaml", "place"}


#: What lies there before, what is asked, and what is said.
OVERWRITING = [
    ({}, "export rig.yaml a.fmu a.c a.casadi a.ssp --fmi 3", "SSP 1.0 is for FMUs of FMI 2"),
    ({"a.h": "int theirs;"}, "export rig.yaml a.casadi a.c", "a.h: is there and was not made by dashpot; move it away"),
    ({"main.c": "int main(void) {}"}, "export rig.yaml main.c", "main.c: is there and was not made by dashpot"),
    ({"rig.h": None}, "export rig.h rig.c", "rig.h: is "),
    ({"x.casadi.json": None}, "export x.casadi.json x.casadi", "x.casadi.json: is "),
    ({"x.casadi.json": "{}"}, "export rig.yaml x.casadi", "x.casadi.json: is there and was not made by dashpot"),
    ({"x.step.casadi": "theirs"}, "export rig.yaml x.casadi", "x.step.casadi: is there and was not made by"),
    ({}, "export rig.yaml x.casadi x.step.casadi", "x.step.casadi: is to be written twice"),
    ({"d/model.fmu": "theirs"}, "diagnose rig.yaml r.csv -o d", "model.fmu: is there and was not made by a diagnosis"),
    ({"d/diagnosis.json": "{}"}, "diagnose rig.yaml r.csv -o d", "diagnosis.json: is there and was not made by a di"),
    ({"d/report.html": "theirs"}, "diagnose rig.yaml r.csv -o d", "report.html: is there and was not made by a di"),
    (
        {"d/diagnosis.json": '{"format": "dashpot-diagnosis/1"}', "d/model.fmu": "theirs"},
        "diagnose rig.yaml r.csv -o d",
        "model.fmu: is there and was not made by a diagnosis",
    ),
    ({"d/model.yaml": "name: theirs"}, "demo -o d", "model.yaml: is there and was not made by a demo"),
    ({"start.yaml": None}, "identify r.csv --from start.yaml -o start.yaml", "start.yaml: is an input"),
    ({}, "export rig.yaml /dev/null.c /dev/null", "cannot tell what to make"),
    ({"p.c": os.mkfifo}, "export rig.yaml p.c", "p.c: is a device or a pipe, which cannot be replaced"),
    ({"p.h": os.mkfifo}, "export rig.yaml p.c", "p.h: is a device or a pipe, which cannot be replaced"),
    ({"p.fmu": os.mkfifo}, "export rig.yaml p.fmu", "p.fmu: is a device or a pipe, which cannot be replaced"),
]  # fmt: skip


@POSIX
@pytest.mark.parametrize(
    ("there", "command", "says"), OVERWRITING, ids=[f"{row[1]} {[*row[0]]}" for row in OVERWRITING]
)
def test_what_was_there_stays(here, capsys, monkeypatch, there, command, says):
    for name, content in there.items():
        (here / name).parent.mkdir(exist_ok=True)
        if callable(content):
            content(here / name)
        else:
            text = (here / "rig.yaml").read_text() if content is None else content
            (here / name).write_text(text)
    assert says in refused(capsys, here, *command.split())


def test_what_we_made_is_made_again(here, capsys):
    for _ in range(2):
        cli.main(["export", "rig.yaml", "x.casadi", "x.c"])
    said = capsys.readouterr().err.splitlines()
    assert sum(line.startswith("written: ") for line in said) == 2 * 10


def test_a_second_name_is_a_copy_where_the_disk_knows_no_links(here, monkeypatch):
    def no_link(*_):
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", no_link)
    write(here / "a", "old")
    write(here / "a", "new")
    assert contents(here).keys() == {"a", "rig.yaml"}
    assert writing._pending.get() is None

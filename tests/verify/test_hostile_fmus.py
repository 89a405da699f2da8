"""FMUs that do what none should: each ends in one sentence, and nothing of it reaches this process or its folder."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands import cli
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.export.fmu import export_fmu
from dashpot.model import Oscillator
from dashpot.simulate.compiler import find_compiler
from dashpot.simulate.force import straight_lines
from dashpot.verify import unpack as limits
from dashpot.verify.fmu_run import FmuRun
from dashpot.verify.unpack import unpack

HERE = Path(__file__).parent
N, DT = 60, 2e-3
pytestmark = pytest.mark.skipif(os.name != "posix" or find_compiler() is None, reason="the faults are POSIX's")


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return export_fmu(Oscillator.from_values(TRUTH, name="rig"), tmp_path_factory.mktemp("sound") / "rig.fmu")


@pytest.fixture(scope="module")
def hostile(sound, tmp_path_factory):
    """The FMU of hostile.c: a description of ours, and that binary."""
    return with_binary(sound, HERE / "hostile.c", tmp_path_factory.mktemp("hostile"))


@pytest.fixture(scope="module")
def hostile3(tmp_path_factory):
    """That of hostile3.c, of FMI 3."""
    folder = tmp_path_factory.mktemp("hostile3")
    plain = export_fmu(Oscillator.from_values(TRUTH, name="rig"), folder / "rig.fmu", version=3)
    return with_binary(plain, HERE / "hostile3.c", folder)


def with_binary(fmu, source, folder):
    compiler = find_compiler()
    assert compiler is not None
    subprocess.run(
        [compiler, "-shared", "-fPIC", "-O1", str(source), "-o", "hostile.so", "-lm"], cwd=folder, check=True
    )
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(folder / "hostile.fmu", "w") as target:
        for name in source.namelist():
            binary = name.startswith("binaries/")
            target.writestr(name, (folder / "hostile.so").read_bytes() if binary else source.read(name))
    return folder / "hostile.fmu"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The working folder, and one for temporary files."""
    (tmp_path / "work").mkdir()
    (tmp_path / "temporary").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    return tmp_path


def run_twice(fmu, limit=30.0):
    force = straight_lines(np.sin(np.arange(N) * DT), DT)
    with FmuRun(fmu, limit=limit) as run:
        run.record(force, N, DT)
        return run.record(force, N, DT, np.array([1e-3, 0.0])), run.heard()


#: What the FMU does and where; what is then said, and whether each `make test` tries it.
FAULTS = [
    ("exit", "fmi2DoStep", r"the FMU ended the process that it runs in \(exit code 0\) while it ran", True),
    ("exit", "fmi2Instantiate", r"\(exit code 0\) while it was loaded", False),
    ("exit7", "fmi2GetReal", r"\(exit code 7\) while it ran", False),
    ("crash", "fmi2DoStep", r"the FMU crashed \(SIGSEGV\) while it ran; such an FMU cannot be used", True),
    ("crash", "fmi2Instantiate", r"crashed \(SIGSEGV\) while it was loaded", False),
    ("crash", "fmi2Terminate", r"crashed \(SIGSEGV\) while it ran", False),
    ("abort", "fmi2SetReal", r"crashed \(SIGABRT\) while it ran", False),
    (
        "loop",
        "fmi2DoStep",
        r"did not get on for \S+ s while it ran; mend it, or give it more time with --time-limit",
        True,
    ),
    ("loop", "fmi2Instantiate", r"did not get on for \S+ s while it was loaded", False),
    ("stop", "fmi2DoStep", r"did not get on for", False),
    ("error", "fmi2Instantiate", r"does not load on this machine", False),
    (
        "error",
        "fmi2SetupExperiment",
        r"stopped \(fmi2SetupExperiment failed with status 3 \(error\)\) while it ran",
        True,
    ),
    ("error", "fmi2EnterInitializationMode", r"stopped \(fmi2EnterInitializationMode failed", False),
    ("error", "fmi2ExitInitializationMode", r"stopped \(fmi2ExitInitializationMode failed", False),
    ("error", "fmi2SetReal", r"stopped \(fmi2SetReal failed", False),
    ("error", "fmi2SetRealInputDerivatives", r"stopped \(fmi2SetRealInputDerivatives failed", False),
    ("error", "fmi2GetReal", r"stopped \(fmi2GetReal failed", False),
    ("error", "fmi2DoStep", r"stopped \(fmi2DoStep failed", False),
    ("error", "fmi2Reset", r"stopped \(fmi2Reset failed", False),
    ("error", "fmi2Terminate", r"stopped \(fmi2Terminate failed", False),
    ("fatal", "fmi2DoStep", r"failed with status 4 \(fatal\)", False),
    ("discard", "fmi2DoStep", r"failed with status 2 \(discard\)", False),
    ("nonsense", "fmi2DoStep", r"failed with status 77", False),
    ("nan", "fmi2GetReal", r"gives nan at 0 s and says that all is well", False),
    ("close", "fmi2DoStep", r"cannot be used|did not get on", False),
    ("write", "fmi2DoStep", r"such an FMU cannot be used|did not get on", False),
]


def lane(fault):
    *given, always = fault
    return pytest.param(*given, marks=() if always else pytest.mark.long, id=f"{given[0]} in {given[1]}")


def write_sweep(n):
    t = np.arange(n) * DT
    x = 1e-3 * np.sin(80 * t) + 1e-7 * np.random.default_rng(0).standard_normal(t.size)
    table = np.column_stack([t, 0.1 * np.sin(80 * t), 1.1 * x])
    np.savetxt("sweep.csv", table, "%.9g", ",", header="time_s,force_N,x_m", comments="")


@pytest.mark.parametrize(("what", "at", "says"), [lane(fault) for fault in FAULTS])
def test_a_fault_in_the_binary_is_one_sentence(hostile, here, monkeypatch, what, at, says):
    is_one_sentence(hostile, here, monkeypatch, what, at, says)


#: The same of FMI 3, and what it alone has: an end or an early return that is called OK.
FAULTS3 = [
    ("terminate", "", r"stopped \(it asked for the end of the simulation at 0 s\) while it ran", True),
    ("early", "", r"stopped \(it stopped at 0\.00\d+ s in the step from 0 s over 0\.00\d+ s\)", False),
    ("short", "", r"stopped \(it stopped at 0\.00\d+ s in the step from 0\.00\d+ s over 0\.00\d+ s\)", False),
    ("exit", "fmi3DoStep", r"ended the process that it runs in \(exit code 0\) while it ran", False),
    ("exit", "fmi3InstantiateCoSimulation", r"\(exit code 0\) while it was loaded", False),
    ("crash", "fmi3DoStep", r"the FMU crashed \(SIGSEGV\) while it ran", False),
    ("crash", "fmi3EnterInitializationMode", r"crashed \(SIGSEGV\) while it ran", False),
    ("abort", "fmi3SetFloat64", r"crashed \(SIGABRT\) while it ran", False),
    ("loop", "fmi3DoStep", r"did not get on for \S+ s while it ran", False),
    ("stop", "fmi3Terminate", r"did not get on for", False),
    ("error", "fmi3InstantiateCoSimulation", r"does not load on this machine", False),
    ("error", "fmi3EnterInitializationMode", r"stopped \(fmi3EnterInitializationMode", False),
    ("error", "fmi3ExitInitializationMode", r"stopped \(fmi3ExitInitializationMode", False),
    ("error", "fmi3SetFloat64", r"stopped \(fmi3SetFloat64", False),
    ("error", "fmi3GetFloat64", r"stopped \(fmi3GetFloat64", False),
    ("error", "fmi3DoStep", r"stopped \(fmi3DoStep", False),
    ("error", "fmi3Reset", r"stopped \(fmi3Reset", False),
    ("error", "fmi3Terminate", r"stopped \(fmi3Terminate", False),
    ("discard", "fmi3DoStep", r"stopped \(fmi3DoStep", False),
    ("nonsense", "fmi3DoStep", r"stopped \(fmi3DoStep", False),
    ("nan", "fmi3GetFloat64", r"gives nan at 0 s and says that all is well", False),
]


@pytest.mark.parametrize(("what", "at", "says"), [lane(fault) for fault in FAULTS3])
def test_a_fault_in_a_binary_of_fmi_3_is_one_sentence(hostile3, here, monkeypatch, what, at, says):
    is_one_sentence(hostile3, here, monkeypatch, what, at, says)


def is_one_sentence(hostile, here, monkeypatch, what, at, says):
    monkeypatch.setenv("FAULT", what)
    monkeypatch.setenv("AT", at)
    limit = 1.0 if "get on" in says and what != "write" else 10.0
    began = time.monotonic()
    with pytest.raises(BadInput, match=says) as raised:
        run_twice(hostile, limit)
    assert "\n" not in str(raised.value)
    assert str(hostile) in str(raised.value)
    assert time.monotonic() - began < 60
    assert Path.cwd() == here / "work"
    assert not [path for path in here.rglob("*") if path.name not in ("work", "temporary")]  # nothing is left


#: What an FMU may do without harm, and where.
MISCHIEF = [
    ("chdir", "fmi2Instantiate", False),
    ("litter", "fmi2DoStep", False),
    ("flood", "fmi2SetupExperiment", True),
    ("talk", "fmi2SetupExperiment", False),
    ("child", "fmi2SetupExperiment", False),
    ("crash", "fmi2FreeInstance", False),
]


@pytest.mark.parametrize(("what", "at"), [lane(mischief) for mischief in MISCHIEF])
def test_mischief_stays_where_it_is(hostile, here, monkeypatch, capfd, what, at):
    monkeypatch.setenv("FAULT", what)
    monkeypatch.setenv("AT", at)
    response, heard = run_twice(hostile)
    assert response == pytest.approx(1e-3 * np.sin(80 * np.arange(N) * DT))
    assert len(heard) <= 1
    assert capfd.readouterr() == ("", "")
    assert Path.cwd() == here / "work"
    assert not [path for path in here.rglob("*") if path.name not in ("work", "temporary")]


def test_verify_passes_only_what_it_saw(hostile, here, monkeypatch, capsys):
    """A gate that runs `verify` must not be opened by the binary's own exit(0)."""
    write_sweep(2000)
    for what, code in (("exit", 2), ("none", 1)):
        monkeypatch.setenv("FAULT", what)
        monkeypatch.setenv("AT", "fmi2DoStep")
        with pytest.raises(SystemExit) as stop:
            cli.main(["verify", str(hostile), "sweep.csv", "--json", f"{what}.json"])
        out, err = capsys.readouterr()
        assert stop.value.code == code, err
        assert "Traceback" not in err
        assert (out == "") == (code == 2)
    assert not Path("exit.json").exists()
    assert json.loads(Path("none.json").read_text(), parse_constant=pytest.fail)["pass"] is False


@pytest.fixture
def detached(tmp_path, monkeypatch):
    """The number of the process that an FMU leaves in a session of its own; its file goes when it is over."""
    file = tmp_path / "temporary" / "detached"
    monkeypatch.setenv("DETACHED", str(file))
    monkeypatch.setenv("AT", "fmi2DoStep")

    def is_there():
        number = int(file.read_text())
        os.kill(number, 0)
        return number

    yield is_there
    os.kill(is_there(), signal.SIGKILL)


@pytest.mark.parametrize(
    ("what", "says"),
    [
        ("detach", None),
        ("detach-crash", r"crashed \(SIGSEGV\) while it ran"),
        ("detach-stop", r"did not get on for 1 s while it ran"),
    ],
)
def test_a_process_that_outlives_the_fmu_is_not_waited_for(hostile, here, detached, monkeypatch, what, says):
    monkeypatch.setenv("FAULT", what)
    threads = threading.active_count()
    if says is None:
        run_twice(hostile)
    else:
        with pytest.raises(BadInput, match=says):
            run_twice(hostile, 1.0)
    detached()
    for thread in threading.enumerate():
        if thread.name.startswith("fmu"):
            thread.join(10.0)
    assert threading.active_count() == threads  # none is left that reads


def hears_interrupts() -> None:
    """As a command at a terminal does; one of a job in the background ignores them, and so would this one."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def ended_by(command: subprocess.Popen[bytes], number: signal.Signals) -> None:
    """Send a signal, and wait for the end; a command that does not heed it is killed, and does not hang the tests."""
    command.send_signal(number)
    try:
        command.wait(30)
    finally:
        command.kill()


def test_what_is_found_is_written_before_the_fmu_is_ended(hostile, here, detached, monkeypatch):
    """Its last words may take for ever; a signal meanwhile ends the command."""
    write_sweep(400)
    monkeypatch.setenv("FAULT", "detach-farewell")
    line = [sys.executable, "-P", "-m", "dashpot", "verify", str(hostile), "sweep.csv", "--json", "out.json"]
    with subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as command:
        while not Path("out.json").exists():
            assert command.poll() is None, command.stderr.read()
            time.sleep(0.01)
        assert json.loads(Path("out.json").read_text())["pass"] in (True, False)
        ended_by(command, signal.SIGTERM)
    detached()
    assert command.returncode in (0, 1, 130)


def test_a_command_that_waits_for_an_fmu_hears_a_signal(hostile, here, detached, monkeypatch):
    write_sweep(400)
    monkeypatch.setenv("FAULT", "detach-stop")
    line = [sys.executable, "-P", "-m", "dashpot", "verify", str(hostile), "sweep.csv", "--time-limit", "600"]
    for number in (signal.SIGINT, signal.SIGTERM):
        Path(os.environ["DETACHED"]).unlink(missing_ok=True)
        with subprocess.Popen(
            line, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=hears_interrupts
        ) as command:
            while not Path(os.environ["DETACHED"]).exists() or not Path(os.environ["DETACHED"]).read_text():
                assert command.poll() is None
                time.sleep(0.01)
            ended_by(command, number)
        left = detached()
        assert command.returncode == 130
        if number == signal.SIGINT:
            os.kill(left, signal.SIGKILL)


def archive(path, entries):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in entries:
            target.writestr(name, content)
    return path


ARCHIVES = {
    "a path that leads out": ([("../evil.txt", b"")], r"holds a file named '\.\./evil\.txt', which no FMU may"),
    "an absolute path": ([("/tmp/evil.txt", b"")], "holds a file named '/tmp/evil"),
    "a drive": ([("C:/evil.txt", b"")], "holds a file named 'C:/evil"),
    "backslashes": ([("..\\evil.txt", b"")], "holds a file named "),
    "a name that does not print": ([("a\nb", b"")], "holds a file named "),
    "a long name": ([("a" * 2000, b"")], "holds a file named 'aaa"),
    "a name twice": ([("a/b", b""), ("a\\b", b"")], "holds a file named "),
    "a file where a folder is": ([("a", b""), ("a/b", b"")], "cannot be unpacked|not a readable FMU"),
    "many files": ([(f"f{i}", b"") for i in range(60)], "holds 60 files, more than the 50 that an FMU may"),
    "a bomb": ([("zeros", bytes(3_000_000))], "unpacks to 3 MB, more than the 2 that an FMU may"),
    "a long description": ([("modelDescription.xml", bytes(40_000))], "its modelDescription.xml has"),
    "nothing": ([], "not a readable FMU"),
}


@pytest.mark.parametrize(("entries", "says"), ARCHIVES.values(), ids=ARCHIVES)
def test_an_archive_is_looked_at_before_it_is_unpacked(tmp_path, monkeypatch, entries, says):
    monkeypatch.setattr(limits, "MOST_FILES", 50)
    monkeypatch.setattr(limits, "MOST_BYTES", 2 * 1024**2)
    monkeypatch.setattr(limits, "MOST_DESCRIPTION", 30_000)
    fmu, folder = archive(tmp_path / "rig.fmu", entries), tmp_path / "unpacked"
    folder.mkdir()
    with pytest.raises(BadInput, match=says):
        unpack(fmu, folder) if entries else FmuRun(fmu)  # nothing unpacks well
    assert not [p for p in tmp_path.iterdir() if p not in (fmu, folder)]
    assert not (entries and list(folder.iterdir())) or "folder" in says or "cannot be unpacked" in says


def test_a_file_without_a_name_is_refused():
    entry = zipfile.ZipInfo("x")
    entry.filename = ""  # which zipfile reads, and does not write
    with pytest.raises(BadInput, match="holds a file named ''"):
        limits._check(Path("rig.fmu"), [entry])


@pytest.mark.parametrize("damage", [lambda b: b[:9000], lambda b: b[:5000] + b"\xff" + b[5001:], lambda b: b""])
def test_a_damaged_archive_is_said(sound, tmp_path, damage):
    (tmp_path / "rig.fmu").write_bytes(damage(sound.read_bytes()))
    with pytest.raises(BadInput, match="not a readable FMU"):
        unpack(tmp_path / "rig.fmu", tmp_path)


def test_a_pipe_is_no_fmu(tmp_path):
    os.mkfifo(tmp_path / "rig.fmu")
    with pytest.raises(BadInput, match="is a pipe or a device"):
        FmuRun(tmp_path / "rig.fmu")

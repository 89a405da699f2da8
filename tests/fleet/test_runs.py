"""Runs of a fleet that end in any way: nothing is done twice, nothing is lost, one row is spoilt at most."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest
from dashpot.errors import BadInput
from dashpot.face.batch import run
from dashpot.fleet.engine import local
from dashpot.fleet.manifest import read_manifest
from dashpot.fleet.store import Store

HERE = Path(__file__).parent
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")


@pytest.fixture
def fleet(tmp_path, monkeypatch):
    """``fleet("good", "bad", ...)``: the manifest of entries that end so."""
    monkeypatch.setenv("BEGUN", str(tmp_path / "begun"))
    monkeypatch.syspath_prepend(HERE)

    def make(*names):
        for name in names:
            (tmp_path / f"{name}.csv").write_text(name)
        rigs = "".join(f"  - recordings: {name}.csv\n" for name in names)
        (tmp_path / "fleet.yaml").write_text(f"format: dashpot-fleet/1\nrigs:\n{rigs}")
        return read_manifest(tmp_path / "fleet.yaml")

    return make


def begun(tmp_path):
    path = tmp_path / "begun"
    return Counter(path.read_text().splitlines()) if path.exists() else Counter()


def kept(folder):
    """Each entry's file as the disk has it: the same again unless it was written again."""
    files = folder.glob("results/*/entry.json")
    return {path.parent.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in files}


def states(rows):
    return {row.entry.name: row.outcome.state for row in rows}


def test_each_end_has_its_class_and_spoils_one_row(fleet, tmp_path):
    asked = fleet("good", "crash", "memory", "bad", "fault", "unfit", "unfit-later-crash")
    rows = run(asked, tmp_path / "out", local("worker", 4))
    assert states(rows) == {
        **{"good": "good", "crash": "killed", "memory": "memory", "bad": "bad-input"},
        **{"fault": "fault", "unfit": "mended", "unfit-later-crash": "killed"},
    }
    assert "SIGSEGV" in next(row.outcome.sentence for row in rows if row.entry.name == "crash")
    first = begun(tmp_path)
    assert set(first.values()) == {1}

    # what was ended from outside is tried again, once; what would come again is not
    again = run(asked, tmp_path / "out", local("worker", 4))
    assert states(again) == states(rows)
    assert begun(tmp_path) - first == Counter(["identify crash", "identify memory", "diagnose unfit-later-crash"])
    assert {row.entry.name: row.outcome.attempts for row in again}["crash"] == 2

    # until its input changes, or somebody asks for it
    (tmp_path / "bad.csv").write_text("mended, and bad again")
    before = begun(tmp_path)
    run(asked, tmp_path / "out", local("worker", 4), shard=(4, 7))
    assert begun(tmp_path) - before == Counter(["identify bad"])
    run(asked, tmp_path / "out", local("worker", 4), shard=(5, 7), again=True)
    assert (begun(tmp_path) - before)["identify fault"] == 1


def test_what_takes_too_long_is_ended_and_tried_again(fleet, tmp_path):
    asked = fleet("slow")
    for attempts in (1, 2):
        (row,) = run(asked, tmp_path / "out", local("worker", 1), limit=1.0)
        assert (row.outcome.state, row.outcome.attempts) == ("timeout", attempts)
        assert "--time-limit" in row.outcome.sentence


def test_a_process_that_takes_more_memory_than_it_may_spoils_its_row(fleet, tmp_path):
    rows = run(fleet("hungry", "good"), tmp_path / "out", local("worker", 2), memory=4000.0)
    assert states(rows) == {"hungry": "memory", "good": "good"}
    assert "memory" in rows[0].outcome.sentence


def test_an_interrupted_run_ends_its_processes_and_keeps_what_is_done(fleet, tmp_path):
    asked, engine = fleet("good", "slow"), local("worker", 2)

    def interrupted(tasks):
        for answer in engine(tasks):
            yield answer
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(asked, tmp_path / "out", interrupted)  # and waits for no 600 s
    assert len(kept(tmp_path / "out")) == 1
    assert states(run(asked, tmp_path / "out", local("worker", 2), limit=1.0)) == {"good": "good", "slow": "timeout"}
    assert begun(tmp_path)["identify good"] == 1


def test_a_file_that_is_not_there_spoils_one_row_until_it_is(fleet, tmp_path):
    asked = fleet("good", "later")
    (tmp_path / "later.csv").unlink()
    assert states(run(asked, tmp_path / "out", local("worker", 2))) == {"good": "good", "later": "bad-input"}
    (tmp_path / "later.csv").write_text("there")
    assert states(run(asked, tmp_path / "out", local("worker", 2))) == {"good": "good", "later": "good"}
    assert begun(tmp_path)["identify good"] == 1


def killed_in_the_middle(arguments, folder, done):
    """Start a run and kill it, and it alone, when so many entries are kept; what was kept by then."""
    process = subprocess.Popen([sys.executable, "-P", str(HERE / "kill_me.py"), *arguments])
    try:
        while len(kept(folder)) < done and process.poll() is None:
            time.sleep(0.01)
        assert process.poll() is None, "it ended before it could be killed"
    finally:
        process.kill()
        process.wait()
    time.sleep(0.3)  # its children end with it,
    store = Store(folder)  # and what was being written is written: by then nobody holds a lock
    while any(store.busy(lock.stem) for lock in folder.glob("locks/*.lock")):
        time.sleep(0.01)
    return kept(folder)


def test_killed_in_the_middle_and_run_again_nothing_is_done_twice_and_nothing_lost(fleet, tmp_path, monkeypatch):
    monkeypatch.setenv("TAKES", "0.2")
    names = [f"rig{i}" for i in range(10)]
    asked, folder = fleet(*names), tmp_path / "out"
    before = killed_in_the_middle([str(folder), str(tmp_path / "fleet.yaml")], folder, 4)
    first = begun(tmp_path)
    assert 4 <= len(before) < 10
    monkeypatch.setenv("TAKES", "0")
    rows = run(asked, folder, local("worker", 2))
    assert set(states(rows).values()) == {"good"}
    after = kept(folder)
    assert {name: after[name] for name in before} == before  # not written again
    assert len(after) == 10
    second = begun(tmp_path) - first
    done = {name.rpartition("-")[0] for name in before}
    assert {line.split()[1] for line in second} == set(names) - done
    assert set(second.values()) == {1}
    assert not list(folder.glob("results/*/.*")), "something half-written stays"
    assert len((folder / "fleet.csv").read_text().splitlines()) == 11
    # a third time there is nothing to do
    run(asked, folder, local("worker", 2))
    assert begun(tmp_path) - first - second == Counter()


def test_two_runs_on_one_folder_share_the_work(fleet, tmp_path, monkeypatch):
    monkeypatch.setenv("TAKES", "0.1")
    names = [f"rig{i}" for i in range(8)]
    fleet(*names)
    line = [sys.executable, "-P", str(HERE / "kill_me.py"), str(tmp_path / "out"), str(tmp_path / "fleet.yaml")]
    runs = [subprocess.Popen(line) for _ in range(2)]
    assert [process.wait() for process in runs] == [0, 0]
    assert begun(tmp_path) == Counter(f"identify {name}" for name in names)
    assert json.loads((tmp_path / "out" / "fleet.json").read_text())["counts"] == {"good": 8}


def test_shards_together_do_all_and_each_does_its_own(fleet, tmp_path):
    asked = fleet(*(f"rig{i}" for i in range(5)))
    first = run(asked, tmp_path / "out", local("worker", 2), shard=(1, 2))
    assert states(first) == {"rig0": "good", "rig2": "good", "rig4": "good"}
    table = (tmp_path / "out" / "fleet.csv").read_text()
    assert table.count(",open,") == 2
    run(asked, tmp_path / "out", local("worker", 2), shard=(2, 2))
    assert set(begun(tmp_path).values()) == {1}
    assert sum(begun(tmp_path).values()) == 5


def test_a_folder_of_something_else_is_refused(tmp_path):
    (tmp_path / "diary.txt").write_text("mine")
    with pytest.raises(BadInput, match="holds other files"):
        Store(tmp_path)
    (tmp_path / "fleet.json").write_text("{}")
    with pytest.raises(BadInput, match="was not made by dashpot batch"):
        Store(tmp_path)


def test_what_is_kept_of_a_damaged_entry_is_nothing(fleet, tmp_path):
    asked, folder = fleet("good"), tmp_path / "out"
    run(asked, folder, local("worker", 1))
    (entry,) = folder.glob("results/*/entry.json")
    for text in ("", "{}", entry.read_text().replace('"good"', '"excellent"'), "[1]"):
        entry.write_text(text)
        assert states(run(asked, folder, local("worker", 1))) == {"good": "good"}
    assert begun(tmp_path)["identify good"] == 5


def test_a_disk_that_cannot_be_written_ends_the_run_with_a_sentence(fleet, tmp_path):
    asked, folder = fleet("good"), tmp_path / "out"
    folder.mkdir()
    (folder / "fleet.json").write_text('{"format": "dashpot-fleet-results/1"}')
    (folder / "results").write_text("a file where the folder should be")
    with pytest.raises(BadInput, match="cannot be written"):
        run(asked, folder, local("worker", 1))


@pytest.mark.parametrize("name", ["full", "place"])
def test_no_room_on_the_machine_is_no_fault_of_a_row_which_is_done_when_there_is_some(fleet, tmp_path, name):
    asked = fleet(name)
    with pytest.raises(BadInput, match=r"No space left on device|takes nothing"):
        run(asked, tmp_path / "out", local("worker", 1))
    assert not kept(tmp_path / "out")
    assert not (tmp_path / "out" / "locks").exists()
    (tmp_path / "room").touch()
    assert states(run(asked, tmp_path / "out", local("worker", 1))) == {name: "good"}


def test_a_cluster_does_the_same(fleet, tmp_path):
    distributed = pytest.importorskip("distributed", reason="dask and distributed are an extra")
    from dashpot.fleet.engine import dask

    said = []
    asked = fleet("good", "crash", "other")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None, host="127.0.0.1", protocol="tcp://"
    ) as cluster:
        rows = run(asked, tmp_path / "out", dask("worker", cluster.scheduler_address, said.append))
    assert states(rows) == {"good": "good", "crash": "killed", "other": "good"}
    assert said[0].startswith("dashboard: ")


def test_a_cluster_that_is_not_there_is_said(monkeypatch):
    from dashpot.fleet.engine import dask

    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(BadInput, match=r"pip install 'dashpot\[fleet\]'"):
        dask("worker", "tcp://127.0.0.1:1", print)


def test_the_process_ends_with_whoever_asked(fleet, tmp_path):
    """Its stdin ends: so does it, in the middle of its work."""
    fleet("slow")
    Store(tmp_path / "out").begin()
    task = {"store": str(tmp_path / "out"), "key": "0" * 32, "stage": "identify", "again": False, "memory": None}
    entry = {"name": "slow", "rig": "slow", "state": None, "when": None, "recordings": []}
    program = f"import sys; sys.path.insert(0, {str(HERE)!r}); from worker import main; main()"
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    )
    assert process.stdin
    assert process.stdout
    process.stdin.write(json.dumps({**task, "entry": entry}).encode() + b"\n")
    process.stdin.flush()
    while not (tmp_path / "begun").exists():
        time.sleep(0.01)
    process.stdin.close()
    assert process.wait(20) != 0
    process.stdout.close()
    assert Store(tmp_path / "out").outcome("slow", "0" * 32) is None
    assert not kept(tmp_path / "out")

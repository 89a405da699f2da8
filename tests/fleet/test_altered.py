"""A fleet's folder of which anything was altered: `batch` does that entry again, `watch` refuses or says it."""

from __future__ import annotations

import os
import shutil
from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.face.batch import run, write_tables
from dashpot.files.writing import together, write
from dashpot.fleet.lives_of_rigs import lives_of
from dashpot.fleet.manifest import Entry, Manifest
from dashpot.fleet.outcome import Outcome, from_json
from dashpot.fleet.sealed_json import plain, sealed
from dashpot.fleet.store import Store
from dashpot.fleet.table import Row
from dashpot.model import Oscillator, Provenance
from dashpot.model.file import save

KEYS = {"a": "0" * 32, "b": "1" * 32}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of a fleet of two entries, with a page and a diagnosis each."""
    folder = tmp_path_factory.mktemp("made") / "out"
    store, rows = Store(folder), []
    store.begin()
    for name, key in KEYS.items():
        covariance = tuple(map(tuple, np.diag([0.01, 0.0025]).tolist()))
        known = Provenance(parameters=("omega0", "viscous"), covariance=covariance)
        model = replace(Oscillator.from_values(TRUTH, name=name), identified=known)
        outcome = Outcome(key, name, "good", "", model="diagnosis/model.yaml", page="report.html")
        place = store.place(name, key)
        with together():
            save(model, place / "model.yaml")
            save(model, place / "diagnosis" / "model.yaml")
            write(place / "report.html", "<html></html>")
            store.keep(outcome)
        kept = store.outcome(name, key)
        assert kept is not None
        rows.append(Row(Entry(name, "rig", None, None, ()), kept, place.relative_to(folder)))
    write_tables(Manifest(folder / "fleet.yaml", tuple(row.entry for row in rows)), folder, rows)
    return folder


@pytest.fixture
def folder(made, tmp_path):
    return shutil.copytree(made, tmp_path / "out")


def is_found(folder):
    """Whether what was altered is found by what `batch` asks, and by `watch`."""
    try:
        by_batch = any(Store(folder).outcome(name, key) is None for name, key in KEYS.items())
    except BadInput:  # the folder does not say any more that it is a fleet's
        return True, True
    said = []
    try:
        lives_of([folder], None, said.append)
    except BadInput:
        return True, by_batch
    return bool(said), by_batch


def files_of(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file() and path.stat().st_size)


def test_a_folder_as_it_was_written_is_used(folder):
    assert is_found(folder) == (False, False)


def test_a_change_of_any_byte_of_an_entry_is_found(folder):
    entries = [path for path in files_of(folder) if "results" in path.parts]
    assert len(entries) == 8
    for path in entries:
        name = path.relative_to(folder).parts[1].partition("-")[0]
        content = path.read_bytes()
        for i in range(0, len(content), 5):
            path.write_bytes(content[:i] + bytes([content[i] ^ 1 << i % 8]) + content[i + 1 :])
            assert Store(folder).outcome(name, KEYS[name]) is None, (path, i)
        path.write_bytes(content)
    assert is_found(folder) == (False, False)


def test_a_change_of_any_file_is_found_by_watch(folder):
    random = np.random.default_rng(0)
    for path in files_of(folder):
        content = path.read_bytes()
        of_entry = "results" in path.parts
        for i in random.integers(0, len(content), 8):
            path.write_bytes(content[:i] + bytes([content[i] ^ 1 << i % 8]) + content[i + 1 :])
            assert is_found(folder) in ((True, True), (True, of_entry)), (path, i)
        for changed in (content[: len(content) // 2], b"", content + b" "):
            path.write_bytes(changed)
            assert is_found(folder) in ((True, True), (True, of_entry)), path
        path.unlink()
        assert is_found(folder) in ((True, True), (True, of_entry)), path
        path.mkdir()
        assert is_found(folder)[0], path
        path.rmdir()
        path.write_bytes(content)
    assert is_found(folder) == (False, False)


@pytest.mark.skipif(not hasattr(os, "symlink") or os.name != "posix", reason="links of Unix")
def test_a_link_is_not_followed(folder, tmp_path):
    for path in files_of(folder):
        path.rename(tmp_path / "elsewhere")
        path.symlink_to(tmp_path / "elsewhere")
        of_entry = "results" in path.parts or path.name == "fleet.json"
        assert is_found(folder) in ((True, True), (True, of_entry)), path
        path.unlink()
        (tmp_path / "elsewhere").rename(path)
    place = Store(folder).place("a", KEYS["a"])
    place.rename(tmp_path / "elsewhere")
    place.symlink_to(tmp_path / "elsewhere")
    assert is_found(folder) == (True, True)


def test_a_path_that_leads_out_is_refused_though_its_hash_is_right(folder, tmp_path):
    entry = Store(folder).place("a", KEYS["a"]) / "entry.json"
    told = plain(entry.read_bytes())
    told.pop("sha256")
    for name in ("../../../other.yaml", str(tmp_path / "other.yaml"), "C:/other.yaml", "diagnosis\\model.yaml"):
        changed = {**told, "model": name, "files": {**told["files"], name: told["files"]["model.yaml"]}}
        assert from_json(changed) is not None  # of its form
        entry.write_text(sealed(changed), "utf-8")
        assert "leads out" in (Store(folder).changed("a", KEYS["a"]) or "")
        assert is_found(folder) == (True, True)


@pytest.mark.parametrize(
    "told",
    [
        {}, {"entries": []}, {"entries": {}, "files": {}}, {"entries": [1], "files": {}},
        {"entries": [{"name": "a"}], "files": {}}, {"entries": [], "files": []},
        {"entries": [{"name": "a", "rig": 1, "result": "good", "key": "", "state": None, "model": None}], "files": {}},
        {"entries": [{"name": "a", "rig": "", "result": "", "key": "", "when": "soon", "model": None}], "files": {}},
    ],
)  # fmt: skip
def test_a_table_of_another_form_is_refused(folder, told):
    (folder / "fleet.json").write_text(sealed({"format": "dashpot-fleet-results/1", **told}), "utf-8")
    with pytest.raises(BadInput, match="is no table of a fleet"):
        lives_of([folder], None, print)


@pytest.mark.parametrize("text", ["[" * 100_000, "", "NaN", "[]", '{"format": "dashpot-fleet-results/1"}'])
def test_a_table_that_is_none_is_refused(folder, text):
    (folder / "fleet.json").write_text(text)
    with pytest.raises(BadInput, match=r"holds no fleet\.json that can be used"):
        lives_of([folder], None, print)


def test_what_lies_where_an_entry_is_kept_ends_its_row_alone(tmp_path):
    """An entry.json that is a folder, or a link that would be written through."""
    rigs = {}
    for name in ("a", "b", "c", "d"):
        (tmp_path / f"{name}.csv").write_text("time_s,x_m\n")  # refused in a sentence
        rigs[name] = Entry(name, name, None, None, (str(tmp_path / f"{name}.csv"),))
    manifest, folder = Manifest(tmp_path / "fleet.yaml", tuple(rigs.values())), tmp_path / "out"

    def engine(tasks):
        for task in tasks:
            store = Store(folder)
            outcome = Outcome(task["key"], task["entry"]["name"], "good", "", model="model.yaml")
            with together():
                write(store.place(outcome.name, outcome.key) / "model.yaml", "model")
                outcome = store.keep(outcome)
            yield task, {"outcome": outcome.as_json()}

    rows = run(manifest, folder, engine)
    assert [row.outcome.state for row in rows] == ["good"] * 4
    places = {row.entry.name: folder / row.folder for row in rows}
    (places["a"] / "entry.json").unlink()
    (places["a"] / "entry.json").mkdir()
    (places["b"] / "model.yaml").unlink()
    (places["b"] / "model.yaml").symlink_to(tmp_path / "b.csv")
    (places["c"] / "model.yaml").write_text("another")
    said = []
    rows = run(manifest, folder, engine, say=said.append)
    assert [row.outcome.state for row in rows] == ["bad-input", "bad-input", "good", "good"]
    assert "is a folder, where dashpot batch keeps its own" in rows[0].outcome.sentence
    assert "is a link" in rows[1].outcome.sentence
    assert (tmp_path / "b.csv").read_text() == "time_s,x_m\n"
    assert said[0] == "c: what was kept is not as it was written (model.yaml was changed); it is done again"
    assert (places["c"] / "model.yaml").read_text() == "model"

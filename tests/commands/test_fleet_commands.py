"""batch, compare and watch as they are typed."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.examples.truth import TRUTH


@pytest.fixture(scope="module")
def stand(tmp_path_factory, recorded):
    """Recordings of a rig, twice as new and once with more friction, one of none, and their manifest; batch has run."""
    folder = tmp_path_factory.mktemp("stand")
    for i, dry in enumerate((0.015, 0.015, 0.02)):
        record = recorded({**TRUTH, "dry": dry}, begin=(8e-3, 0.0), seconds=2.5, seed=i)
        table = np.column_stack([record.time, record.response])
        np.savetxt(folder / f"t{i}.csv", table, "%.9g", ",", header="time_s,x_m", comments="")
    (folder / "broken.csv").write_text("time_s,x_m\n")
    (folder / "fleet.yaml").write_text(
        "format: dashpot-fleet/1\n"
        "defaults: {mass: 0.27, report: false, diagnose: never, max-left: 3x}\n"
        "rigs:\n"
        "  - {name: t0, rig: stand, recordings: t0.csv, when: 1}\n"
        "  - {name: t1, rig: stand, recordings: t1.csv, when: 2}\n"
        "  - {name: t2, rig: stand, recordings: t2.csv, when: 3}\n"
        "  - {name: broken, recordings: broken.csv}\n"
    )
    return folder


def typed(capsys, *words):
    code = 0
    try:
        main([str(word) for word in words])
    except SystemExit as end:
        code = end.code
    said = capsys.readouterr()
    return code, said.out, said.err


def test_a_fleet_is_identified_then_watched_and_compared(capsys, stand):
    out = stand / "out"
    code, said, progress = typed(capsys, "batch", stand / "fleet.yaml", "-o", out, "--jobs", "2")
    assert code == 1  # one row is spoilt
    assert said.splitlines()[-1] == "4 rows: 3 good, 1 bad-input"
    assert said.startswith("broken: bad-input: broken.csv")
    assert "identify 4/4" in progress
    assert (out / "index.html").exists()
    assert len((out / "fleet.csv").read_text().splitlines()) == 5

    code, said, progress = typed(capsys, "batch", stand / "fleet.yaml", "-o", out, "--json")
    assert code == 1
    assert json.loads(said)["counts"] == {"good": 3, "bad-input": 1}
    assert "identify" not in progress  # nothing is done twice

    code, said, _ = typed(capsys, "watch", out, "--report", stand / "life.html")
    assert code == 1
    assert said.startswith("stand: dry moved, and nothing else.")
    assert "dry changes between t1 and t2" in said
    assert (stand / "life.html").read_text().startswith("<!DOCTYPE html>")

    models = [next(out.glob(f"results/t{i}-*/model.yaml")) for i in range(3)]
    code, said, _ = typed(capsys, "compare", models[0], models[2], "--json")
    assert code == 1
    found = json.loads(said)
    assert found["moved"] == ["dry"]
    assert found["or_else"] == []
    code, said, _ = typed(capsys, "compare", *models[:2])
    assert (code, said.split("\n")[0]) == (0, "Nothing moved: the models differ by no more than chance makes.")
    code, said, _ = typed(capsys, "compare", models[0], models[2], "--repeats", *models[:2], "--json")
    assert json.loads(said)["judged_by"] == "repeats"
    assert json.loads(said)["degrees_of_freedom"] == 1


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("batch absent.yaml -o out2", "absent.yaml: cannot be read"),
        ("batch fleet.yaml -o .", "holds other files"),
        ("batch fleet.yaml -o out2 --shard 3/2", "is not k/n"),
        ("batch fleet.yaml -o out2 --scheduler tcp://127.0.0.1:9", "no Dask scheduler answers"),
        ("batch fleet.yaml -o out2 --scheduler banana", "missing port number in address 'banana'"),
        ("watch .", "holds no fleet.json"),
        ("watch absent.yaml", "absent.yaml: cannot be read"),
        ("compare fleet.yaml fleet.yaml", "says format 'dashpot-fleet/1'"),
    ],
)
@pytest.mark.filterwarnings("ignore")  # Dask's own
def test_what_cannot_be_done_is_said_and_nothing_written(capsys, stand, monkeypatch, words, says):
    if "--scheduler" in words:
        pytest.importorskip("distributed", reason="dask and distributed are an extra")
        from dashpot.fleet import engine

        monkeypatch.setattr(engine, "PATIENCE", 0.5)
    monkeypatch.chdir(stand)
    code, out, err = typed(capsys, *words.split())
    assert code == 2
    assert says in err
    assert out == ""
    assert not (stand / "out2").exists()


def test_a_model_is_kept_where_its_page_cannot_be_made():
    from dashpot.face.row import page_or_why

    def broken():
        raise ValueError("no picture")

    page, notes = page_or_why(True, broken)
    assert page is None
    assert notes[0].startswith("there is no page: this is a fault of dashpot")
    assert page_or_why(False, broken) == (None, [])
    assert page_or_why(True, lambda: "a page") == ("a page", [])

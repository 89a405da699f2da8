"""Lives from model files and from a fleet's results."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.face.batch import write_tables
from dashpot.files.writing import together
from dashpot.fleet.lives_of_rigs import lives_of, repeats_of
from dashpot.fleet.manifest import Entry, Manifest
from dashpot.fleet.outcome import Outcome
from dashpot.fleet.store import Store
from dashpot.fleet.table import Row
from dashpot.model import Oscillator, Provenance
from dashpot.model.file import save

ERRORS = np.array([0.1, 0.05])


@pytest.fixture
def fleet(tmp_path):
    """``fleet(("rig", "state", viscous), ...)``: a folder as batch leaves it, an entry each; None: without a model."""

    def make(*entries):
        rows = []
        for i, (rig, state, viscous) in enumerate(entries):
            name, model = f"e{i}", None
            if viscous is not None:
                values = {"mass": 1.0, "omega0": 80.0, "viscous": viscous, "cubic": 0.0, "preload": 0.0, "dry": 0.0}
                covariance = tuple(map(tuple, np.diag(ERRORS**2).tolist()))
                oscillator = replace(
                    Oscillator.from_values(values, name=name),
                    identified=Provenance(parameters=("omega0", "viscous"), covariance=covariance),
                )
                save(oscillator, tmp_path / f"{name}.yaml")
                model = "model.yaml"
            key, store = f"{i:032}", Store(tmp_path / "fleet")
            store.begin()
            with together():
                if model is not None:
                    save(oscillator, store.place(name, key) / model)
                store.keep(Outcome(key, name, "good", "", model=model))
            outcome = store.outcome(name, key)
            assert outcome is not None
            rows.append(
                Row(Entry(name, rig, state, None, ()), outcome, store.place(name, key).relative_to(store.folder))
            )
        manifest = Manifest(tmp_path / "fleet.yaml", tuple(row.entry for row in rows))
        write_tables(manifest, tmp_path / "fleet", rows)
        return tmp_path / "fleet"

    return make


def test_each_rig_has_its_life_and_what_has_none_is_said(fleet):
    said = []
    folder = fleet(
        ("a", None, 5.0), ("a", None, 6.0), ("b", None, 5.0), ("b", None, 5.0), ("c", None, 5.0), ("c", None, None)
    )
    lives = lives_of([folder], None, said.append)
    assert [(life.name, life.changed) for life in lives] == [("a", True), ("b", False)]
    assert [line.split(" has ")[0] for line in said] == ["note: e5", "note: c"]
    (alone,) = lives_of([folder], "b", said.append)
    assert alone.name == "b"


def test_a_fleet_of_one_test_each_is_one_life(fleet):
    (life,) = lives_of([fleet(("a", None, 5.0), ("b", None, 5.0), ("c", None, 6.0))], None, print)
    assert (life.name, len(life.points), life.moved.best.moved) == ("fleet", 3, ("viscous",))


def test_model_files_are_one_rig_named_by_what_their_names_share(fleet, tmp_path):
    fleet(("a", None, 5.0), ("a", None, 6.0))
    files = [(tmp_path / f"e{i}.yaml").rename(tmp_path / f"stand-{day}.yaml") for i, day in enumerate(("mon", "tue"))]
    (life,) = lives_of(files, None, print)
    assert life.name == "stand"
    assert [point.name for point in life.points] == ["e0", "e1"]


def test_repeats_are_entries_of_one_rig_in_one_state(fleet, tmp_path):
    folder = fleet(("a", "new", 5.0), ("a", "new", 5.1), ("a", "old", 6.0), ("b", "new", 5.0), ("a", None, 5.0))
    assert [[model.name for model in group] for group in repeats_of([folder])] == [["e0", "e1"]]
    assert [len(group) for group in repeats_of([tmp_path / "e0.yaml", tmp_path / "e3.yaml"])] == [2]
    assert repeats_of([]) == []
    with pytest.raises(BadInput, match="nothing repeats there"):
        repeats_of([tmp_path / "e0.yaml"])


def test_repeats_of_another_rig_teach_what_is_scatter(fleet):
    folder = fleet(("a", None, 5.0), ("a", None, 5.5), *[("b", "new", 5.0 + 0.3 * (-1) ** i) for i in range(10)])
    (stated,) = lives_of([folder], "a", print)
    assert stated.moved.best.moved == ("viscous",)
    (taught,) = lives_of([folder], "a", print, [folder])
    assert not taught.changed
    assert taught.repeatability.learnt == 9
    assert len(taught.estimates.values) == 2


def test_what_cannot_be_watched_is_said(fleet, tmp_path):
    folder = fleet(("stand", None, 5.0), ("stand", None, 5.0))
    with pytest.raises(BadInput, match="did you mean stand"):
        lives_of([folder], "stnd", print)
    with pytest.raises(BadInput, match="but not both"):
        lives_of([folder, tmp_path / "e0.yaml"], None, print)
    with pytest.raises(BadInput, match="--rig chooses"):
        lives_of([tmp_path / "e0.yaml", tmp_path / "e1.yaml"], "stand", print)
    with pytest.raises(BadInput, match="holds no model yet"):
        lives_of([fleet(("a", None, None))], None, lambda _: None)
    (folder / "fleet.json").write_text("[]")
    with pytest.raises(BadInput, match=r"holds no fleet.json that can be used"):
        lives_of([folder], None, print)

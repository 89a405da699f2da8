"""The table as Parquet: its columns have the same types whatever the rows hold."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from dashpot.errors import BadInput
from dashpot.fleet.manifest import Entry
from dashpot.fleet.outcome import Outcome
from dashpot.fleet.table import Row, parquet


def rows(*, std, when):
    mass = {"mass": {"value": 0.27, "std": std, "unit": "kg"}}
    good = Outcome("0" * 32, "a", "good", "fits", parameters=mass, model="model.yaml")
    bad = Outcome("1" * 32, "b", "bad-input", "is empty")
    return [Row(Entry(o.name, o.name, None, when, ("a.csv",)), o, Path(o.name)) for o in (good, bad)]


def test_what_nothing_is_known_of_has_its_type_all_the_same():
    pytest.importorskip("pyarrow", reason="pyarrow is an extra")
    import pyarrow
    import pyarrow.parquet

    def table(**known):
        return pyarrow.parquet.read_table(io.BytesIO(parquet(rows(**known))))

    known, unknown = table(std=1e-3, when=1), table(std=None, when=None)
    assert known.schema.equals(unknown.schema)
    assert pyarrow.concat_tables([known, unknown]).column("mass").to_pylist() == [0.27, None, 0.27, None]
    assert known.column("mass.std").to_pylist() == [1e-3, None]
    dated = table(std=None, when="2026-03-30")
    assert dated.column("when").to_pylist() == ["2026-03-30", "2026-03-30"]


def test_without_the_package_it_is_said(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(BadInput, match="needs pyarrow, which is not installed; pip install"):
        parquet(rows(std=None, when=None))

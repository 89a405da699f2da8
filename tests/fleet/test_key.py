"""The key of a result changes where the result may, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import dashpot.fleet.key as key_module
import pytest
from dashpot.errors import BadInput
from dashpot.fleet.key import key_of
from dashpot.fleet.manifest import Entry


@pytest.fixture
def entry(tmp_path):
    for name in ("a.csv", "b.csv", "law.py", "start.yaml"):
        (tmp_path / name).write_text(name)
    how = {"with": [], "fix": {}, "diagnose": "unfit"}
    return Entry("a", "rig", None, None, (str(tmp_path / "a.csv"),), reading={"unit": "mm"}, how=how)


def test_content_options_laws_start_and_version_are_in_the_key(entry, tmp_path, monkeypatch):
    keys = {key_of(entry)}
    others = [
        replace(entry, name="b"),
        replace(entry, recordings=(str(tmp_path / "b.csv"),)),
        replace(entry, holdout=(str(tmp_path / "b.csv"),)),
        replace(entry, reading={"unit": "m"}),
        replace(entry, how={**entry.how, "fix": {"dry": 0.0}}),
        replace(entry, start=str(tmp_path / "start.yaml")),
        replace(entry, laws=(str(tmp_path / "law.py"),)),
        replace(entry, recordings=(f"{entry.recordings[0]}#run3",)),
    ]
    keys |= {key_of(other) for other in others}
    for name in ("a.csv", "law.py", "start.yaml"):
        (tmp_path / name).write_text("changed")
    keys |= {key_of(other) for other in (entry, others[5], others[6])}
    monkeypatch.setattr(key_module, "__version__", "9.9")
    assert len(keys | {key_of(entry)}) == 1 + len(others) + 3 + 1


def test_where_a_file_lies_and_what_it_is_called_in_life_are_not(entry, tmp_path):
    (tmp_path / "moved").mkdir()
    (tmp_path / "moved" / "a.csv").write_text("a.csv")
    moved = replace(entry, recordings=(str(tmp_path / "moved" / "a.csv"),), rig="other", state="5 mm", when=3.0)
    assert key_of(moved) == key_of(entry)


def test_what_cannot_be_read_is_said(entry, tmp_path):
    for name in ("absent.csv", "."):
        with pytest.raises(BadInput, match="cannot be read"):
            key_of(replace(entry, recordings=(str(tmp_path / name),)))

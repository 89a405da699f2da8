"""The Python blocks of docs/python.md run."""

from __future__ import annotations

import re
from pathlib import Path

import dashpot
import pytest

PAGE = (Path(__file__).resolve().parents[2] / "docs/python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("block", BLOCKS, ids=["model", "known", "recordings"])
def test_the_block_runs(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "docs/python.md", "exec"), {})


def test_what_the_page_names_is_there():
    assert set(re.findall(r"dashpot\.(\w+)\(", PAGE)) <= set(dashpot.__all__)
    methods = set(re.findall(r"`model\.(\w+)\(", PAGE))
    assert methods
    assert all(callable(getattr(dashpot.Model, name)) for name in methods)

"""The Python blocks of docs/python.md run, and the API page has all that `dashpot` has."""

from __future__ import annotations

import inspect
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


def test_the_page_of_the_api_has_every_call():
    page = (Path(__file__).resolve().parents[2] / "docs/api.md").read_text(encoding="utf-8")
    members = {name for names in re.findall(r"members: \[(.*)\]", page) for name in names.split(", ")}
    members |= {name.rpartition(".")[2] for name in re.findall(r"^::: (\S+)$", page, re.MULTILINE)}
    errors = {"BadInput", "DashpotError", "ToolchainMissing"}  # whose module stands there as a whole
    assert set(dashpot.__all__) - errors - {"__version__", "examples"} <= members


@pytest.mark.parametrize("call", [dashpot.check, dashpot.plan, dashpot.prove_on])
def test_what_is_known_beforehand_has_its_class_on_the_page(call):
    page = (Path(__file__).resolve().parents[2] / "docs/api.md").read_text(encoding="utf-8")
    kind = inspect.signature(call).return_annotation
    assert re.search(rf"^::: dashpot\.foresight\.\w+\.{kind}$", page, re.MULTILINE)

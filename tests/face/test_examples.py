"""Every example of the docstrings behind ``dashpot``'s public names runs and gives what it says."""

from __future__ import annotations

import doctest
import inspect

import dashpot
import pytest
from dashpot.face import commands
from dashpot.face.model import Model

#: Looked at by hand: what takes minutes, or writes where it is started.
WITHOUT = {"commands.demo", "commands.paper", "Model.verify", "Model.diagnose"}


def examples():
    finder = doctest.DocTestFinder(recurse=False)
    found = finder.find(dashpot, "dashpot")
    for name, function in inspect.getmembers(commands, inspect.isfunction):
        if function.__module__ == commands.__name__ and not name.startswith("_"):
            found += finder.find(function, f"commands.{name}", module=commands, globs={})
    found += finder.find(Model, "Model", globs={})
    for name in vars(Model):
        if not name.startswith("_") and callable(getattr(Model, name)):
            found += finder.find(getattr(Model, name), f"Model.{name}", globs={})
    return {example.name: example for example in found if example.examples or example.name.startswith("commands.")}


EXAMPLES = examples()


def test_each_call_has_an_example():
    assert {name for name, example in EXAMPLES.items() if not example.examples} == {"commands.demo", "commands.paper"}
    assert {"dashpot", "Model", "Model.simulate", "Model.backbone", "Model.export", "Model.linearise"} <= set(EXAMPLES)


@pytest.mark.parametrize("name", [name for name, example in EXAMPLES.items() if example.examples])
def test_the_example_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failed = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    example = EXAMPLES[name]
    example.globs = {}
    runner.run(example, out=failed.append)
    assert not runner.failures, "".join(failed)

"""dashpot's public names: pinned, seen by dir(), light to import, and callable where a folder has the same name."""

from __future__ import annotations

import inspect
import subprocess
import sys
from importlib import import_module, resources, util

import dashpot
import pytest
from dashpot.commands.cli import cli

CALLS = [
    *(
        "demo",
        "diagnose",
        "doctor",
        "export",
        "hilbert",
        "identify",
        "linearise",
        "load",
        "load_element",
        "load_laws",
        "look",
    ),
    *("batch", "check", "compare", "identify_element", "paper", "plan", "prove_on", "read"),
    *("simulate", "verify", "watch"),
]
CLASSES = [
    *("Backbone", "BadInput", "DashpotError", "Diagnosis", "ElementDiagnosis", "ForceElement", "Hilbert"),
    *("LinearModel", "Model", "Recording", "Simulation", "ToolchainMissing", "Verification"),
]
#: Commands that are something else in Python: print(model), and nothing.
OTHERWISE = {"show", "completion"}


def test_the_public_names_are_these():
    assert sorted(dashpot.__all__) == sorted([*CALLS, *CLASSES, "__version__", "examples"]) == dir(dashpot)
    assert all(inspect.isclass(getattr(dashpot, name)) for name in CLASSES)


def test_each_command_has_a_call():
    assert {name.replace("-", "_") for name in cli.commands} - OTHERWISE <= set(CALLS)


@pytest.mark.parametrize("name", CALLS)
def test_a_call_is_one_before_and_after_the_folder_of_its_name_is_imported(name):
    commands = import_module("dashpot.face.commands")
    program = f"import dashpot, inspect; print(inspect.signature(dashpot.{name}))"
    expected = str(inspect.signature(getattr(commands, name)))
    assert str(inspect.signature(getattr(dashpot, name))) == expected
    if util.find_spec(f"dashpot.{name}") is not None:
        assert import_module(f"dashpot.{name}") is getattr(dashpot, name)
    if name == "identify":  # in a fresh Python, where nothing was imported before
        run = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=True)
        assert run.stdout.strip() == expected


def test_what_is_in_a_folder_is_imported_as_ever():
    from dashpot.export import export
    from dashpot.identify import identify

    assert identify.__module__ == "dashpot.identify.identification"
    assert export is dashpot.export.export  # type: ignore[attr-defined]
    assert callable(dashpot.identify)


def test_a_name_that_is_none_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'identfy'"):
        dashpot.__getattr__("identfy")


def test_types_are_told():
    assert resources.files("dashpot").joinpath("py.typed").is_file()


def test_importing_is_light_and_the_names_cost_nothing():
    program = "import sys, dashpot; dir(dashpot); print('numpy' in sys.modules, 'dashpot.face' in sys.modules)"
    run = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["False", "False"]

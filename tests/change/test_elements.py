"""Force laws by themselves, compared and watched as rigs are."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from dashpot.change.comparison import compare
from dashpot.change.life import Point, watch
from dashpot.change.wording import sentence
from dashpot.errors import BadInput
from dashpot.face.element import ForceElement
from dashpot.face.fleet import compare as compared
from dashpot.model import Provenance
from dashpot.model.element import Element
from dashpot.model.element_file import save_element

NAMES = ("viscous", "dry")
TRUE, ERRORS = np.array([800.0, 12.0]), np.array([0.5, 0.02])
COVARIANCE = np.array([[1.0, -0.9], [-0.9, 1.0]]) * np.outer(ERRORS, ERRORS)


def damper(shift: float = 0.0, seed: int = 0, *, over_noise: float = 1.0, name: str = "damper") -> Element:
    """As if identified: its friction ``shift`` N more, and what chance does."""
    drawn = TRUE + np.linalg.cholesky(COVARIANCE) @ np.random.default_rng(seed).standard_normal(2)
    made = Element.from_values(dict(zip(NAMES, map(float, drawn + np.array([0.0, shift])), strict=True)), name=name)
    known = {n: replace(made.parameters()[n], std=float(e)) for n, e in zip(NAMES, ERRORS, strict=True)}
    recording = {"file": "a.csv", "nrmse": 0.01, "over_noise": over_noise}
    rows = tuple(map(tuple, COVARIANCE.tolist()))
    return replace(made.with_parameters(known), identified=Provenance((recording,), parameters=NAMES, covariance=rows))


def test_the_friction_of_a_damper_is_what_moved_and_its_unit_is_newton() -> None:
    found = compare(damper(), damper(0.5, 1))
    assert found.moved.best.moved == ("dry",)
    assert re.match(r"dry moved, and nothing else: dry from 1[12]\.\d+ to 12\.\d+ N \(\+4", sentence(found))
    assert not compare(damper(), damper(0.0, 1)).changed


def test_a_life_says_when() -> None:
    life = watch([Point(str(i), damper(0.0 if i < 3 else 0.5, i)) for i in range(6)], "damper")
    assert life.changed
    assert [(step.parameter, step.state) for step in life.steps] == [("dry", 3)]


def test_what_a_bad_fit_leaves_is_of_the_force() -> None:
    found = compare(damper(over_noise=9.0), damper(0.5, 1))
    assert any(note.startswith("the models leave up to 9.00 times the noise") for note in found.notes)


def test_files_objects_and_elements_are_taken_and_an_oscillator_is_not(model, tmp_path) -> None:
    path = tmp_path / "damper.yaml"
    save_element(damper(), path)
    for first in (path, str(path), ForceElement(damper()), damper()):
        assert compared(first, damper(0.5, 1)).moved.best.moved == ("dry",)
    with pytest.raises(BadInput, match="damper is a force law by itself and rig an oscillator; compare"):
        compared(model(), path)

"""What the tests of the exports as program text share: states to evaluate at, and CasADi's answer there."""

from __future__ import annotations

from typing import Any

import numpy as np
from dashpot.export.facts import Facts
from dashpot.export.program import Program, functions, program
from dashpot.model import Oscillator


def points(model: Oscillator, count: int = 40) -> list[tuple[np.ndarray, float, float]]:
    """States, force and time: anywhere in the motion, and on the surfaces of Eq. 17, at rest under small forces too."""
    facts = Facts(model)
    random = np.random.default_rng(7)
    sizes = np.array(facts.size.nominals)
    made = []
    for k in range(count):
        z, u = sizes * random.uniform(-1.2, 1.2, sizes.size), float(random.uniform(-2.0, 2.0))
        if k % 4 == 1:
            z[0] = 0.0
        if k % 4 >= 2:
            z[1] = 0.0
        if k % 8 == 7:
            z[0], u = 0.0, 1e-2 * u
        if k % 8 == 6:
            z[:2], u = 0.0, 0.0
        made.append((z, u, float(random.uniform(0.0, 2.0))))
    return made


def expected(of: Program, given: list[tuple[np.ndarray, float, float]], p: list[float]) -> dict[str, np.ndarray]:
    """(points, elements) of each function by CasADi."""
    return {
        name: np.array([np.array(function(z, u, p, t)).ravel() for z, u, t in given])
        for name, function in functions(of).items()
    }


def of_model(model: Oscillator) -> tuple[Program, list[float]]:
    """The program of a model, and its parameters' values in order."""
    return program(Facts(model)), list(model.values().values())


def same(got: Any, wanted: np.ndarray, part: float = 1e-11) -> None:
    """Assert that (points, elements) are the same to rounding, each element in parts of its largest."""
    got = np.asarray(got, float)
    assert got.shape == wanted.shape
    size = np.maximum(np.max(np.abs(wanted), axis=0), 1e-300)
    assert np.max(np.abs(got - wanted) / size) < part

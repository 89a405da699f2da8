"""Models with any values and any covariance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.model import Oscillator, Provenance, oscillator_with

NAMES = ("omega0", "cubic", "preload", "viscous", "dry")
TRUE = np.array([79.6, 4.6e5, 0.074, 5.0, 0.015])
ERRORS = np.array([0.02, 4e3, 2e-4, 0.01, 1e-4])
#: omega0 and cubic trade against each other, viscous and dry too.
CORRELATION = np.array(
    [[1, -0.98, 0, 0, 0], [-0.98, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, -0.95], [0, 0, 0, -0.95, 1]], float
)
COVARIANCE = CORRELATION * np.outer(ERRORS, ERRORS)


@pytest.fixture
def rig() -> SimpleNamespace:
    """Names, true values, errors and covariance of the parameters, and ``shifted(name, errors)``."""

    def shifted(name: str, errors: float) -> np.ndarray:
        return errors * ERRORS * (np.array(NAMES) == name)

    return SimpleNamespace(values=TRUE, errors=ERRORS, covariance=COVARIANCE, shifted=shifted)


@pytest.fixture
def model() -> Callable[..., Oscillator]:
    """``model(values, covariance, name=, over_noise=, effects=)``: as if identified with these errors."""

    def make(values=TRUE, covariance=COVARIANCE, *, name="rig", over_noise=1.0, effects=(), **more):
        given = {"mass": 0.27, **dict(zip(NAMES, map(float, values), strict=True)), **more}
        bare = oscillator_with(given, name=name, effects=effects)
        errors = dict(zip(NAMES, np.sqrt(np.diag(covariance)), strict=True))
        with_errors = {n: replace(p, std=float(errors[n])) for n, p in bare.parameters().items() if n in errors}
        recording = {"file": "a.csv", "nrmse": 0.01, "over_noise": over_noise}
        provenance = Provenance(
            recordings=(recording,), parameters=NAMES, covariance=tuple(map(tuple, covariance.tolist()))
        )
        return replace(bare.with_parameters(with_errors), identified=provenance)

    return make


@pytest.fixture
def drawn(model) -> Callable[..., Oscillator]:
    """``drawn(random, shift, spread)``: an estimate of the rig, shifted, with scatter between repeats besides."""

    def make(random, shift=0.0, spread=0.0, inflation=1.0, **more):
        own = np.linalg.cholesky(COVARIANCE) @ random.standard_normal(5) * np.sqrt(inflation)
        return model(TRUE + shift + own + spread * random.standard_normal(5), **more)

    return make

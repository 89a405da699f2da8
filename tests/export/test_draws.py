"""Draws from the covariance: their distribution against the closed form, their bounds, their being the same again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.export.draws import draws, limits
from dashpot.model import Oscillator, Provenance

STD = {"mass": 3e-4, "omega0": 2e-3, "cubic": 5e3, "preload": 8e-4, "viscous": 2e-3, "dry": 5e-4}


def known(model: Oscillator, **std: float) -> Oscillator:
    """The model with independent standard errors for the parameters named."""
    matrix = np.diag(np.square(list(std.values())))
    provenance = Provenance(parameters=tuple(std), covariance=tuple(map(tuple, matrix.tolist())))
    return replace(model, identified=provenance)


def table(model: Oscillator, count: int, seed: int = 0) -> np.ndarray:
    """(count, rows of the covariance)."""
    names = model.identified.parameters
    return np.array([[draw[name] for name in names] for draw in draws(model, count, seed)])


def test_mean_and_covariance_are_those_of_the_model(models):
    model = known(models["base"](), **STD)
    matrix = np.array(model.identified.covariance)
    matrix[1, 2] = matrix[2, 1] = -0.9 * STD["omega0"] * STD["cubic"]
    model = replace(model, identified=replace(model.identified, covariance=tuple(map(tuple, matrix.tolist()))))
    n = 4000
    drawn = table(model, n)
    error = (drawn.mean(axis=0) - list(model.values().values())) / list(STD.values())
    assert np.max(np.abs(error)) < 4 / np.sqrt(n)
    scale = np.outer(list(STD.values()), list(STD.values()))
    assert np.max(np.abs(np.cov(drawn.T) - matrix) / scale) < 6 / np.sqrt(n)


def test_the_same_seed_gives_the_same_draws_and_more_begin_with_the_fewer(models):
    model = known(models["base"](), **STD)
    assert draws(model, 5) == draws(model, 9)[:5]
    assert draws(model, 5, 1) != draws(model, 5, 2)
    assert draws(model, 0) == []


def test_what_is_not_in_the_covariance_stays(models):
    model = known(models["drag"](), mass=1e-3)
    for draw in draws(model, 5):
        assert list(draw) == list(model.values())
        assert {name for name in draw if draw[name] != model.values()[name]} == {"mass"}


def test_a_covariance_of_lower_rank_moves_together(models):
    model = models["base"]()
    rows = ((1e-6, 2e-6), (2e-6, 4e-6))
    model = replace(model, identified=Provenance(parameters=("viscous", "omega0"), covariance=rows))
    drawn = table(model, 50) - [model.viscous.value, model.omega0.value]
    assert np.allclose(2 * drawn[:, 0], drawn[:, 1], rtol=0, atol=1e-7 * 1e-3)
    assert np.std(drawn[:, 0]) > 5e-4


def test_bounds_hold_and_cut_the_distribution_where_they_are(models):
    """A half-normal distribution has its mean at sqrt(2/pi) of the standard deviation: clipping would halve it."""
    model = models["drag"]()
    model = model.with_parameters({"quadratic-drag.coefficient": replace_value(model, "quadratic-drag.coefficient", 0)})
    drawn = table(known(model, **{"quadratic-drag.coefficient": 2.0}), 4000)[:, 0]
    assert drawn.min() >= 0.0
    assert drawn.mean() == pytest.approx(2.0 * np.sqrt(2 / np.pi), rel=0.05)


def replace_value(model: Oscillator, name: str, value: float):
    return replace(model.parameters()[name], value=float(value))


def test_signs_that_nature_wants_are_kept_where_the_model_has_them(models):
    model = models["base"]()
    assert np.all(table(known(model, mass=0.2, omega0=60.0, viscous=5.0, dry=0.03, preload=0.1), 300) > 0)
    assert limits(model, "cubic") == (-np.inf, np.inf)
    assert limits(models["drag"](), "quadratic-drag.coefficient") == (0.0, np.inf)
    feeding = model.with_parameters({"viscous": replace_value(model, "viscous", -0.1)})
    drawn = table(known(feeding, viscous=0.1), 300)
    assert drawn.min() < 0 < drawn.max()


def test_what_cannot_be_drawn_is_said(models):
    model = models["base"]()
    with pytest.raises(BadInput, match="no covariance to draw parameters from"):
        draws(model, 1)
    with pytest.raises(BadInput, match="correlation above 1"):
        draws(replace(model, identified=Provenance(parameters=("mass", "dry"), covariance=((1.0, 2.0), (2.0, 1.0)))), 1)
    with pytest.raises(BadInput, match="'gap' is no parameter"):
        draws(replace(model, identified=Provenance(parameters=("gap",), covariance=((1.0,),))), 1)
    beyond = models["drag"]()
    name = "quadratic-drag.coefficient"
    beyond = known(beyond.with_parameters({name: replace_value(beyond, name, -1.0)}), **{name: 1e-3})
    with pytest.raises(BadInput, match=r"of 2000 draws from the covariance only 0 lie .* because of quadratic-drag"):
        draws(beyond, 2)

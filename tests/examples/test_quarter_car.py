"""A strut that was identified by itself, as an FMU in a car, against one integration of all equations."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from dashpot.examples.system.quarter_car import drive, monolithic, strut_and_wheel


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    if shutil.which("gcc") is None and shutil.which("cc") is None:
        pytest.skip("no C compiler")
    return strut_and_wheel(tmp_path_factory.mktemp("car"))


def test_the_car_goes_over_the_bump_as_one_integration_has_it(fmus: tuple[Path, Path]) -> None:
    went = drive(*fmus, step=1e-3, seconds=1.0)
    true = monolithic(went.time)
    off = np.sqrt(np.mean((went.moved - true) ** 2, axis=0)) / np.std(true, axis=0)
    assert np.all(off < 5e-3)


def test_a_shorter_step_is_nearer(fmus: tuple[Path, Path]) -> None:
    coarse, fine = (drive(*fmus, step=step, seconds=0.4) for step in (4e-3, 1e-3))
    true = monolithic(coarse.time)
    errors = [np.std(one.moved[::every] - true) for one, every in ((coarse, 1), (fine, 4))]
    assert errors[1] < 0.5 * errors[0]

"""The mended model fitted to whole recordings: better where that tells them better in one run, else left as it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose import repair_trial
from dashpot.diagnose.repair_trial import fitted_to_all, record_fits
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator

NOISE = 2e-5
NAMES = ("omega0", "cubic", "preload", "viscous", "dry")


@pytest.fixture(scope="module")
def decay(recorded):
    return recorded(begin=(8e-3, 0.0), seconds=6.0, noise=NOISE, seed=1, name="decay")


@pytest.fixture(scope="module")
def stretch():
    """As if from a part of it: after fifty cycles it is a radian and a half ahead."""
    values = {name: TRUTH[name] for name in NAMES} | {"omega0": 1.005 * TRUTH["omega0"]}
    return Oscillator.from_values(values, name="rig")


def left(model, recording):
    (row,) = record_fits(model, model, [recording], holdout=False)
    return row.nrmse_after, row.noise_floor


def test_the_whole_is_told_better_by_a_fit_to_it(decay, stretch):
    found = fitted_to_all(stretch, [decay], ())
    assert found is not None
    before, (after, floor) = left(stretch, decay)[0], left(found, decay)
    assert before > 5 * floor
    assert after < 1.1 * floor
    for name in NAMES:
        parameter = found.parameters()[name]
        assert abs(parameter.value - TRUTH[name]) < 4 * parameter.std
    assert [entry["file"] for entry in found.identified.recordings] == ["decay"]
    assert found.hold == stretch.hold


def test_a_parameter_that_is_kept_keeps_its_value(decay, stretch):
    found = fitted_to_all(stretch, [decay], ("cubic",))
    assert found is not None
    assert found.cubic.value == stretch.cubic.value
    assert found.omega0.value != stretch.omega0.value


@pytest.mark.parametrize(("factor", "taken"), [(1.0048, True), (1.0052, False)])
def test_what_tells_the_whole_worse_is_not_taken(monkeypatch, decay, stretch, factor, taken):
    """By a hundredth of the power."""
    rows = record_fits(stretch, stretch, [decay], holdout=False)
    made = [replace(row, nrmse_before=2 * row.noise_floor, nrmse_after=2 * row.noise_floor * factor) for row in rows]
    monkeypatch.setattr(repair_trial, "record_fits", lambda *_args, **_more: made)
    assert (fitted_to_all(stretch, [decay], ()) is not None) is taken


def test_where_nothing_follows_the_whole_the_model_stays(monkeypatch, decay, stretch):
    def nothing(*_args, **_more):
        raise BadInput("nothing simulates")

    monkeypatch.setattr(repair_trial, "maximum_likelihood", nothing)
    assert fitted_to_all(stretch, [decay], ()) is None


def test_noise_alone_is_no_reason_to_stay(decay, stretch):
    """A fit at the noise is taken though another is as near to it: its errors are smaller."""
    found = fitted_to_all(stretch, [decay], ())
    assert found is not None
    again = fitted_to_all(found, [decay], ())
    assert again is not None
    values = np.array(list(found.values().values()))
    assert np.array(list(again.values().values())) == pytest.approx(values, rel=1e-2)

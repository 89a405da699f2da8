"""A response, a force and times as arrays of their own and as Series."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import recordings_of

T = np.arange(3000) / 1000.0
X = 5e-3 * np.exp(-2.5 * T) * np.cos(79.6 * T)


def one(*given, **options):
    (recording,) = recordings_of(*given, **options)
    return recording


def test_times_may_be_given_in_place_of_a_frequency():
    for time in (T, T.tolist(), tuple(T)):
        recording = one(X, time=time)
        assert recording.fs == pytest.approx(1000.0, rel=1e-12)
        assert np.array_equal(recording.response, X)
    assert one(X, time=T + 5.0, force=np.sin(T)).start == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("given", "options", "said"),
    [
        (X, {}, "with fs, in Hz, or its times with time, in s"),
        (X, {"time": T[:5]}, r"the response has shape \(3000,\), the times \(5,\); give one for each sample"),
        (
            X,
            {"fs": 1e3, "force": T[:5]},
            r"the response has shape \(3000,\), the force \(5,\); give one for each sample",
        ),
        ({"time_s": T, "x_m": X}, {"time": T}, "has columns of its own, so --time names one of them"),
        ({"time_s": T, "x_m": X}, {"force": T}, "has columns of its own, so --force names one of them"),
        ("absent.csv", {"time": T}, "absent.csv: is a file, so --time names its column"),
    ],
)
def test_what_does_not_go_together_is_said(given, options, said):
    with pytest.raises(BadInput, match=said):
        one(given, **options)


def test_a_series_brings_its_times_and_its_unit():
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    recording = one(pandas.Series(1e3 * X, index=T, name="x_mm"), force=pandas.Series(np.sin(T)))
    assert np.allclose(recording.response, X, rtol=1e-12)
    assert recording.fs == pytest.approx(1000.0, rel=1e-12)
    assert np.array_equal(recording.force, np.sin(T))
    assert one(pandas.Series(X), fs="1 kHz").fs == 1000.0
    assert one(pandas.Series(X, index=pandas.to_datetime(T, unit="s"))).fs == pytest.approx(1000.0, rel=1e-9)
    assert one(pandas.Series(X), time=pandas.Series(T)).fs == pytest.approx(1000.0, rel=1e-12)
    assert len(recordings_of([pandas.Series(X), pandas.Series(X)], fs=1000.0)) == 2
    with pytest.raises(BadInput, match="an array says nothing of time"):
        one(pandas.Series(X))

"""Arrays of any kind: masked is missing, whatever holds the mask; what is no number is passed over and said."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import Recording, from_data
from dashpot.recording.given import recordings_of
from dashpot.recording.plain_numbers import numbers_of
from dashpot.recording.recording import from_sep5

FS = 1000.0
T = np.arange(2000) / FS
X = 5e-3 * np.exp(-2.5 * T) * np.cos(2 * np.pi * 12.67 * T)
F = np.sin(2 * np.pi * (5 + 3 * T) * T)
#: Masked, with what a logger writes there.
MASK = np.isin(np.arange(T.size), [400, 401, 900])
WRONG = np.ma.MaskedArray(np.where(MASK, 9999.0, X), MASK)


def is_bridged(recording):
    """By the neighbours, to what a spline through a motion of 80 samples a cycle leaves of it."""
    assert recording.n == T.size
    np.testing.assert_allclose(recording.response, X, rtol=0, atol=1e-7)
    assert any("missing" in note for note in recording.notes)


@pytest.mark.parametrize(
    "given",
    [
        {"fs": FS, "x_m": WRONG},
        {"time_s": T, "force_N": F, "x_m": WRONG},
        {"time_s": np.ma.MaskedArray(T), "x_m": WRONG},
        {"fs": FS, "x_m": [None if gone else float(x) for gone, x in zip(MASK, X, strict=True)]},
        {"fs": FS, "x_m": [Decimal("NaN") if gone else Decimal(float(x)) for gone, x in zip(MASK, X, strict=True)]},
        [{"data": WRONG, "fs": FS, "name": "x", "unit_str": "m"}],
        {"run": {"fs": FS, "x_m": WRONG}},
        {"fs": FS, "both_m": np.ma.MaskedArray(np.column_stack([WRONG.data, F]), np.column_stack([MASK, MASK]))},
        {"fs": FS, "table": np.ma.MaskedArray(np.array(list(zip(WRONG.data, F, strict=True)), "f8,f8"),
                                              np.array(list(zip(MASK, MASK, strict=True)), "?,?"))},
    ],
    ids=["one", "by time", "masked time", "None", "Decimal", "SEP 5", "group", "matrix", "fields"],
)  # fmt: skip
def test_masked_is_missing(given):
    how = {}
    if "both_m" in given:
        how = {"response": "both_m_1", "force": "none"}
    if "table" in given:
        how = {"response": "f0", "force": "none", "unit": "m"}
    (recording,) = recordings_of(given, **how)
    is_bridged(recording)


def test_a_masked_array_alone_and_its_force():
    (recording,) = recordings_of(WRONG, fs=FS, unit="m", force=np.ma.MaskedArray(np.where(MASK, 1e6, F), MASK))
    is_bridged(recording)
    np.testing.assert_allclose(recording.force, F, rtol=0, atol=1e-4)


def test_whole_numbers_with_a_mask():
    (recording,) = recordings_of({"fs": FS, "x": np.ma.MaskedArray(np.round(X * 1e9).astype(int), MASK)}, unit="nm")
    is_bridged(recording)


def test_a_dictionary_of_sep5_is_bridged_too():
    is_bridged(from_sep5({"data": WRONG, "fs": FS, "name": "x", "unit_str": "m"}))


def test_a_record_with_masked_samples_is_refused():
    with pytest.raises(BadInput, match="has masked samples, which are missing"):
        Recording("run", FS, WRONG)
    with pytest.raises(BadInput, match="the force has masked samples"):
        Recording("run", FS, X, WRONG)
    assert Recording("run", FS, np.ma.MaskedArray(X, False)).n == T.size
    with pytest.raises(BadInput, match="not an array of numbers, but of complex numbers"):
        Recording("run", FS, X.astype(complex))
    with pytest.raises(BadInput, match="not an array of numbers, but of text"):
        replace(Recording("run", FS, X), response=X.astype(str))


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ([Decimal("1.5"), Fraction(1, 2), 3], [1.5, 0.5, 3.0]),
        (np.array(["2020-01-01T00:00:00", "NaT", "2020-01-01T00:00:01.5"], "datetime64[ms]"), [0.0, np.nan, 1.5]),
        (np.array(["NaT", "2020-01-01"], "datetime64[D]"), [np.nan, 0.0]),
        (np.array([1500, 2500], "timedelta64[ms]"), [1.5, 2.5]),
        (np.ma.MaskedArray(np.array([1, 2], "timedelta64[s]"), [True, False]), [np.nan, 2.0]),
        ([1, None, 2.5], [1.0, np.nan, 2.5]),
        (np.ma.masked_all(2), [np.nan, np.nan]),
        ([], []),
        (7, 7),
    ],
)
def test_what_is_a_number_is_one(given, values):
    np.testing.assert_array_equal(numbers_of(given).values, values)


@pytest.mark.parametrize(
    ("given", "kind"),
    [
        ([1j, 2.0], "complex numbers"), ([True, False], "yes or no"), (["1", "2"], "text"), ([b"1"], "text"),
        (np.zeros(2, "f8,f8"), "records of several values"), ([1.0, "x"], "text"), ([None, None], "objects"),
        ([object()], "objects"), ([1, [2, 3]], "objects"), ([10**400, 1], "objects"), ([True, None], "objects"),
        ([datetime.now(UTC)], "objects"), ([timedelta(1)], "objects"), (None, "objects"), ("text", "text"),
    ],
)  # fmt: skip
def test_what_is_none_has_a_kind(given, kind):
    found = numbers_of(given)
    assert found.values is None
    assert found.kind.startswith(kind)


@pytest.mark.parametrize(
    ("name", "values", "kind"),
    [
        ("z", F + 1j, "complex numbers"), ("on", F > 0, "yes or no"), ("label", ["a"] * T.size, "text"),
        ("cube", np.zeros((T.size, 2, 2)), "3 dimensions"), ("odd", [object()] * T.size, "objects"),
    ],
)  # fmt: skip
def test_a_column_that_is_none_is_said(name, values, kind):
    recording = from_data({"fs": FS, "x_m": X, name: values})
    assert [note for note in recording.notes if f"passed over, as no real numbers: '{name}' ({kind}" in note]
    with pytest.raises(BadInput, match=r"holds no (vector of|real) numbers"):
        from_data({"fs": FS, name: values})


def test_what_is_no_column_is_not_said():
    assert from_data({"fs": FS, "x_m": X, "who": "me", "places": ["a", "b"]}).notes == ()


def test_rates_that_differ_are_refused():
    with pytest.raises(BadInput, match=r"states several sampling rates: 'fs' 1000 Hz, 'dt' 500 Hz"):
        from_data({"fs": FS, "dt": 0.002, "x_m": X})
    assert from_data({"fs": FS, "dt": 0.001, "sample_rate": 1000, "x_m": X}).fs == FS
    with pytest.raises(BadInput, match="'fs' is nan, which is no sampling rate"):
        from_data({"fs": np.ma.masked, "x_m": X})


def test_frames_of_pandas():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"x_m": pandas.array(np.where(MASK, 0.0, X), "Float64")})
    frame.loc[MASK, "x_m"] = pandas.NA
    is_bridged(from_data(frame, fs=FS))
    whole = pandas.DataFrame({"x": pandas.array(np.round(X * 1e9).astype(int), "Int64")})
    whole.loc[MASK, "x"] = pandas.NA
    is_bridged(from_data(whole, fs=FS, unit="nm"))
    start = pandas.Timestamp("2024-05-01", tz="Europe/Ljubljana")
    for index in (start + pandas.to_timedelta(T, "s"), pandas.to_timedelta(T + 5, "s")):
        recording = from_data(pandas.DataFrame({"x_m": X}, index=index))
        assert recording.fs == pytest.approx(FS)
        column = from_data(pandas.DataFrame({"time": index, "x_m": X}))
        assert column.fs == pytest.approx(FS)
    said = from_data(pandas.DataFrame({"x_m": X, "z": X + 1j, "remark": "none"}), fs=FS)
    noted = said.notes[0]  # pandas 3 has a kind of its own for texts
    assert "'z' (complex numbers), 'remark' (objects" in noted or "'z' (complex numbers), 'remark' (text" in noted

"""What programs hold in memory gives the same recording as a file."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import from_data

FS = 1000.0
T = np.arange(2000) / FS
X = 5e-3 * np.exp(-2.5 * T) * np.cos(2 * np.pi * 12.67 * T)
F = np.sin(2 * np.pi * (5 + 3 * T) * T)


def same(recording):
    assert recording.fs == pytest.approx(FS, rel=1e-9)
    np.testing.assert_allclose(recording.response, X, rtol=0, atol=1e-15)
    np.testing.assert_allclose(recording.force, F, rtol=0, atol=1e-12)
    assert recording.unit == "m"


def test_arrays_and_sep5():
    same(from_data({"fs": FS, "force_N": F, "x_mm": 1e3 * X}))
    force = {"data": F, "fs": FS, "name": "force", "unit_str": "N"}
    same(from_data([force, {"data": 1e3 * X, "fs": FS, "name": "disp", "unit_str": "mm"}]))
    same(from_data([{**force, "time": T, "fs": None}, {"data": X, "name": "disp", "unit_str": "m"}]))
    same(from_data(from_data({"fs": FS, "force_N": F, "x_m": X}).to_sep5(), force="*:force"))


def test_pandas():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"force_N": F, "x_mm": 1e3 * X, "remark": "none"})
    same(from_data(frame, fs=FS))
    same(from_data(frame.set_index(pandas.Index(T, name="time_s"))))
    same(from_data(frame.set_index(pandas.to_datetime(T, unit="s"))))


def test_xarray():
    xarray = pytest.importorskip("xarray")
    force = xarray.DataArray(F, {"time": T}, ["time"], attrs={"units": "N"})
    disp = xarray.DataArray(1e3 * X, {"time": T}, ["time"], attrs={"units": "mm"})
    same(from_data(xarray.Dataset({"force": force, "disp": disp})))


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (5, "int is no kind of recording"),
        ({}, "no vector of numbers"),
        ({"x": ["a", "b"]}, r"holds no real numbers: 'x' \(text\); give arrays of numbers by name"),
        ({"x": np.array(["a", None], object)}, r"'x' \(objects that are no numbers\)"),
        (
            {"time_s": T, "x_m": X[:-3]},
            r"name it with --response \(the record has \d+ samples; 'x_m' \(\d+\), of other",
        ),
        ({"fs": -1.0, "x_m": X}, "'fs' is -1, which is no sampling rate"),
        ({"fs": FS, "a": {"x_m": X}, "b": {"x_m": X}}, "holds 2 records, a, b"),
        ([{"data": X, "fs": 1.0, "name": "a"}, {"data": X, "fs": 2.0, "name": "b"}], r"the rates \[1\.0, 2\.0\] Hz"),
        ([{"data": X, "fs": 1.0, "name": "a"}, {"data": X[1:], "fs": 1.0, "name": "b"}], "vectors of one length"),
    ],
)
def test_what_is_none_is_said(data, says):
    with pytest.raises(BadInput, match=says):
        from_data(data)


def test_names_of_bytes_are_read_as_text_for_a_unit_stands_in_them():
    same(from_data({b"time_s": T, b"force_N": F, b"x_mm": 1e3 * X}))


def test_text_in_a_frame_is_called_so():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"time_s": T, "x_m": X})
    with pytest.raises(BadInput, match=r"holds no real numbers: 'time_s' \(text\), 'x_m' \(text\)"):
        from_data(frame.astype("string"))
    with pytest.raises(BadInput, match=r"passed over, as no real numbers: 'x_m' \(text\)"):
        from_data(frame.assign(x_m=frame.x_m.astype(str)))

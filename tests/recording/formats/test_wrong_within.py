"""Files that are whole to their library and wrong within: refused or said, never read without a word."""

from __future__ import annotations

import re
import struct

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.formats import read_tables
from scipy.io import savemat
from scipy.sparse import csc_array

FS, N = 1000.0, 1500
T = np.arange(N) / FS
X = 5e-3 * np.exp(-2.5 * T) * np.cos(2 * np.pi * 12.67 * T)
F = np.sin(2 * np.pi * (5 + 3 * T) * T)


def data_set(values, kind=8, *, declared=None, binary=False, size=None, function=1):
    """A data set 58 of doubles, as text or bytes."""
    declared = values.size if declared is None else declared
    size = 8 * values.size if size is None else size
    head = f"    58b{1:6d}{2:6d}{11:12d}{size:12d}{0:6d}{0:6d}{0:12d}{0:12d}" if binary else "    58"
    axis = f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}"
    ordinate = f"{kind:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}"
    lines = [
        "    -1",
        head,
        *["NONE"] * 5,
        f"{function:5d}{0:10d}{0:5d}{0:10d} {'NONE':10s}{3:10d}{1:4d} {'NONE':10s}{1:10d}{1:4d}",
    ]
    lines += [f"{4:10d}{declared:10d}{1:10d}{0:13.5E}{1 / FS:13.5E}{0:13.5E}", axis, ordinate, axis, axis]
    text = "\n".join(lines) + "\n"
    if binary:
        return text.encode() + values.astype("<f8").tobytes() + b"\n    -1\n"
    rows = ("".join(f"{v:20.12E}" for v in values[i : i + 4]) for i in range(0, values.size, 4))
    return (text + "\n".join(rows) + "\n    -1\n").encode()


@pytest.fixture
def universal():
    pytest.importorskip("pyuff")
    return lambda content: read_tables("rec.uff", content, 50.0)


@pytest.mark.parametrize("binary", [False, True])
def test_a_sound_universal_file_is_read(universal, binary):
    (table,) = universal(data_set(X, binary=binary) + data_set(F, 13, binary=binary))
    np.testing.assert_allclose(table.numbers([0, 1]), np.column_stack([X, F]), atol=1e-14)
    assert table.notes == ()


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (data_set(X, declared=N + 1), "data set 1 of kind 58: holds 1500 values and declares 1501"),
        (data_set(X, declared=N - 400), "holds 1500 values and declares 1100"),
        (
            data_set(X) + data_set(F[:-500], 13, declared=N),
            "data set 2 of kind 58: holds 1000 values and decl",
        ),
        (data_set(X, binary=True, declared=N + 1), "holds 1500 values and declares 1501"),
        (data_set(X[:-5], binary=True, declared=N), "holds 1495 values and declares 1500"),
        (data_set(X, binary=True, size=4 * N), "declares 6000 bytes where its 1500 values take 12000"),
        (data_set(X) + data_set(F, 13)[:9000], "is cut short or damaged, a data set in it has no end"),
        (data_set(X)[:-7] + data_set(F, 13), "is cut short or damaged, a data set in it has no end"),
        (data_set(X) + data_set(F, 13)[7:], "is cut short or damaged, a data set in it has no end"),
        (data_set(X)[: len(data_set(X)) * 2 // 3].rpartition(b"\n")[0] + b"\n    -1\n", "values and declares 1500"),
    ],
)
def test_a_universal_file_that_declares_something_else_is_refused(universal, content, says):
    with pytest.raises(BadInput, match=says):
        universal(content)


def test_data_sets_that_are_no_time_histories_are_said(universal):
    (table,) = universal(data_set(X) + data_set(F, 0, function=4))
    assert len(table.names) == 1
    assert "passed over, as no real numbers: 'channel 3+X' (function type 4)" in table.notes[0]


def test_a_sparse_matrix_of_a_mat_file_is_no_record(tmp_path):
    savemat(tmp_path / "rec.mat", {"fs": FS, "x_m": csc_array(np.atleast_2d(X))})
    with pytest.raises(BadInput, match="'x_m' is a sparse matrix, which no record is"):
        read(tmp_path / "rec.mat")


def test_a_mat_file_with_two_rates_is_refused(tmp_path):
    savemat(tmp_path / "rec.mat", {"fs": FS, "dt": 0.01, "x_m": X})
    with pytest.raises(BadInput, match="states several sampling rates: 'fs' 1000 Hz, 'dt' 100 Hz"):
        read(tmp_path / "rec.mat")
    savemat(tmp_path / "rec.mat", {"fs": FS, "dt": 0.001, "x_m": X, "z": X + 1j * X})
    recording = read(tmp_path / "rec.mat")
    assert recording.fs == FS
    assert any("passed over, as no real numbers: 'z' (complex numbers)" in note for note in recording.notes)


def test_hdf5_with_two_rates_is_refused_and_complex_is_said(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "rec.h5", "w") as file:
        file.create_dataset("x_m", data=X).attrs["fs"] = FS
        file.create_dataset("force_N", data=F).attrs["fs"] = 2 * FS
    with pytest.raises(BadInput, match="'x_m' states another fs than what lies beside it"):
        read(tmp_path / "rec.h5")
    with h5py.File(tmp_path / "rec.h5", "w") as file:
        file.create_dataset("x_m", data=X).attrs["fs"] = FS
        file.create_dataset("z", data=X + 1j)
        file.create_dataset("on", data=X > 0)
    notes = read(tmp_path / "rec.h5").notes
    assert any("'on' (yes or no), 'z' (complex numbers)" in note for note in notes)


@pytest.mark.parametrize(
    ("properties", "refused"),
    [
        ({"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Exotic"}, True),
        ({"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "AdvancedAPI"}, True),
        ({"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Exotic", "NI_Scaling_Status": "scaled"}, False),
        ({"NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear", "NI_Scale[0]_Linear_Slope": 1.0,
          "NI_Scale[0]_Linear_Y_Intercept": 0.0, "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF}, False),
    ],
)  # fmt: skip
def test_a_scale_of_tdms_that_is_not_known_is_refused(tmp_path, properties, refused):
    nptdms = pytest.importorskip("nptdms")
    told = {"unit_string": "m", "wf_increment": 1 / FS, **properties}
    with nptdms.TdmsWriter(str(tmp_path / "rec.tdms")) as file:
        file.write_segment([nptdms.ChannelObject("run", "x", X, told)])
    if refused:
        with pytest.raises(BadInput, match=r"the channel 'x' has a scale of the kind '\w+', which cannot be applied"):
            read(tmp_path / "rec.tdms")
    else:
        np.testing.assert_allclose(read(tmp_path / "rec.tdms").response, X, atol=1e-15)


@pytest.mark.parametrize("state", ["hidden", "veryHidden"])
def test_a_hidden_sheet_is_said(tmp_path, state):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet, remarks = book.active, book.create_sheet("shown")
    sheet.title, sheet.sheet_state = "secret", state
    remarks.append(["nothing here"])
    sheet.append(["time_s", "x_m"])
    for row in zip(T.tolist(), X.tolist(), strict=True):
        sheet.append(row)
    book.save(tmp_path / "rec.xlsx")
    (table,) = read_tables("rec.xlsx", (tmp_path / "rec.xlsx").read_bytes(), 50.0)
    assert any("the sheet 'secret' is hidden in the workbook" in note for note in table.notes)


def wav(counts, width, bits=None):
    """A WAV file of one channel with samples of so many bytes."""
    body = b"".join(int(c).to_bytes(width, "little", signed=True) for c in counts)
    form = struct.pack("<HHIIHH", 1, 1, int(FS), int(FS) * width, width, bits or 8 * width)
    chunks = b"LIST" + struct.pack("<I", 3) + b"abc\0" + b"fmt " + struct.pack("<I", 16) + form
    chunks += b"data" + struct.pack("<I", len(body)) + body
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


@pytest.mark.parametrize("width", [2, 3, 4])
def test_counts_of_wav_are_as_they_are_stored(width):
    counts = np.round(X / X.max() * (2 ** (8 * width - 1) - 1)).astype(np.int64)
    (table,) = read_tables("rec.wav", wav(counts, width), 50.0)
    np.testing.assert_array_equal(table.numbers([0])[:, 0], counts)
    assert f"full scale {2 ** (8 * width - 1)}" in table.notes[0]


def test_parquet_says_what_it_passes_over_and_reads_decimals_and_times(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    import datetime
    import decimal

    from pyarrow import parquet

    begin = datetime.datetime(2024, 5, 1, tzinfo=datetime.UTC)
    times = pyarrow.array([begin + datetime.timedelta(seconds=t) for t in T.tolist()], pyarrow.timestamp("us", "CET"))
    values = pyarrow.array([decimal.Decimal(f"{x:.12f}") for x in X.tolist()], pyarrow.decimal128(20, 12))
    whole = pyarrow.array([None if i == 700 else round(x * 1e9) for i, x in enumerate(X.tolist())], pyarrow.int64())
    table = pyarrow.table({"time": times, "x_m": values, "y": whole, "note": ["a"] * N, "on": (X > 0).tolist()})
    parquet.write_table(table, tmp_path / "rec.parquet")
    recording = read(tmp_path / "rec.parquet", response="x_m")
    assert recording.fs == pytest.approx(FS)
    np.testing.assert_allclose(recording.response, X, atol=1e-12)
    assert any("'note' (text), 'on' (yes or no)" in note for note in recording.notes)
    bridged = read(tmp_path / "rec.parquet", response="y", unit="nm")
    np.testing.assert_allclose(bridged.response, X, atol=1e-8)
    assert any(re.search("missing", note) for note in bridged.notes)


def test_a_force_of_another_length_is_not_left_out_unasked(tmp_path):
    """Without it, what it drives would be taken for free motion."""
    savemat(tmp_path / "a.mat", {"fs": FS, "force_N": F[:-100], "x_m": X, "temperature": np.ones(5)})
    with pytest.raises(BadInput, match="the force 'force_N' has 1400 samples, another number than the record"):
        read(tmp_path / "a.mat")
    assert read(tmp_path / "a.mat", force="none").force is None


def test_what_python_says_of_a_parser_is_not_told(tmp_path):
    """A WAV file of which a chunk of an odd size is not padded has no chunk of data any more, for its parser."""
    data = X.astype("<f4").tobytes()
    head = struct.pack("<4sIHHIIHH", b"fmt ", 16, 3, 1, 1000, 4000, 4, 32)
    body = b"WAVE" + head + b"LIST" + struct.pack("<I", 5) + b"INFOx" + b"data" + struct.pack("<I", len(data)) + data
    (tmp_path / "a.wav").write_bytes(b"RIFF" + struct.pack("<I", len(body)) + body)
    with pytest.raises(BadInput, match=r"a\.wav cannot be read as WAV: it is damaged, cut short or of another kind"):
        read(tmp_path / "a.wav")


def test_stamps_of_a_universal_file_that_are_uneven_are_its_time(tmp_path):
    pyuff = pytest.importorskip("pyuff")
    stamps = T + 2e-5 * np.sin(9 * T)
    told = {"data": X, "x": stamps, "abscissa_spacing": 0, "ordinate_spec_data_type": 8, "func_type": 1, "binary": 0}
    names = {"rsp_node": 1, "rsp_dir": 1, "ref_node": 1, "ref_dir": 1, "id1": "NONE", "rsp_ent_name": "NONE"}
    kinds = {"ref_ent_name": "NONE", "abscissa_spec_data_type": 17, "orddenom_spec_data_type": 0}
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets([pyuff.prepare_58(**told, **names, **kinds)], "overwrite")
    recording = read(tmp_path / "a.uff")
    assert recording.fs == pytest.approx(FS, rel=1e-4)  # the stamps have six digits
    np.testing.assert_allclose(recording.response, np.interp(recording.time, stamps, X), atol=1e-5)

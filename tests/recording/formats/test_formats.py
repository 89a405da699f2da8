"""The same decay in every kind of file is the same recording; what is damaged, hostile or too large is one sentence."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read, read_records
from dashpot.recording.formats import FORMATS, read_tables
from scipy.io import savemat, wavfile

FS, N = 1000.0, 2000
T = np.arange(N) / FS
X = 5e-3 * np.exp(-2.5 * T) * np.cos(2 * np.pi * 12.67 * T)
F = np.sin(2 * np.pi * (5 + 3 * T) * T)


def mat(path):
    savemat(path, {"time_s": T, "force_N": F, "x_mm": 1e3 * X, "serial": [4, 7, 1.0]})


def packed_mat(path):
    savemat(path, {"fs": FS, "force_N": F, "x_mm": 1e3 * X}, do_compression=True)


def npz(path):
    np.savez(path, dt=1 / FS, force_N=F, x_mm=1e3 * X)


def hdf5(path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        file.attrs["fs"] = FS
        for name, values, unit in (("force", F, "N"), ("disp", 1e3 * X, "mm")):
            file.create_dataset(name, data=values, compression="gzip").attrs["units"] = unit


def tdms(path):
    nptdms = pytest.importorskip("nptdms")
    with nptdms.TdmsWriter(str(path)) as file:
        file.write_segment(
            [
                nptdms.ChannelObject("run", name, values, {"unit_string": unit, "wf_increment": 1 / FS})
                for name, values, unit in (("force", F, "N"), ("disp", 1e3 * X, "mm"))
            ]
        )


def excel(path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    for row in (["Logger 12"], ["Serial", 4711], ["Time", "Force", "Displacement"], ["s", "N", "mm"]):
        sheet.append(row)
    for row in zip(T.tolist(), F.tolist(), (1e3 * X).tolist(), strict=True):
        sheet.append(row)
    book.save(path)


def uff(path):
    pyuff = pytest.importorskip("pyuff")
    path.write_bytes(b"")
    file = pyuff.UFF(str(path))
    texts = ("id1", "id2", "id3", "id4", "id5", "rsp_ent_name", "ref_ent_name")
    axes = ("abscissa", "ordinate", "orddenom", "z_axis")
    whole = {"ver_num": 0, "load_case_id": 0, "ref_node": 1, "ref_dir": 1, "abscissa_min": 0.0, "z_axis_value": 0.0}
    whole |= dict.fromkeys(texts, "NONE") | {f"{axis}_axis_units_lab": "NONE" for axis in axes}
    whole |= {f"{axis}_{what}_unit_exp": 0 for axis in axes for what in ("len", "force", "temp")}
    whole |= {f"{axis}_spec_data_type": 0 for axis in axes}
    for kind, values in ((13, F), (8, X)):
        told = whole | {"func_type": 1, "rsp_node": 3, "rsp_dir": 1, "ordinate_spec_data_type": kind, "num_pts": N}
        told |= {"data": values, "x": T, "ord_data_type": 4, "abscissa_inc": 1 / FS, "abscissa_spacing": 1, "binary": 0}
        file._write_set(pyuff.prepare_58(**told), "add")


def parquet(path):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet as writer

    writer.write_table(pyarrow.table({"time_s": T, "force_N": F, "x_mm": 1e3 * X}), path)


def lvm_text(sign=".", times=True, blocks=1):
    """What LabVIEW writes: headers, a column of times or an empty one, remarks behind the last channel."""
    about = ["LabVIEW Measurement", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab"]
    about += [f"Decimal_Separator\t{sign}", f"X_Columns\t{'One' if times else 'No'}", "***End_of_Header***"]
    rows = [f"{t!r}\t{f!r}\t{x!r}" for t, f, x in zip(T.tolist(), F.tolist(), (1e3 * X).tolist(), strict=True)]
    rows = rows if times else ["\t" + row.partition("\t")[2] for row in rows]
    head = ["Channels\t2", f"Samples\t{N}\t{N}", "Y_Unit_Label\tN\tmm", f"Delta_X\t{1 / FS!r}\t{1 / FS!r}"]
    names = "X_Value\tforce\tdisp\tComment"
    block = ["", *head, "***End_of_Header***", names, *(row.replace(".", sign) for row in rows)]
    return "\r\n".join([*about, *(blocks * block)]) + "\r\n"


def lvm(path):
    pytest.importorskip("lvm_read")
    path.write_bytes(lvm_text().encode())


def xls(path):
    """A workbook of the oldest kind (BIFF2), which is a row of records: its beginning, texts, numbers, its end."""
    pytest.importorskip("xlrd")
    made = struct.pack("<4H", 0x0009, 4, 0x0200, 0x0010)
    for column, name in enumerate((b"Time (s)", b"Force (N)", b"x (mm)")):
        made += struct.pack("<4H3xB", 0x0004, 8 + len(name), 0, column, len(name)) + name
    for row, cells in enumerate(zip(T.tolist(), F.tolist(), (1e3 * X).tolist(), strict=True), start=1):
        made += b"".join(struct.pack("<4H3xd", 0x0003, 15, row, column, cell) for column, cell in enumerate(cells))
    path.write_bytes(made + struct.pack("<2H", 0x000A, 0))


def zipped(path):
    rows = "\n".join(f"{t!r};{f!r};{x!r}" for t, f, x in zip(T.tolist(), F.tolist(), (1e3 * X).tolist(), strict=True))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Raw Data.csv", f'"Time (s)";"Force (N)";"x (mm)"\n{rows}\n')
        archive.writestr("meta/time.csv", '"event";"experiment time"\n"START";0.0\n"PAUSE";2.0\n')


def mcap(path):
    """Messages in JSON, in a compressed chunk, as programs write them that are no robots."""
    writer = pytest.importorskip("mcap.writer")
    with path.open("wb") as file:
        made = writer.Writer(file)
        made.start()
        schema = made.register_schema("Rig", "jsonschema", b'{"type": "object"}')
        channel = made.register_channel("rig", "json", schema)
        for i, (f, x) in enumerate(zip(F.tolist(), (1e3 * X).tolist(), strict=True)):
            data = f'{{"force_N": {f!r}, "x_mm": {x!r}, "serial": "A-12"}}'.encode()
            made.add_message(channel, i * 1_000_000 + 1_700_000_000_000_000_000, data, 0)
        made.finish()


def ros_bag(path):
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg("float64 force\nfloat64 x", "rig/msg/State"))
    kind, folder = store.types["rig/msg/State"], path.with_suffix(".folder")
    with rosbag2.Writer(folder, version=9, storage_plugin=rosbag2.StoragePlugin.SQLITE3) as bag:
        topic = bag.add_connection("/rig", kind.__msgtype__, typestore=store)
        for i, (f, x) in enumerate(zip(F.tolist(), X.tolist(), strict=True)):
            bag.write(
                topic, 1_700_000_000_000_000_000 + i * 1_000_000, store.serialize_cdr(kind(f, x), kind.__msgtype__)
            )
    (database,) = folder.glob("*.db3")
    path.write_bytes(database.read_bytes())


def mdf(path):
    asammdf = pytest.importorskip("asammdf", reason="it brings pandas, so that the environment of tests is without it")
    with asammdf.MDF() as file:
        file.append([asammdf.Signal(F, T, "N", "force"), asammdf.Signal(1e3 * X, T, "mm", "disp")])
        file.save(path)


WRITERS = {
    "rec.lvm": lvm,
    "rec.mat": mat,
    "packed.mat": packed_mat,
    "rec.npz": npz,
    "rec.h5": hdf5,
    "rec.tdms": tdms,
    "rec.xlsx": excel,
    "rec.uff": uff,
    "rec.parquet": parquet,
    "rec.xls": xls,
    "rec.zip": zipped,
    "rec.mcap": mcap,
    "rec.db3": ros_bag,
    "rec.mf4": mdf,
}


#: Kinds whose tests wait for large libraries, or make many messages.
DEAR = ("rec.xls", "rec.mcap", "rec.db3", "rec.mf4")
KINDS = [pytest.param(name, marks=pytest.mark.long) if name in DEAR else name for name in WRITERS]


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """``written(name)``: the file of that name, made once."""
    folder = tmp_path_factory.mktemp("files")

    def make(name):
        path = folder / name
        if not path.exists():
            WRITERS[name](path)
        return path

    return make


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_of_file_gives_what_the_csv_gives(written, name, tmp_path):
    rows = "\n".join(f"{t!r},{f!r},{x!r}" for t, f, x in zip(T.tolist(), F.tolist(), (1e3 * X).tolist(), strict=True))
    (tmp_path / "rec.csv").write_text(f"time_s,force_N,x_mm\n{rows}\n")
    expected, recording = read(tmp_path / "rec.csv"), read(written(name))
    assert recording.fs == pytest.approx(expected.fs, rel=1e-9)
    assert (recording.n, recording.quantity, recording.unit) == (N, "displacement", "m")
    assert (recording.name.partition("#")[0], recording.force_unit) == (name, "N")
    digits = 1e-6 if name == "rec.uff" else 1e-12  # a universal file as text has single precision here
    np.testing.assert_allclose(recording.response, expected.response, rtol=0, atol=5e-3 * digits)
    assert recording.force is not None
    np.testing.assert_allclose(recording.force, expected.force, rtol=0, atol=digits)
    assert any("'serial' (3)" in note for note in recording.notes) == (name == "rec.mat")


def test_the_table_of_formats_is_what_is_tested():
    tested = {f".{name.rpartition('.')[2]}" for name in WRITERS} | {".wav"}
    assert {FORMATS[suffix].module for suffix in tested} | {"delimited"} == {kind.module for kind in FORMATS.values()}


@pytest.mark.parametrize(("sign", "times"), [(",", True), (".", False)])
def test_a_labview_measurement_has_times_or_an_interval(tmp_path, sign, times):
    pytest.importorskip("lvm_read")
    (tmp_path / "rec.lvm").write_text(lvm_text(sign, times).replace("Delta_X", f"X0\t0{sign}0\nDelta_X"))
    recording = read(tmp_path / "rec.lvm")
    assert (recording.fs, recording.n, recording.unit) == (pytest.approx(FS, rel=1e-9), N, "m")
    np.testing.assert_allclose(recording.response, X, rtol=0, atol=1e-12)


def test_each_block_of_a_labview_measurement_is_a_record(tmp_path):
    pytest.importorskip("lvm_read")
    (tmp_path / "rec.lvm").write_text(lvm_text(blocks=2))
    with pytest.raises(BadInput, match=r"block1.*block2"):
        read(tmp_path / "rec.lvm")
    np.testing.assert_allclose(read(f"{tmp_path / 'rec.lvm'}#block2").response, X, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"), [("time_s,x_m\n0,1\n", "is no LabVIEW measurement"), (lvm_text()[:150], "cannot be read as LVM")]
)
def test_what_is_no_labview_measurement_is_refused(tmp_path, text, words):
    pytest.importorskip("lvm_read")
    (tmp_path / "rec.lvm").write_text(text)
    with pytest.raises(BadInput, match=words):
        read(tmp_path / "rec.lvm")


def test_a_wav_file_is_in_counts_until_it_is_calibrated(tmp_path):
    counts = np.round(np.column_stack([1e4 * F, 4e6 * X])).astype(np.int16)
    wavfile.write(tmp_path / "rec.wav", int(FS), counts)
    with pytest.raises(BadInput, match=r"no names for its 2 columns; .* e\.g\. --force 1 --response 2"):
        read(tmp_path / "rec.wav")
    factors = {"force": "2e-4 N/counts", "response": "4000 counts/mm"}
    recording = read(tmp_path / "rec.wav", force=1, response=2, calibration=factors)
    assert (recording.fs, recording.unit, recording.force_unit) == (FS, "m", "N")
    np.testing.assert_allclose(recording.response, counts[:, 1] / 4000e3, rtol=1e-12)
    np.testing.assert_allclose(recording.force, counts[:, 0] * 2e-4, rtol=1e-12)
    assert any("full scale 32768" in note for note in recording.notes)


def test_a_file_of_several_records(tmp_path):
    path = tmp_path / "runs.mat"
    savemat(path, {"fs": FS, "low": {"x_mm": X * 1e3}, "high": {"x_mm": X * 2e3}})
    low, high = read_records(path)
    assert (low.name, high.name) == ("runs.mat#low", "runs.mat#high")
    np.testing.assert_allclose(2 * low.response, high.response, rtol=1e-12)
    for address in ("runs.mat#high", "runs.mat#2"):
        np.testing.assert_array_equal(read(tmp_path / address).response, high.response)
    with pytest.raises(BadInput, match=r"holds 2 records, low, high; name one: runs\.mat#low"):
        read(path)
    with pytest.raises(BadInput, match=r"no record 'hihg'; did you mean 'high'"):
        read(tmp_path / "runs.mat#hihg")


def test_version_7_3_of_mat_is_hdf5(written, tmp_path):
    (tmp_path / "rec.mat").write_bytes(written("rec.h5").read_bytes())
    np.testing.assert_allclose(read(tmp_path / "rec.mat").response, X, atol=1e-15)


def test_a_missing_package_is_named_with_its_extra(monkeypatch, tmp_path):
    def absent(*_):
        raise ModuleNotFoundError("No module named 'nptdms'", name="nptdms")

    monkeypatch.setattr("dashpot.recording.formats.read_apart", absent)
    (tmp_path / "rec.tdms").write_bytes(b"TDSm")
    with pytest.raises(BadInput, match=r"TDMS need nptdms, which is not installed; pip install 'dashpot\[tdms\]'"):
        read(tmp_path / "rec.tdms")


def test_a_labview_measurement_that_was_cut_is_read_as_far_as_it_goes(tmp_path):
    pytest.importorskip("lvm_read")
    text = lvm_text()
    (tmp_path / "rec.lvm").write_text(text[: text.index("\r\n", len(text) // 2)])
    recording = read(tmp_path / "rec.lvm", checked=False)
    assert recording.n < N
    assert f"{recording.n} of the {N} samples are there that its header states" in " ".join(recording.notes)


@pytest.mark.parametrize("name", [name for name in KINDS if name != "rec.lvm"])
def test_a_file_cut_short_is_one_sentence(written, name):
    content = written(name).read_bytes()
    with pytest.raises(BadInput, match=name) as caught:
        read_tables(name, content[: len(content) // 3], 50.0)
    assert "\n" not in str(caught.value)


def bomb_npz() -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x.npy", bytes(20_000_000))
    return out.getvalue()


def bomb_mat() -> bytes:
    packed = zlib.compress(bytes(20_000_000))
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\0\1IM" + struct.pack("<II", 15, len(packed)) + packed


def vast_npz() -> bytes:
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }"
    head = b"\x93NUMPY\1\0" + struct.pack("<H", len(header) + 1) + header + b"\n"
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr("x.npy", head + bytes(80))
    return out.getvalue()


def pickled_npz() -> bytes:
    out = io.BytesIO()
    np.savez(out, x=np.array([{"a": 1}], object))
    return out.getvalue()


def cut_wav() -> bytes:
    out = io.BytesIO()
    wavfile.write(out, 1000, np.arange(1000, dtype=np.int16))
    return out.getvalue()[:900]


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("rec.npz", bomb_npz(), "holds more than 10 MB"),
        ("rec.xlsx", bomb_npz(), "holds more than 10 MB"),
        ("rec.mat", bomb_mat(), "holds more than 10 MB"),
        ("rec.npz", vast_npz(), "holds more than 10 MB"),
        ("rec.npz", pickled_npz(), "'x' holds pickled Python objects, which are programs and never loaded"),
        ("rec.wav", cut_wav(), "cut short, 900 of 2044 bytes"),
        ("rec.wav", b"time_s,x_m\n0,1\n", "is no WAV file"),
        ("rec.npz", b"time_s,x_m\n0,1\n", "cannot be read as NPZ"),
        ("rec.mat", b"time_s,x_m\n0,1\n" * 99, "cannot be read as MAT"),
        ("rec.h5", b"time_s,x_m\n0,1\n", "cannot be read as HDF5"),
        ("rec.tdms", b"", "is empty"),
    ],
)
def test_what_is_hostile_is_one_sentence(name, content, says):
    with pytest.raises(BadInput, match=says) as caught:
        read_tables(name, content, 10.0)
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(name)

"""Topics of bags as records: what was measured when, in which unit, by the types of the messages."""

from __future__ import annotations

import io

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.recording import read
from dashpot.recording.formats import mcap, read_tables
from dashpot.recording.formats.messages import tables_of_messages

FS, N = 500.0, 400
T = np.arange(N) / FS
A = 4.0 * np.exp(-2.0 * T) * np.cos(2 * np.pi * 11.0 * T)
F = np.sin(2 * np.pi * (6.0 + 8.0 * T) * T)
EPOCH = 1_700_000_000_000_000_000
STEP = round(1e9 / FS)


@pytest.fixture(scope="module", params=["mcap", pytest.param("db3", marks=pytest.mark.long)])
def bag(request, tmp_path_factory):
    """A folder as ``ros2 bag record`` leaves it: an inertial unit and a force, and joints whose clock is another."""
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    from rosbags.typesys import Stores, get_typestore

    plugins = {"mcap": rosbag2.StoragePlugin.MCAP, "db3": rosbag2.StoragePlugin.SQLITE3}
    store = get_typestore(Stores.ROS2_HUMBLE)
    made = {name.rpartition("/")[2]: kind for name, kind in store.types.items()}
    dice = np.random.default_rng(0)
    folder = tmp_path_factory.mktemp("bags") / "swing"
    with rosbag2.Writer(folder, version=9, storage_plugin=plugins[request.param]) as file:
        topics = {
            name: file.add_connection(name, f"{package}/msg/{kind}", typestore=store)
            for name, package, kind in (
                ("/imu", "sensor_msgs", "Imu"),
                ("/wrench", "geometry_msgs", "WrenchStamped"),
                ("/joint_states", "sensor_msgs", "JointState"),
                ("/log", "std_msgs", "String"),
            )
        }

        def write(topic, when, message):
            file.write(topics[topic], when, store.serialize_cdr(message, message.__msgtype__))

        zero, none = np.zeros(9), np.zeros(0)
        vector, turn = made["Vector3"], made["Quaternion"]
        for i, (a, f) in enumerate(zip(A.tolist(), F.tolist(), strict=True)):
            when = EPOCH + i * STEP
            late = when + int(dice.integers(1000, 900_000))  # when it was written
            header = made["Header"](made["Time"](when // 10**9, when % 10**9), "base")
            still, force = vector(0.0, 0.0, 0.0), vector(0.0, f, 0.0)
            write(
                "/imu",
                late,
                made["Imu"](header, turn(0.0, 0.0, 0.0, 1.0), zero, still, zero, vector(a, 0.0, 9.8), zero),
            )
            write("/wrench", late + 1, made["WrenchStamped"](header, made["Wrench"](force, still)))
            if i % 2 == 0:
                position = np.array([0.1 * a, -a])
                joints = made["JointState"](header, ["shoulder", "elbow"], position, none, none)
                write("/joint_states", late + 2, joints)
            write("/log", late + 3, made["String"]("all is well"))
    return folder


def test_topics_of_one_clock_are_one_record(bag):
    record = read(f"{bag}#/imu", response="/imu linear_acceleration x", force="*force y")
    np.testing.assert_array_equal(record.response, A)
    np.testing.assert_array_equal(record.force, F)
    assert (record.unit, record.force_unit, record.fs) == ("m/s2", "N", pytest.approx(FS, rel=1e-9))


def test_joints_are_called_by_their_names(bag):
    record = read(f"{bag}#/joint_states", response="position elbow", unit="rad")
    np.testing.assert_allclose(record.response, -A[::2], rtol=0, atol=0)
    assert (record.unit, record.fs) == ("rad", pytest.approx(FS / 2, rel=1e-9))


def test_a_bag_of_several_files_asks_which(bag):
    other = bag.parent / "split"
    other.mkdir(exist_ok=True)
    for name in ("metadata.yaml", "split_0.mcap", "split_1.mcap"):
        (other / name).write_bytes(b"")
    with pytest.raises(BadInput, match=r"is a bag of 2 files; name those that are meant, such as .*split_0\.mcap"):
        read(other)


def written(encoding, *payloads):
    """The bytes of an MCAP file with one topic."""
    writer = pytest.importorskip("mcap.writer")
    out = io.BytesIO()
    made = writer.Writer(out)
    made.start()
    channel = made.register_channel("rig", encoding, 0)
    for i, data in enumerate(payloads):
        made.add_message(channel, EPOCH + i * STEP, data, 0)
    made.finish()
    return out.getvalue()


def test_an_encoding_that_is_not_read_is_named():
    with pytest.raises(BadInput, match=r"its messages \(rig and others\) are encoded as protobuf; .* export the topic"):
        mcap.read_tables("rec.mcap", written("protobuf", b"\x08\x01", b"\x08\x02"), 10.0)


def test_messages_that_are_no_json_are_one_sentence():
    with pytest.raises(BadInput, match=r"rec\.mcap cannot be read as MCAP") as caught:
        read_tables("rec.mcap", written("json", b"{", b"}"), 10.0)
    assert "\n" not in str(caught.value)


def test_a_field_that_comes_and_goes_is_missing_meanwhile():
    messages = [("rig", i, {"x_mm": float(i)} | ({"force_N": 2.0} if i != 1 else {})) for i in range(3)]
    (table,) = tables_of_messages("rec", messages, 1.0)
    assert table.names == ("time", "x_mm", "force_N")
    np.testing.assert_array_equal(table.numbers([1, 2]), [[0.0, 2.0], [1.0, np.nan], [2.0, 2.0]])


def test_a_message_may_bear_its_own_time():
    messages = [("rig", i, {"t": 0.5 * i, "x": [1.0, 2.0 * i], "on": True, "name": "a"}) for i in range(3)]
    (table,) = tables_of_messages("rec", messages, 1.0)
    assert table.names == ("t", "x 1", "x 2")
    stamped = [("rig", 7 * i, {"stamp": {"sec": i, "nsec": 500_000_000}, "x": 1.0 * i}) for i in range(3)]
    (table,) = tables_of_messages("rec", stamped, 1.0)
    np.testing.assert_array_equal(table.numbers([0])[:, 0], [0.0, 1.0, 2.0])


def test_more_numbers_than_fit_are_refused():
    with pytest.raises(BadInput, match=r"holds more than 0\.001 MB"):
        tables_of_messages("rec", ((str(i), i, {"x": 1.0}) for i in range(1000)), 1e-3)


def test_any_bytes_of_a_bag_are_tables_or_a_sentence(every, unless_refused, bag):
    """What a damaged file holds, but for its own process: one a file would take half a second each."""
    from importlib import import_module

    from hypothesis import strategies as st

    content = next(bag.glob("swing.*")).read_bytes()
    module = import_module(f"dashpot.recording.formats.{'mcap' if content[1:5] == b'MCAP' else 'bag'}")

    def holds(given):
        place, piece = given
        at = int(place * len(content))
        broken = content[:at] + piece + content[at + len(piece) :]
        try:
            tables = module.read_tables("rec", broken, 50.0)
        except Exception:  # which the reading apart makes a sentence of
            return
        assert all(len(table.names) == len(table.units) for table in tables)

    every(st.tuples(st.floats(0, 1), st.binary(min_size=1, max_size=40)), holds, 3)

"""Bags of ROS in files of their own, .db3 of ROS 2 and .bag of ROS 1: each topic is a record."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...errors import BadInput
from ..table import Table
from .messages import tables_of_messages

#: The file in a folder that makes it a bag of ROS 2, and the kinds of files that then hold the messages.
METADATA, STORAGES = "metadata.yaml", (".mcap", ".db3")


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a bag; the definitions of its messages are those in it or, in older ones, those of ROS.

    Raises:
        BadInput: it holds more than ``most`` MB.
        ModuleNotFoundError: without rosbags.
    """
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"bag{'.bag' if content.startswith(b'#ROSBAG') else '.db3'}"
        path.write_bytes(content)
        with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:

            def messages() -> Iterator[tuple[str, int, Any]]:
                for connection, time, raw in reader.messages():
                    if connection.msgtype in reader.typestore.fielddefs:  # of others nobody knows what they hold
                        yield connection.topic, time, reader.deserialize(raw, connection.msgtype)

            return tables_of_messages(where, messages(), most)


def storage_of(folder: Path) -> Path:
    """The one file of a ROS 2 bag that holds its messages, or the path as it is where it is no such folder.

    Raises:
        BadInput: there are several, as where a long recording was split.
    """
    try:
        if not (folder.is_dir() and (folder / METADATA).is_file()):
            return folder
        found = sorted(path for path in folder.iterdir() if path.suffix in STORAGES)
    except (OSError, ValueError):  # which the reading of it says
        return folder
    if len(found) > 1:
        raise BadInput(f"{folder} is a bag of {len(found)} files; name those that are meant, such as {found[0]}")
    return found[0] if found else folder

"""MCAP files: each topic is a record; messages of ROS, by the definitions in the file, and such as JSON."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from typing import Any

from ...errors import BadInput
from ..table import Table
from .messages import tables_of_messages

_READ = "cdr (ROS 2), ros1 and json"


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a file, by topic; topics of which no message can be read are named.

    Raises:
        BadInput: it holds more than ``most`` MB, or all its messages are of an encoding that is not read.
        ModuleNotFoundError: without mcap or, where messages are of ROS, rosbags.
    """
    from mcap.reader import make_reader

    unread: dict[str, str] = {}

    def messages() -> Iterator[tuple[str, int, Any]]:
        readers: dict[int, Callable[[bytes], Any] | None] = {}
        reader = make_reader(io.BytesIO(content), validate_crcs=True)
        for schema, channel, message in reader.iter_messages():
            if channel.id not in readers:
                readers[channel.id] = _reader_of(channel.message_encoding, schema)
            if (read := readers[channel.id]) is None:
                unread[channel.topic] = channel.message_encoding
            else:
                yield channel.topic, message.log_time, read(message.data)

    tables = tables_of_messages(where, messages(), most)
    if not tables and unread:
        topic, encoding = next(iter(unread.items()))
        raise BadInput(
            f"{where}: its messages ({topic} and others) are encoded as {encoding[:40] or 'nobody says'}; {_READ} are "
            "read: write it as one of these, or export the topic as CSV"
        )
    return tables


def _reader_of(encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
    """What reads the messages of a channel; None for an encoding that is not read."""
    if encoding == "json":
        return json.loads
    if schema is None or encoding not in ("cdr", "ros1"):
        return None
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    store, text = get_typestore(Stores.EMPTY), schema.data.decode()
    name = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/", 1)
    if schema.encoding in ("ros2msg", "ros1msg"):
        store.register(get_types_from_msg(text, name))
    elif schema.encoding == "ros2idl":
        for part in text.split("=" * 80 + "\n"):  # each behind a line that names it
            if definition := part.partition("\n")[2] if part.startswith("IDL: ") else part.strip():
                store.register(get_types_from_idl(definition))
    else:
        return None
    deserialize = store.deserialize_cdr if encoding == "cdr" else store.deserialize_ros1
    return lambda raw: deserialize(raw, name)

"""Parquet files: a table whose columns are channels."""

from __future__ import annotations

from ..channels import Channel, table_of
from ..content import too_large
from ..table import Table


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The one record of a file; a column's unit is in its name, or in its metadata as `unit` or `units`.

    Raises:
        BadInput: it unpacks to more than ``most`` MB.
        ModuleNotFoundError: without pyarrow.
    """
    import pyarrow  # pyright: ignore[reportMissingImports]
    from pyarrow import parquet  # pyright: ignore[reportMissingImports]

    file = parquet.ParquetFile(pyarrow.BufferReader(content))
    if file.metadata.num_rows * max(file.metadata.num_columns, 1) * 8 > most * 1e6:
        raise too_large(where, most)
    channels = []
    for i, field in enumerate(file.schema_arrow):
        kind = field.type
        if not (pyarrow.types.is_floating(kind) or pyarrow.types.is_integer(kind)):
            continue
        metadata = field.metadata or {}
        unit = (metadata.get(b"unit") or metadata.get(b"units") or b"").decode("utf-8", "replace")
        values = file.read(columns=[field.name]).column(0).to_numpy()
        channels.append(Channel(file.schema_arrow.names[i], values, unit))
    return [table_of(where, channels)] if channels else []

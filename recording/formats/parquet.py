"""Parquet files: a table whose columns are channels."""

from __future__ import annotations

from ..channels import Channel, passed_over, table_of
from ..content import too_large
from ..plain_numbers import numbers_of
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
    channels, passed = [], {}
    for i, field in enumerate(file.schema_arrow):
        name = file.schema_arrow.names[i]
        if pyarrow.types.is_string(field.type) or pyarrow.types.is_large_string(field.type):
            passed[name] = "text"  # which takes more memory than all the numbers
            continue
        metadata = field.metadata or {}
        unit = (metadata.get(b"unit") or metadata.get(b"units") or b"").decode("utf-8", "replace")
        numbers = numbers_of(file.read(columns=[field.name]).column(0).to_numpy())
        if numbers.values is None or numbers.values.ndim != 1:
            passed[name] = numbers.kind or str(field.type)
            continue
        channels.append(Channel(name, numbers.values, unit or numbers.unit))
    return [table_of(where, channels, notes=passed_over(where, passed))] if channels else []

"""Zip archives of text files, as programs of phones export them: each text with numbers is a record."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePosixPath

from ...errors import BadInput
from ..table import Table
from .archive import opened
from .delimited import read_delimited
from .loggers import is_remark

_TEXTS = (".csv", ".txt", ".tsv", ".dat")


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of an archive, by the names of its text files; what is no table beside others is passed over.

    Raises:
        BadInput: it holds more than ``most`` MB, or no text file that is a table.
        zipfile.BadZipFile: it is no archive, or damaged.
    """
    tables, problems = [], []
    with opened(where, content, most) as archive:
        entries = [entry for entry in archive.infolist() if entry.filename.lower().endswith(_TEXTS)]
        for entry in entries:
            if is_remark(entry.filename):
                continue
            record = str(PurePosixPath(entry.filename).with_suffix(""))
            try:
                table = read_delimited(f"{where}#{record}", archive.read(entry), most)
            except BadInput as problem:
                problems.append(problem)
                continue
            tables.append(replace(table, record=record))
    if not tables:
        raise (
            problems[0]
            if problems
            else BadInput(
                f"{where} holds no text file with a table ({', '.join(_TEXTS)}); unpack it, and name what is in it"
            )
        )
    return tables

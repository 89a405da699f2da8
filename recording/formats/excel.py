"""Excel workbooks: each sheet with numbers is a record, read as the text that it would be as CSV."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ...errors import BadInput
from ..content import too_large
from ..table import Table
from .archive import opened
from .delimited import read_delimited
from .loggers import is_remark


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a workbook: headers, units and preambles of its sheets are found as in text files.

    Raises:
        BadInput: it unpacks to more than ``most`` MB, or its only sheet is no table.
        ModuleNotFoundError: without openpyxl.
    """
    from openpyxl import load_workbook

    opened(where, content, most).close()
    book = load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    texts = {}
    hidden = [sheet.title for sheet in book.worksheets if sheet.sheet_state != "visible"]
    for sheet in book.worksheets:
        sheet.reset_dimensions()  # what the sheet declares may be a million empty rows
        texts[sheet.title] = text_of_rows(where, sheet.iter_rows(values_only=True), most)
    return tables_of_sheets(where, texts, hidden, most)


def tables_of_sheets(where: str, texts: Mapping[str, str], hidden: Sequence[str], most: float) -> list[Table]:
    """The records of sheets, by their titles, each as the text that it would be; raises BadInput where none is one."""
    texts = {title: text for title, text in texts.items() if text and not is_remark(title)}
    tables, problems = [], []
    for title, text in texts.items():
        name = f"{where}#{title}" if len(texts) > 1 else where
        try:
            table = read_delimited(name, text.encode(), most)
        except BadInput as problem:  # a sheet of remarks beside those of numbers
            problems.append(problem)
            continue
        said = (f"{name}: the sheet '{title}' is hidden in the workbook",) if title in hidden else ()
        tables.append(replace(table, record=title if len(texts) > 1 else "", notes=(*table.notes, *said)))
    if not tables and problems:
        raise problems[0]
    return tables


def text_of_rows(where: str, rows: Iterable[Sequence[Any]], most: float) -> str:
    """The rows of a sheet as text; raises BadInput for more than ``most`` MB of it."""
    lines: list[str] = []
    size = 0
    for row in rows:
        cells = ["" if value is None else " ".join(str(value).split()) for value in row]
        while cells and not cells[-1]:
            cells.pop()
        line = "\t".join(cells)
        size += len(row) + len(line)
        if size > most * 1e6:
            raise too_large(where, most)
        if line:
            lines.append(line)
    return "\n".join(lines)

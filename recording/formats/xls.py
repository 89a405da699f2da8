"""Workbooks as Excel wrote them until 2003, which programs of phones still export: read as those of Excel are."""

from __future__ import annotations

import os
from typing import Any

from ..content import too_large
from ..table import Table
from .excel import tables_of_sheets, text_of_rows


def read_tables(where: str, content: bytes, most: float) -> list[Table]:
    """The records of a workbook: each sheet with numbers.

    Raises:
        BadInput: it holds more than ``most`` MB, or its only sheet is no table.
        ModuleNotFoundError: without xlrd.
    """
    import xlrd

    with open(os.devnull, "w", encoding="utf-8") as nothing:  # noqa: PTH123  what it remarks on a file
        book = xlrd.open_workbook(file_contents=content, logfile=nothing)
    sheets: list[Any] = book.sheets()
    if sum(sheet.nrows * sheet.ncols for sheet in sheets) * 8 > most * 1e6:
        raise too_large(where, most)
    texts = {
        sheet.name: text_of_rows(where, (sheet.row_values(i) for i in range(sheet.nrows)), most) for sheet in sheets
    }
    return tables_of_sheets(where, texts, [sheet.name for sheet in sheets if sheet.visibility], most)

"""The kinds of files that hold recordings: each one module, and one line in the table below."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

from ...errors import BadInput
from ..content import unpacked
from ..table import Table
from .apart import broken, read_apart
from .installed import installed_readers, installed_tables

#: Columns of a record, as many as a worksheet of Excel has; and characters in the name of one.
MOST_COLUMNS, LONGEST_NAME = 16384, 1000


class Format(NamedTuple):
    """A kind of file: what it is called, the module here that reads it, the packages that needs, their extra.

    `apart` says that a library of others parses it, in a process of its own.
    """

    name: str
    module: str
    packages: tuple[str, ...] = ()
    extra: str = ""
    apart: bool = True


_TEXT = Format("text", "delimited", apart=False)
_HDF5 = Format("HDF5", "hdf5", ("h5py",), "hdf5")
_UFF = Format("UFF58", "uff58", ("pyuff",), "uff")
_EXCEL = Format("Excel", "excel", ("openpyxl",), "excel")
_BAG = Format("ROS bag", "bag", ("rosbags",), "bags")
_MDF = Format("MDF", "mdf", ("asammdf",), "mdf")
#: By suffix. A module has ``read_tables(where, content, most) -> list[Table]``: the name for messages, the bytes of
#: the file, and how many MB they may unpack to. MAT files of version 7.3 are HDF5, which their reader finds out.
FORMATS = {
    ".csv": _TEXT,
    ".txt": _TEXT,
    ".tsv": _TEXT,
    ".dat": _TEXT,
    ".lvm": Format("LVM", "lvm", ("lvm_read",), "lvm"),
    ".mat": Format("MAT", "mat"),
    ".npz": Format("NPZ", "npz", apart=False),
    ".wav": Format("WAV", "wav", apart=False),
    ".h5": _HDF5,
    ".hdf5": _HDF5,
    ".uff": _UFF,
    ".unv": _UFF,
    ".tdms": Format("TDMS", "tdms", ("nptdms",), "tdms"),
    ".parquet": Format("Parquet", "parquet", ("pyarrow",), "parquet"),
    ".xlsx": _EXCEL,
    ".xlsm": _EXCEL,
    ".xls": Format("Excel", "xls", ("xlrd",), "excel"),
    ".zip": Format("zip", "zipped", apart=False),
    ".mcap": Format("MCAP", "mcap", ("mcap", "rosbags"), "bags"),
    ".db3": _BAG,
    ".bag": _BAG,
    ".mf4": _MDF,
    ".mdf": _MDF,
}


def format_of(name: str) -> Format | None:
    """The kind of a file by its name, with or without .gz behind; None for one that is not in the table."""
    stem = name.lower().removesuffix(".gz")
    return next((kind for suffix, kind in FORMATS.items() if stem.endswith(suffix)), None)


def _suffix(name: str) -> str:
    """The last suffix of a name, but for .gz, with its dot; "" where it has none."""
    stem = name.lower().removesuffix(".gz")
    return f".{stem.rpartition('.')[2]}" if "." in stem else ""


def _of_others(name: str, content: bytes, most: float) -> list[Table]:
    """The records of a file of a kind that is not in the table: by the reader of an installed package.

    Raises:
        BadInput: there is no such reader, or it refuses the file.
    """
    tables = installed_tables(name, _suffix(name), unpacked(name, content, most))
    if tables is None:
        others = [suffix for suffix, _, _ in installed_readers()]
        raise BadInput(
            f"{name}: files of the kind '{_suffix(name)}' cannot be read; supported are "
            f"{', '.join(dict.fromkeys([*FORMATS, *others]))}, each also with .gz: save or export it as one of these, "
            "CSV if in doubt, or install a reader for it"
        )
    return tables


def read_tables(name: str, content: bytes, most: float) -> list[Table]:
    """The records of a file, at least one, each as a table.

    Args:
        name: of the file, whose suffix says what it is.
        content: its bytes.
        most: how many MB they may unpack to.

    Raises:
        BadInput: the kind is not known, its package is not there, or the content is not of that kind.
    """
    kind = format_of(name)
    if kind is None:
        return _sound(name, _of_others(name, content, most))
    content = content if kind is _TEXT else unpacked(name, content, most)
    if not content:
        raise BadInput(f"{name} is empty; record or copy it again")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what a library remarks on a file is no sentence for a user
            if kind.apart:
                tables = read_apart(kind.module, kind.name, name, content, most)
            else:
                read: Callable[[str, bytes, float], list[Table]]
                read = import_module(f".{kind.module}", __package__).read_tables
                tables = read(name, content, most)
    except BadInput:
        raise
    except ModuleNotFoundError as error:
        raise missing(name, kind, error) from None
    except Exception as error:  # a parser of others ends a damaged file in any way: IndexError, struct.error, ...
        raise BadInput(broken(name, kind.name, error)) from None
    return _sound(name, tables)


def _sound(name: str, tables: list[Table]) -> list[Table]:
    """The tables; raises BadInput where there are none, or one is of an endless width."""
    if not tables:
        raise BadInput(f"{name} holds no channel of numbers; dashpot reads vectors of samples, each with a name")
    for table in tables:
        _reject_endless(table)
    return tables


def _reject_endless(table: Table) -> None:
    """Raises BadInput for more columns, or longer names, than anybody gives a record."""
    if len(table.names) > MOST_COLUMNS:
        raise BadInput(
            f"{table.where} has {len(table.names)} columns, more than the {MOST_COLUMNS} of a spreadsheet; write a row "
            "for each sample and a column for each channel"
        )
    for place, name in enumerate(table.names):
        if len(name) > LONGEST_NAME:
            raise BadInput(f"{table.where}: the name of column {place + 1} has {len(name)} characters; shorten it")


def missing(name: str, kind: Format, error: ModuleNotFoundError) -> BadInput:
    """What is said where the package that reads a kind of file is not there."""
    lacking = (error.name or "").partition(".")[0]
    if lacking not in kind.packages:
        return BadInput(f"{name} cannot be read: {error}; install it with pip")
    return BadInput(
        f"{name}: files of the kind {kind.name} need {lacking}, which is not installed; "
        f"pip install 'dashpot[{kind.extra}]', or export the file as CSV"
    )

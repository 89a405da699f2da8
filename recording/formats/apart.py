"""Reading in a process of its own: libraries in C end the process that hands them a damaged file, or never end.

The process gets the bytes and gives back arrays (NPZ without objects) with names and units as JSON: numbers and texts,
nothing that runs.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from dataclasses import replace
from importlib import import_module

import numpy as np

from ...errors import BadInput
from ..channels import Channel, table_of
from ..table import Table

_SECONDS, _SECONDS_PER_MB = 60.0, 2.0  # universal files as text, the slowest, take a second for each MB
#: What a parser trips over where it takes a damaged file for a whole one.
_OF_PYTHON = (NameError, AttributeError, TypeError, ArithmeticError, IndexError, AssertionError, RecursionError)
_PROGRAM = "import sys; sys.path[:0] = {path!r}; from dashpot.recording.formats import apart; apart.main()"


def read_apart(module: str, kind: str, where: str, content: bytes, most: float) -> list[Table]:
    """What ``read_tables`` of a module of this folder gives, from a process of its own.

    Args:
        module: its name.
        kind: what the files are called.
        where: name of the file.
        content: its bytes.
        most: MB that they may unpack to.

    Raises:
        BadInput: as the module refuses, or where the process ends early or takes longer than a minute and 2 s for
            each MB.
        ModuleNotFoundError: the package that reads them is not there.
    """
    limit = _SECONDS + _SECONDS_PER_MB * len(content) / 1e6
    line = [
        sys.executable,
        "-P",
        "-c",
        _PROGRAM.format(path=[p for p in sys.path if p]),
        module,
        kind,
        where,
        str(most),
    ]
    try:
        run = subprocess.run(
            line, input=content, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        raise BadInput(
            f"{where} was read as {kind} for {limit:.0f} s without an end: it is damaged; export it as CSV"
        ) from None
    if run.returncode:
        raise BadInput(
            f"{where} cannot be read as {kind}, the library that reads it broke off: it is damaged or needs too much "
            "memory; copy it again, or export it as CSV"
        )
    with np.load(io.BytesIO(run.stdout), allow_pickle=False) as arrays:
        answer = json.loads(arrays["answer"].tobytes())
        if "missing" in answer:
            raise ModuleNotFoundError(answer["missing"], name=answer["package"])
        if "refused" in answer:
            raise BadInput(answer["refused"])
        tables = []
        for i, item in enumerate(answer["tables"]):
            values = arrays[f"table{i}"]
            channels = [
                Channel(name, values[:, j], unit)
                for j, (name, unit) in enumerate(zip(item["names"], item["units"], strict=True))
            ]
            table = table_of(item["where"], channels, item["fs"], item["record"], item["notes"])
            tables.append(replace(table, others=tuple(map(tuple, item["others"]))))
    return tables


def main() -> None:
    """The process: module, kind, name and size by argument, bytes on stdin, the answer on stdout."""
    module, kind, where, most = *sys.argv[1:4], float(sys.argv[4])
    with os.fdopen(os.dup(1), "wb") as out:
        with open(os.devnull, "wb") as nothing:  # noqa: PTH123  what libraries print is no answer
            os.dup2(nothing.fileno(), 1)
        _bounded(most)
        arrays: dict[str, np.ndarray] = {}
        try:
            reader = import_module(f".{module}", __package__)
            tables = reader.read_tables(where, sys.stdin.buffer.read(), most)
            answer: dict[str, object] = {"tables": [_as_json(table) for table in tables]}
            arrays = {f"table{i}": table.numbers(range(len(table.names))) for i, table in enumerate(tables)}
        except ModuleNotFoundError as error:
            answer = {"missing": str(error), "package": error.name}
        except BadInput as problem:
            answer = {"refused": str(problem)}
        except Exception as error:  # a parser of others ends a damaged file in any way: IndexError, struct.error, ...
            answer = {"refused": broken(where, kind, error)}
        np.savez(out, answer=np.frombuffer(json.dumps(answer).encode(), np.uint8), **arrays)  # type: ignore[arg-type]


def broken(where: str, kind: str, error: Exception) -> str:
    """What is said where a parser failed: its own words, but for those of Python about a parser that did not check."""
    said = "" if isinstance(error, _OF_PYTHON) else str(error).strip().split("\n")[0][:120]
    reason = f" ({said})" if said else ""
    return (
        f"{where} cannot be read as {kind}{reason}: it is damaged, cut short or of another kind; copy it again, or "
        "export it as CSV"
    )


def _as_json(table: Table) -> dict[str, object]:
    return {
        "where": table.where,
        "names": table.names,
        "units": table.units,
        "fs": table.fs,
        "record": table.record,
        "notes": table.notes,
        "others": table.others,
    }


def _bounded(most: float) -> None:
    """Limit the memory of this process where the system can: what is declared in a file may be beyond any machine."""
    try:
        import resource
    except ImportError:  # Windows
        return
    limit = int(4e9 + 6 * most * 1e6)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

"""Reading a file into a Recording, with every doubt about it settled or said."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import BadInput
from .columns import Choice, choose_columns, parse_column
from .content import MOST_MB, content_of
from .delimited import read_delimited
from .fact import changed
from .part import cut_out
from .recording import QUANTITIES, Recording
from .sampling import uniform_sampling
from .table import Table
from .time_stamps import in_seconds
from .units import Unit, parse_unit

# A further format is one module with a function (where, content, most) -> Table, and its suffixes here.
READERS: dict[str, Callable[[str, bytes, float], Table]] = dict.fromkeys(
    (".csv", ".txt", ".tsv", ".dat"), read_delimited
)


def read(
    path: str | Path,
    *,
    time: str | int | None = None,
    force: str | int | None = None,
    response: str | int | None = None,
    quantity: str | None = None,
    unit: str | None = None,
    force_unit: str | None = None,
    fs: float | None = None,
    part: tuple[float, float] | None = None,
    hold: str | None = None,
    max_size: float = MOST_MB,
    checked: bool = True,
) -> Recording:
    """Read one recording and convert it to SI.

    `time`, `force`, `response` name a column or give its number from 1 ("none" leaves time or force out); `quantity` is
    displacement, velocity or acceleration; `unit` and `force_unit` overrule the header; `fs` in Hz stands in for a
    time column; `part` keeps the stretch from and to so many seconds after the first sample; `hold` says how
    the force runs between samples (zero, linear, smooth; None: not said); `max_size`, in MB, limits what is
    read. With `checked`, the errors
    that `check` finds are raised and its notes kept in `Recording.notes`.

    Raises BadInput with one sentence for each thing that is wrong.
    """
    path = Path(path)
    if quantity is not None and quantity not in QUANTITIES:
        raise BadInput(f"quantity '{quantity}' is not known; use one of {', '.join(QUANTITIES)}")
    content = content_of(path, max_size)
    table = _reader(path)(path.name, content, max_size)
    choice = choose_columns(table, time, force, response, quantity)
    recording = _recording(table, choice, quantity, unit, force_unit, fs, hashlib.sha256(content).hexdigest())
    recording = replace(recording, hold=hold)
    if part is not None:
        recording = cut_out(recording, part)
    return _checked(recording, stated=unit is not None) if checked else recording


def _reader(path: Path) -> Callable[[str, bytes, float], Table]:
    suffixes = [suffix.lower() for suffix in path.suffixes]
    if suffixes and suffixes[-1] == ".gz":
        suffixes.pop()
    suffix = suffixes[-1] if suffixes else ""
    if suffix not in READERS:
        raise BadInput(
            f"{path.name}: files of the kind '{suffix}' cannot be read; supported are {', '.join(READERS)}, "
            "each also with .gz"
        )
    return READERS[suffix]


def _recording(
    table: Table,
    choice: Choice,
    quantity: str | None,
    unit_text: str | None,
    force_unit_text: str | None,
    fs: float | None,
    sha256: str,
) -> Recording:
    notes = list(choice.notes)
    unit = _unit(table, choice.response, unit_text, "--unit")
    force_unit = None if choice.force is None else _unit(table, choice.force, force_unit_text, "--force-unit")
    quantity = _quantity(table, choice.response, unit, quantity)
    if unit is None:
        unit = parse_unit({"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}[quantity], table.where)
        notes.append(f"{table.where}: no unit is given for the response, {unit.si} is assumed; --unit states another")
    if choice.force is not None and force_unit is None:
        notes.append(f"{table.where}: no unit is given for the force, N is assumed; --force-unit states another")
    if force_unit is not None and force_unit.quantity not in ("force", "any"):
        raise BadInput(
            f"{table.where}: the force column {table.label(choice.force or 0)} has the unit '{force_unit.text}', "
            "which is none of a force; choose another column with --force, or state the unit with --force-unit"
        )
    indices = [i for i in (choice.response, choice.force, choice.time) if i is not None]
    numbers = table.numbers(indices)
    signals = numbers[:, : 1 if choice.force is None else 2]
    stamps = None
    if choice.time is not None:
        stamps, said = _stamps(table, choice.time, numbers[:, -1], fs)
        notes += said
    sampling = uniform_sampling(table.where, stamps, table.fs if fs is None else fs, signals)
    columns = sampling.columns
    return Recording(
        name=table.where,
        fs=sampling.fs,
        response=columns[:, 0] * unit.factor,
        force=None if choice.force is None else columns[:, 1] * (force_unit.factor if force_unit else 1.0),
        quantity=quantity,
        unit=unit.si,
        force_unit=force_unit.si if force_unit else "N",
        start=sampling.start,
        sha256=sha256,
        notes=(*notes, *sampling.notes),
    )


def _unit(table: Table, index: int, option: str | None, flag: str) -> Unit | None:
    if option is not None:
        return parse_unit(option, where=f"{table.where} ({flag})")
    column = parse_column(table.names[index], table.units[index])
    if column.unit_text:
        return parse_unit(column.unit_text, where=f"{table.where}, column {table.label(index)}")
    return None


def _quantity(table: Table, index: int, unit: Unit | None, option: str | None) -> str:
    """Return the quantity of the response: what the option says, else the unit, else the column's name."""
    if unit is not None and unit.quantity not in (*QUANTITIES, "any"):
        raise BadInput(
            f"{table.where}: the response column {table.label(index)} has the unit '{unit.text}', which measures "
            f"{unit.quantity}; choose another column with --response, or state the unit with --unit"
        )
    measured = unit.quantity if unit is not None and unit.quantity in QUANTITIES else None
    if option and measured and option != measured:
        raise BadInput(
            f"{table.where}: --quantity {option} contradicts the unit '{unit.text if unit else ''}' of the response, "
            f"which measures {measured}; state the unit with --unit"
        )
    kind = parse_column(table.names[index], table.units[index]).kind
    return option or measured or (kind if kind in QUANTITIES else "displacement")


def _stamps(
    table: Table, index: int, stamps: np.ndarray, fs: float | None
) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """The time column in seconds, and what is to be said of it; None where it is none."""
    column = parse_column(table.names[index], table.units[index])
    where, label = table.where, table.label(index)
    if column.unit_text:
        unit = parse_unit(column.unit_text, where=f"{where}, column {label}")
        if unit.quantity != "time":
            raise BadInput(f"{where}: the time column {label} has the unit '{column.unit_text}'; choose with --time")
        return in_seconds(where, label, stamps * unit.factor, stated=True, fs=fs)
    named = table.names[index].strip().lower() in ("s", "sec", "seconds")
    return in_seconds(where, label, stamps, stated=named, fs=fs)


def _checked(recording: Recording, *, stated: bool) -> Recording:
    from .checks import FORCE_IS_NOISE, check

    problems = check(recording, stated=stated)
    errors = [problem.sentence for problem in problems if problem.severity == "error"]
    if errors:
        raise BadInput("\n".join(errors))
    notes = tuple(problem.sentence for problem in problems)
    force = None if any(FORCE_IS_NOISE in note for note in notes) else recording.force
    return changed(recording, force=force, notes=(*recording.notes, *notes))

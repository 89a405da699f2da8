"""Reading files and objects into Recordings, with every doubt about them settled or said."""

from __future__ import annotations

import difflib
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput, TellsNothing
from .base_motion import driven_through, seen_from_base
from .beside import with_beside
from .by_amplitude import amplitudes_of, of_amplitude
from .calibration import applied, of_column
from .channel import Channel, Sought, Stated, refuse_gaps, sought
from .columns import Choice, choose_columns, parse_column
from .content import MOST_MB, content_of
from .fact import changed
from .formats import read_tables
from .formats.bag import storage_of
from .objects import tables_of_object
from .part import cut_out, rows_of
from .recording import QUANTITIES, THROUGH, Recording
from .sampling import uniform_sampling
from .sensor_range import seen_whole
from .table import Table
from .time_stamps import in_seconds
from .units import Unit, parse_unit

#: The unit of what is recorded without one.
_PLAIN = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


def read(path: str | Path, **options: Any) -> Recording:
    """Read one recording and convert it to SI.

    Args:
        path: of the file; behind # the name or number of one of its records where it holds several.
        options: of ``recording_of``; `amplitude`, of the motion that is used (see ``amplitudes_of``); and `max_size`,
            the most MB that are read, 500 if not said. What a dashpot.yaml beside the file says counts where none of
            them does.

    Raises BadInput with one sentence for each thing that is wrong.
    """
    file, _ = parse_address(path)
    sha256, tables = tables_at(path, options.pop("max_size", MOST_MB))
    options, told = with_beside(*place_of(path), options)
    return told.of(lambda: _one_part(single(file.name, tables), options | {"sha256": sha256}))


def read_records(path: str | Path, **options: Any) -> list[Recording]:
    """Read all recordings of a file, or the one that is named behind #; else as ``read``."""
    sha256, tables = tables_at(path, options.pop("max_size", MOST_MB))
    options, told = with_beside(*place_of(path), options)
    made = [told.each(lambda table=table: parts_of(table, options | {"sha256": sha256})) for table in tables]
    return [part for parts in made for part in parts]


def from_data(data: Any, *, name: str = "recording", **options: Any) -> Recording:
    """Make a Recording of what a program holds, with the checks that files get.

    Args:
        data: a pandas DataFrame, an xarray Dataset or DataArray, SEP 5 dictionaries, or arrays by name, each (n,):
            see ``tables_of_object``.
        name: of the recording.
        options: of ``recording_of``, and `amplitude`.

    Raises BadInput with one sentence for each thing that is wrong.
    """
    return _one_part(single(name, tables_of_object(data, name)), options)


def parts_of(table: Table, options: Mapping[str, Any]) -> list[Recording]:
    """The recording of a table, or its parts of the ``amplitude`` among the options; others as of ``recording_of``."""
    how = dict(options)
    wanted = amplitudes_of(how.pop("amplitude", None))
    if wanted is None:
        return [recording_of(table, **how)]
    asked = how.pop("checked", True)
    whole = recording_of(table, checked=False, **how)
    parts = of_amplitude(whole, wanted)
    if not asked:
        return parts
    made, mute, stated = [], [], how.get("unit") is not None
    driven = _drives(whole)
    for part in parts:  # what is checked is what is used, as of a part in seconds
        try:
            made.append(_checked(part if not driven or _drives(part) else changed(part, force=None), stated=stated))
        except TellsNothing as problem:
            mute.append(problem)
    if not made:
        raise mute[0]
    left_out = tuple(f"{problem}; it was left out, as others were recorded" for problem in mute)
    return [replace(made[0], notes=(*made[0].notes, *left_out)), *made[1:]]


def _drives(recording: Recording) -> bool:
    """Whether the force of a recording is more than white noise that moves nothing."""
    from .checks import no_reach
    from .oscillation import is_white, oscillation_of

    force = recording.force
    return force is not None and not (is_white(force) and no_reach(recording, oscillation_of(recording)))


def _one_part(table: Table, options: Mapping[str, Any]) -> Recording:
    """The only part; raises BadInput where there are several."""
    parts = parts_of(table, options)
    if len(parts) > 1:
        raise BadInput(
            f"{table.where}: has {len(parts)} parts of such an amplitude; read_records gives all, --part chooses"
        )
    return parts[0]


def tables_at(path: str | Path, max_size: float = MOST_MB) -> tuple[str, list[Table]]:
    """The SHA-256 of a file, and the tables of its records, or of the one that is named behind #; raises BadInput."""
    file, record = place_of(path)
    content = content_of(file, max_size)
    tables = addressed(file.name, read_tables(file.name, content, max_size), record)
    return hashlib.sha256(content).hexdigest(), tables


def recording_of(
    table: Table,
    *,
    time: str | int | None = None,
    force: str | int | None = None,
    response: str | int | None = None,
    quantity: str | None = None,
    unit: str | None = None,
    force_unit: str | None = None,
    fs: float | None = None,
    calibration: Mapping[str, str | float] | None = None,
    part: tuple[float, float] | None = None,
    hold: str | None = None,
    base: str | int | None = None,
    relative: bool | None = None,
    through: str | None = None,
    prescribed: str | int | None = None,
    channels: Sequence[Stated] = (),
    checked: bool = True,
    sha256: str | None = None,
) -> Recording:
    """The recording that the columns of a table make, in SI.

    `time`, `force`, `response` name a column, by a pattern such as "*shaker*" too, or give its number from 1 ("none"
    leaves time or force out); `quantity` is displacement, velocity or acceleration; `unit` and `force_unit` overrule
    the header; `fs` in Hz stands in for a time column; `calibration` says by role (force, response, time), name or
    pattern of a column what its numbers stand for, "22.4 N/V"; `part` keeps the stretch from and to so many seconds
    after the first sample; `hold` says how the force runs between samples (zero, linear, smooth; None: not said).
    `base` names the column of the motion of the rig's base in place of a force, and `relative` says whether the
    response is relative to it (None: by the signals); `through` says that it moves one end of a "spring" or "damper",
    while all else stands on the ground; see ``base_motion``. `prescribed` names the column of a motion that was
    imposed, in place of a response; the force is then what that took. `channels` are the further signals or numbers on
    which the rig may depend. With `checked`, the errors that `check` finds are raised and its notes kept in
    `Recording.notes`. `sha256` is kept.

    Raises BadInput with one sentence for each thing that is wrong.
    """
    if quantity is not None and quantity not in QUANTITIES:
        raise BadInput(f"quantity '{quantity}' is not known; use one of {', '.join(QUANTITIES)}")
    if through is not None and through not in THROUGH:
        raise BadInput(f"what the base moves one end of is {through!r}; it can be a {' or a '.join(THROUGH)}")
    if through is not None and relative:
        raise BadInput("--through and --relative were both given; a response under --through is over the ground")
    if prescribed is not None:
        response, base = _prescribed(table.where, prescribed, response, base), "none"
    shown = "response" if prescribed is None else "prescribed"
    further = sought(table, channels)
    taken = [one.index for one in further if one.index is not None]
    choice = choose_columns(table, time, force, response, quantity, base, shown, taken)
    if through is not None and not (choice.base and choice.force is not None):
        raise BadInput(f"{table.where}: --through says what a base moves, and no column is one; name it with --base")
    factors = {key: str(text) for key, text in (calibration or {}).items()}
    imposed = prescribed is not None
    how = (quantity, unit, force_unit, fs, factors, sha256, part, relative, through, imposed, further)
    recording = _recording(table, choice, *how)
    recording = replace(recording, hold=hold)
    return _checked(recording, stated=unit is not None) if checked else recording


def _prescribed(where: str, prescribed: str | int, response: str | int | None, base: str | int | None) -> str | int:
    """The column of a prescribed motion; raises BadInput where something else is said that cannot be beside it."""
    if response is not None:
        raise BadInput(f"{where}: --prescribed and --response were both given; a prescribed motion is no response")
    if base is not None and str(base).strip().lower() != "none":
        raise BadInput(f"{where}: --prescribed and --base were both given; a base moves a rig, and is not its motion")
    return prescribed


def _recording(
    table: Table,
    choice: Choice,
    quantity: str | None,
    unit_text: str | None,
    force_unit_text: str | None,
    fs: float | None,
    calibration: dict[str, str],
    sha256: str | None,
    part: tuple[float, float] | None,
    relative: bool | None,
    through: str | None,
    imposed: bool,
    further: Sequence[Sought],
) -> Recording:
    notes = [*table.notes, *choice.notes]
    factor, unit = _scale(table, choice.response, "response", unit_text, "--unit", calibration)
    force_factor, force_unit = 1.0, None
    if choice.force is not None:
        force_factor, force_unit = _scale(table, choice.force, "force", force_unit_text, "--force-unit", calibration)
    quantity = _quantity(table, choice.response, unit, quantity)
    if unit is None:
        unit = parse_unit(_PLAIN[quantity], table.where)
        notes.append(f"{table.where}: no unit is given for the response, {unit.si} is assumed; --unit states another")
    of_base = None
    if choice.base and choice.force is not None:
        of_base = _quantity(table, choice.force, force_unit, None, "base")
        if force_unit is None:
            force_unit = parse_unit(_PLAIN[of_base], table.where)
            said = f"no unit is given for the base, {force_unit.si} is assumed; --force-unit states another"
            notes.append(f"{table.where}: {said}")
        if force_unit.si.partition("/")[0] != unit.si.partition("/")[0] or force_unit.quantity == "any":
            raise BadInput(
                f"{table.where}: the base is in {force_unit.text} and the response in {unit.text}; both are needed in "
                "units of length, or of angle"
            )
    if choice.force is not None and force_unit is None:
        notes.append(f"{table.where}: no unit is given for the force, N is assumed; --force-unit states another")
    if force_unit is not None and of_base is None and force_unit.quantity not in ("force", "any"):
        raise BadInput(
            f"{table.where}: the force column {table.label(choice.force or 0)} has the unit '{force_unit.text}', "
            "which is none of a force; where it is a motion that drives the rig, name it with --base; else choose "
            "another column with --force, or state the unit with --force-unit"
        )
    force_factor *= force_unit.factor if force_unit else 1.0
    indices = [i for i in (choice.response, choice.force, choice.time) if i is not None]
    numbers = table.numbers(indices)
    there = np.flatnonzero(~np.any(np.isnan(numbers), axis=1))  # an infinite one is there, and refused
    if there.size and (before := int(there[0])):
        notes.append(f"{table.where}: a channel begins after the others, {before} row(s) before it were left out")
    if there.size and (behind := len(numbers) - 1 - int(there[-1])):
        notes.append(f"{table.where}: a channel ends before the others, {behind} row(s) behind its end were left out")
    beside = _beside(table.where, further, len(numbers))
    if there.size:
        numbers, beside = (rows[there[0] : there[-1] + 1] for rows in (numbers, beside))
    count = 1 if choice.force is None else 2
    signals = np.column_stack([numbers[:, :count], beside])
    stamps, rate = None, table.fs if fs is None else fs
    if choice.time is not None:
        stamps, said = _stamps(table, choice.time, numbers[:, -1], fs, calibration)
        notes += said
    if part is not None and stamps is not None:
        rows, said = rows_of(table.where, stamps, part)
        stamps, signals = stamps[rows], signals[rows]
        notes += said
    columned = [one for one in further if one.rows is not None]
    for one, rows in zip(columned, signals[:, count:].T, strict=True):
        refuse_gaps(table.where, one.name, rows)
    sampling = uniform_sampling(table.where, stamps, rate, signals)
    whole = seen_whole(table.where, sampling.columns[:, :count], sampling.fs, imposed=imposed)
    sampled = iter(_filled(sampling.columns[:, count:]).T)
    channels = [Channel(o.name, o.unit, next(sampled) if o.number is None else o.number) for o in further]
    columns = whole.columns
    response, force, noise, moved = columns[:, 0] * (factor * unit.factor), None, 0.0, ""
    if choice.force is not None:
        force = columns[:, 1] * force_factor
    if of_base is not None and force is not None and force_unit is not None:
        if through is None:
            seen = seen_from_base(table.where, sampling.fs, response, quantity, force, of_base, relative)
        else:
            seen = driven_through(table.where, sampling.fs, response, force, of_base, through)
        response, force, noise, moved = seen.response, seen.force, seen.noise, seen.base
        notes.append(f"{table.where}: {seen.said}")
        force_unit = parse_unit(f"{force_unit.si.partition('/')[0]}{seen.per_time}", table.where)
    recording = Recording(
        name=table.where,
        fs=sampling.fs,
        response=response,
        force=force,
        quantity=quantity,
        unit=unit.si,
        force_unit=force_unit.si if force_unit else "N",
        recorded_unit=unit.text,
        recorded_force_unit=force_unit.text if force_unit else "",
        start=sampling.start,
        sha256=sha256,
        notes=(*notes, *sampling.notes, *whole.notes),
        blank=whole.blank,
        unknown=whole.unknown,
        base=moved,
        force_noise=noise,
        prescribed=imposed,
        channels=tuple(channels),
    )
    return recording if part is None or stamps is not None else cut_out(recording, part)


def _beside(where: str, further: Sequence[Sought], rows: int) -> np.ndarray:
    """(rows, k) of the channels that are columns; raises BadInput where one is of another length."""
    made = [one for one in further if one.rows is not None]
    for one in made:
        if one.rows is not None and one.rows.size != rows:
            raise BadInput(
                f"{where}: the channel {one.name} has {one.rows.size} values and the record {rows} rows; "
                "give one for each"
            )
    return np.column_stack([np.zeros((rows, 0)), *(one.rows for one in made if one.rows is not None)])


def _filled(columns: np.ndarray) -> np.ndarray:
    """(n, k) channels, in straight lines over rows that a clock has lost."""
    made = columns.copy()
    for one in made.T:
        there = np.isfinite(one)
        if not np.all(there):
            one[:] = np.interp(np.arange(one.size), np.flatnonzero(there), one[there])
    return made


def _scale(
    table: Table, index: int, role: str, option: str | None, flag: str, calibration: dict[str, str]
) -> tuple[float, Unit | None]:
    """What a column is multiplied by to be in its unit, and that unit, None where nobody says it."""
    name, stated = table.names[index], table.units[index]
    factor = of_column(calibration, role, name, stated, table.where)
    if factor is None:
        return 1.0, _unit(table, index, option, flag)
    if option is not None and factor.value is not None:
        raise BadInput(f"{table.where}: {flag} {option} and --calibration both say the unit of the {role}; drop one")
    return applied(factor, _unit(table, index, option, flag), f"{table.where}, column {table.label(index)}")


def _unit(table: Table, index: int, option: str | None, flag: str) -> Unit | None:
    if option is not None:
        return parse_unit(option, where=f"{table.where} ({flag})")
    column = parse_column(table.names[index], table.units[index])
    if column.unit_text:
        return parse_unit(column.unit_text, where=f"{table.where}, column {table.label(index)}")
    return None


def _quantity(table: Table, index: int, unit: Unit | None, option: str | None, role: str = "response") -> str:
    """Return the quantity of the response or the base: what the option says, else the unit, else the column's name."""
    if unit is not None and unit.quantity not in (*QUANTITIES, "any"):
        raise BadInput(
            f"{table.where}: the {role} column {table.label(index)} has the unit '{unit.text}', which measures "
            f"{unit.quantity}; choose another column with --{role}, or state the unit with --"
            f"{'unit' if role == 'response' else 'calibration'}"
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
    table: Table, index: int, stamps: np.ndarray, fs: float | None, calibration: dict[str, str]
) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """The time column in seconds, and what is to be said of it; None where it is none."""
    where, label = table.where, table.label(index)
    factor, unit = 1.0, _unit(table, index, None, "--time")
    given = of_column(calibration, "time", table.names[index], table.units[index], where)
    if given is not None:
        factor, unit = applied(given, unit, f"{where}, column {label}")
    if unit is not None:
        if unit.quantity != "time":
            raise BadInput(f"{where}: the time column {label} has the unit '{unit.text}'; choose with --time")
        return in_seconds(where, label, stamps * factor * unit.factor, stated=True, fs=fs)
    stamps = stamps * factor
    named = table.names[index].strip().lower() in ("s", "sec", "seconds")
    return in_seconds(where, label, stamps, stated=named, fs=fs)


def _checked(recording: Recording, *, stated: bool) -> Recording:
    from .checks import FORCE_IS_NOISE, check

    problems = check(recording, stated=stated)
    errors = [problem for problem in problems if problem.severity == "error"]
    if errors:
        kind = TellsNothing if all(problem.mute for problem in errors) else BadInput
        raise kind("\n".join(problem.sentence for problem in errors))
    notes = tuple(problem.sentence for problem in problems)
    force = None if any(FORCE_IS_NOISE in note for note in notes) else recording.force
    return changed(recording, force=force, notes=(*recording.notes, *notes))


# Where a recording lies: a file, and behind # the name of one of the records in it, ``runs.mat#run3``.


def parse_address(path: str | Path) -> tuple[Path, str]:
    """The file and the name of the record, "" where none is named; a file whose own name has a # is that file."""
    path = Path(path)
    try:
        there = path.exists()
    except (OSError, ValueError):
        there = False
    file, _, record = str(path).partition("#")  # a record's name may hold slashes: groups within groups
    return (path, "") if there or not file or not record else (Path(file), record)


def place_of(path: str | Path) -> tuple[Path, str]:
    """The file that is read, of a folder that is a bag the one in it, and the name of the record, "" for none."""
    file, record = parse_address(path)
    return storage_of(file), record


def addressed(file: str, tables: Sequence[Table], record: str) -> list[Table]:
    """The records that an address means: all, or the one of that name or number from 1.

    Raises:
        BadInput: there is none of that name.
    """
    if not record:
        return list(tables)
    if found := [table for table in tables if table.record == record]:
        return found
    if record.isascii() and record.isdigit() and len(record) < 9 and 1 <= int(record) <= len(tables):
        return [tables[int(record) - 1]]
    names = [table.record for table in tables if table.record]
    if not names:
        raise BadInput(f"{file} holds one record, which has no name; leave out '#{record}'")
    near = difflib.get_close_matches(record, names, n=1)
    advice = f"did you mean '{near[0]}'?" if near else f"it has {listed(names)}"
    raise BadInput(f"{file} holds no record '{record}'; {advice}")


def single(file: str, tables: Sequence[Table]) -> Table:
    """The only record; raises BadInput where there are several."""
    if len(tables) == 1:
        return tables[0]
    names = [table.record for table in tables]
    raise BadInput(f"{file} holds {len(tables)} records, {listed(names)}; name one: {file}#{names[0]}")


def listed(names: Sequence[str]) -> str:
    """Names in a sentence, the first ten of them."""
    return ", ".join(names[:10]) + (f" and {len(names) - 10} more" if len(names) > 10 else "")

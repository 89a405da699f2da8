"""Which column is the time, the force, the response: from names such as time_s, force_N, x_mm, Displacement [mm]."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from ..errors import BadInput
from ..files.arguments import shown
from .table import Table
from .units import Unit, find_unit

_NAMES = {
    "time": ("t", "time", "timestamp", "zeit", "tempo", "temps", "tiempo", "sec", "seconds"),
    "force": ("f", "force", "load", "excitation", "kraft", "torque", "u", "input"),
    "displacement": (
        "x", "y", "z", "displacement", "disp", "displ", "position", "pos", "deflection", "response", "output", "lvdt",
        "phi", "theta", "angle", "roll", "pitch", "yaw", "strain", "stroke", "weg",
    ),
    "velocity": ("v", "vel", "velocity", "xdot", "xd", "speed", "ldv"),
    "acceleration": ("a", "acc", "accel", "acceleration", "xddot", "xdd"),
}  # fmt: skip
_BASES = ("base", "ground", "foundation")
_KIND = {name: kind for kind, names in _NAMES.items() for name in names}
_RESPONSES = ("displacement", "velocity", "acceleration")
_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]$")
_AMID = re.compile(r"^(?P<name>.*?)\s*[\[(]\s*(?P<unit>[^\])]*?)\s*[\])]\s*(?P<rest>\S.*)$")  # Angle (rad) Run #3
_SLASH = re.compile(r"^(?P<name>.+?)\s+(?:/|in)\s+(?P<unit>\S+)$")
_QUOTIENT = re.compile(r"^(?P<name>\w+)\s?/\s?(?P<unit>\S+)$")  # Time/s: quantity over unit (ISO 80000-1, 7.1)


@dataclass(frozen=True)
class Column:
    """One header cell taken apart: `kind` is time, force, displacement, velocity, acceleration, or "" if unclear."""

    name: str
    base: str
    unit: Unit | None
    unit_text: str
    kind: str


@dataclass(frozen=True)
class Choice:
    """The columns of a record by their index in the table; None where there is no such column.

    `base` is whether the force's column is the motion of the rig's base.
    """

    time: int | None
    force: int | None
    response: int
    notes: tuple[str, ...] = ()
    base: bool = False


def parse_column(name: str, unit_text: str = "") -> Column:
    """Take a header cell apart; `unit_text` is what a separate row of units says of it. Raises nothing."""
    name = name.strip()
    match = _BRACKETS.match(name) or _SLASH.match(name) or _quotient(name)
    if unit_text:
        base = name
    elif match and match["unit"] != "t":  # x(t) is a function of time
        base, unit_text = match["name"], match["unit"]
    elif (match := _AMID.match(name)) and find_unit(match["unit"]):
        base, unit_text = f"{match['name']} {match['rest']}", match["unit"]
    else:
        base, unit_text = _split_suffix(name)
    unit = find_unit(unit_text) if unit_text else None
    return Column(name, base, unit, unit_text, _kind(base, unit))


def choose_columns(
    table: Table,
    time: str | int | None = None,
    force: str | int | None = None,
    response: str | int | None = None,
    quantity: str | None = None,
    base: str | int | None = None,
    shown: str = "response",
    taken: Collection[int] = (),
) -> Choice:
    """Return which columns to read: those named by the options, then those whose names tell.

    An option is a column's name, the name without its unit, a pattern of either with * and ?, or its number from 1;
    "none" leaves it out; `shown` is the option that names the response; columns that are `taken` are something else.
    Raises BadInput when a named column is absent
    or the names leave a choice that the user must make.
    """
    columns = [parse_column(name, unit) for name, unit in zip(table.names, table.units, strict=True)]
    given = {"time": time, "force": force, "response": response}
    if moved := base is not None and str(base).strip().lower() != "none":
        if force is not None and str(force).strip().lower() != "none":
            raise BadInput(f"{table.where}: --force and --base were both given; a rig is driven by one of them here")
        given["force"] = base
    called = {"time": "time", "force": "base" if moved else "force", "response": shown}
    chosen: dict[str, int | None] = {
        role: _find(table, columns, called[role], option) for role, option in given.items() if option is not None
    }
    _reject_doubles(table, {called[role]: i for role, i in chosen.items()})
    if not table.has_header and response is None:
        if len(columns) > 1:
            raise BadInput(
                f"{table.where} has no {'names for' if table.fs else 'header line to name'} its "
                f"{len(columns)} columns; say which is which by number, "
                + _by_number(len(columns), table.fs is not None)
            )
        chosen.setdefault("response", 0)
    free = [i for i in range(len(columns)) if i not in chosen.values() and i not in taken]
    for role in ("time", "force"):
        if role not in chosen:
            chosen[role] = _only(table, columns, role, [i for i in free if columns[i].kind == role])
    bases = [] if moved or base is not None else [i for i in free if _is_base(columns[i])]
    bases = [i for i in bases if i not in chosen.values()]
    if bases and force is None and chosen["force"] is not None:
        raise BadInput(
            f"{table.where}: holds a force, {table.label(chosen['force'])}, and a moving base, "
            f"{table.label(bases[0])}; --force none takes the base alone, --base none the force alone"
        )
    if bases and chosen["force"] is None:
        chosen["force"], moved = _only(table, columns, "base", bases), True
    if force is None and chosen["force"] is None:
        _reject_shorter_force(table)
    if chosen.get("response") is not None:
        return Choice(chosen["time"], chosen["force"], int(chosen["response"] or 0), base=moved)

    free = [i for i in free if i not in chosen.values() and not _is_base(columns[i])]
    wanted = (quantity,) if quantity in _RESPONSES else _RESPONSES
    likely = [i for i in free if columns[i].kind in wanted] or [i for i in free if columns[i].kind in _RESPONSES]
    # an option has said what the force is, or a name has: then a last column of no telling name is the response
    unclear = [i for i in free if not columns[i].kind]
    if not likely and len(unclear) == 1:
        i = unclear[0]
        note = f"{table.where}: column {table.label(i)} is taken as the response, being the only one left"
        return Choice(chosen["time"], chosen["force"], i, (note,), moved)
    if not likely and not unclear:
        gone = "".join(f" ({note.removeprefix(f'{table.where}: ')})" for note in table.notes)
        raise BadInput(
            f"{table.where} has no column for the response among {_listed(table)}; name it with --response{gone}"
        )
    if len(likely) != 1:
        names = ", ".join(table.label(i) for i in likely or unclear)
        others = (
            ""
            if chosen["force"] is not None
            else ", and what drives it with --base where that is a motion (of the foot, or of a spring's end), with "
            "--force where it is a force (or a voltage for it)"
        )
        raise BadInput(
            f"{table.where}: cannot tell which of the columns {names} is the response; "
            f"name it with --response{others}" + ("" if chosen["time"] is not None else " (and --time or --fs)")
        )
    return Choice(chosen["time"], chosen["force"], likely[0], base=moved)


def find_column(table: Table, role: str, option: str | int) -> int:
    """Index of the column that an option names, by name, pattern or number from 1; raises BadInput for none."""
    columns = [parse_column(name, unit) for name, unit in zip(table.names, table.units, strict=True)]
    found = _find(table, columns, role, option)
    if found is None:
        raise BadInput(f"{table.where}: --{role} {option} names no column; leave it out")
    return found


def _by_number(count: int, rate: bool) -> str:
    """How columns are named by number, where the file states a rate and where it does not."""
    if rate:
        return "e.g. --force 1 --response 2"
    return "e.g. --time 1 --response 2" if count == 2 else "e.g. --time 1 --force 2 --response 3"


def _quotient(name: str) -> re.Match[str] | None:
    """Time/s taken apart, where both sides of the stroke are known: rate/slope is a name."""
    match = _QUOTIENT.match(name)
    return match if match and _word(match["name"]) in _KIND and find_unit(match["unit"]) else None


def _split_suffix(name: str) -> tuple[str, str]:
    """Split velocity_m_s into velocity and m_s: the longest tail after _ or a blank that is a unit."""
    for cut in re.finditer(r"[_ ]+", name):
        base, tail = name[: cut.start()], name[cut.end() :]
        unit = find_unit(tail)
        # F_in and V_in are inputs, not inches: where the name says otherwise, the tail is a part of the name
        if base and unit and (tail != "in" or _word(base) in _NAMES["displacement"]):
            return base, tail
    return name, ""


def _word(base: str) -> str:
    """Bring a name to the form of the table above: strain0 and Strain are strain, but V1 (volts) is not v."""
    base = re.sub(r"[_ ]*\d+$", "", base.strip().removesuffix("(t)"))
    if len(base) == 1 and base.isupper() and base not in "FTX":
        return ""
    return base.lower()


def _kind(base: str, unit: Unit | None) -> str:
    words = re.split(r"[_\s]+", base)
    named = next((kind for word in (base, *words) if (kind := _KIND.get(_word(word)))), "")
    if unit is None:
        return named
    if unit.quantity == "any":
        return named
    if unit.quantity in _RESPONSES and named == "force":
        return ""
    return unit.quantity


def _is_base(column: Column) -> bool:
    """Whether a column's name says that it is the motion of a base."""
    return re.split(r"[_\s]+", column.base.lower())[0] in _BASES and column.kind != "force"


def _find(table: Table, columns: Sequence[Column], role: str, option: str | int) -> int | None:
    if not isinstance(option, str | int | np.integer) or isinstance(option, bool):
        raise BadInput(f"--{role} is a column's name, pattern or number from 1, not {shown(option)}")
    text = str(option).strip()
    if text.lower() == "none" and role != "response":
        return None
    for same in (
        lambda c: c.name == text,
        lambda c: c.name.lower() == text.lower(),
        lambda c: c.base.lower() == text.lower(),
        lambda c: fnmatchcase(c.name.lower(), text.lower()) or fnmatchcase(c.base.lower(), text.lower()),
    ):
        matches = [i for i, column in enumerate(columns) if column.name and same(column)]
        if len(matches) == 1:
            return matches[0]
        if matches:
            raise BadInput(
                f"{table.where}: --{role} {text} fits {len(matches)} columns, "
                f"{', '.join(f'{i + 1} {table.label(i)}' for i in matches[:5])}; give the number of one"
            )
    if text.isascii() and text.isdigit():
        if len(text) < 9 and 1 <= int(text) <= len(columns):  # Python converts no number of thousands of digits
            return int(text) - 1
        raise BadInput(f"{table.where}: --{role} {text}, but the columns are numbered 1 to {len(columns)}")
    if not table.has_header:
        raise BadInput(f"{table.where} has no header line, so --{role} must be a number from 1 to {len(columns)}")
    near = difflib.get_close_matches(text, table.names, n=1)
    advice = f"did you mean '{near[0]}'?" if near else f"it has {_listed(table)}"
    raise BadInput(f"{table.where} has no column '{text}' (--{role}); {advice}")


def _only(table: Table, columns: Sequence[Column], role: str, matches: list[int]) -> int | None:
    if len(matches) > 1:
        names = ", ".join(table.label(i) for i in matches)
        raise BadInput(f"{table.where}: the columns {names} all look like the {role}; choose one with --{role}")
    return matches[0] if matches else None


def _reject_doubles(table: Table, chosen: dict[str, int | None]) -> None:
    used: dict[int, str] = {}
    for role, i in chosen.items():
        if i is not None and i in used:
            raise BadInput(f"{table.where}: --{used[i]} and --{role} name the same column {table.label(i)}; change one")
        if i is not None:
            used[i] = role


def _reject_shorter_force(table: Table) -> None:
    """Raises BadInput where the one force of a record is of another length: without it, the motion would be free."""
    for name, unit, count in table.others:
        if parse_column(name, unit).kind == "force":
            raise BadInput(
                f"{table.where}: the force '{name}' has {count} samples, another number than the record, and which of "
                "them belong together is not known; write both over one time, or leave the force out with --force none"
            )


def _listed(table: Table) -> str:
    return ", ".join(table.label(i) for i in range(len(table.names)))

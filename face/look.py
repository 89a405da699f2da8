"""What would be read of files: channels, units, rates, kinds of motion, a small picture; nothing else is done."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput, printable

if TYPE_CHECKING:
    from ..identify.motion.decay import FreeMotion
    from ..recording import Recording
    from ..recording.table import Table

_BLOCKS = "▁▂▃▄▅▆▇█"
_WIDTH = 60  # characters of a picture
_MARKS = {"free": "━", "struck": "╍", "driven": "┄"}  # under it, where a fit would take what moves
_NAMED = 4  # pieces of a kind are named with their times
_OPTIONS = (
    *("time", "force", "quantity", "unit", "force_unit", "calibration"),
    *("fs", "hold", "base", "relative", "through", "prescribed", "amplitude"),
)


@dataclass(frozen=True)
class Seen:
    """A record: what is said of it, and of each response the recording, None where it was refused.

    ``file`` is how it is named where it is read again, None for what has no name; ``part`` the seconds that were read,
    and ``how`` each recording was read beside that.
    """

    entry: dict[str, Any]
    recordings: tuple[Recording | None, ...]
    file: str | None
    part: tuple[float, float] | None = None
    how: tuple[Mapping[str, Any], ...] = ({},)

    @property
    def read(self) -> bool:
        """Whether there is a recording of it."""
        return any(recording is not None for recording in self.recordings)


def look(path: Path, options: Mapping[str, Any], place: int = 0) -> list[Seen]:
    """What would be read of a file, one of each record; what is refused has its sentence under ``refused``.

    Args:
        path: of the file, with the name of a record behind # where one is meant.
        options: of ``recording.read``, each as text or as what it means; ``response`` is a column or several.
        place: of the file among those whose channels are given in order.

    Raises:
        BadInput: the file is not there, or nothing in it is a record.
    """
    from ..recording.beside import with_beside
    from ..recording.channel import sought, stated_channels
    from ..recording.columns import parse_column
    from ..recording.content import MOST_MB
    from ..recording.part import part_of
    from ..recording.read import parts_of, place_of, tables_at

    response, part = options.get("response"), options.get("part")
    how: dict[str, Any] = {name: options.get(name) for name in _OPTIONS}
    stated = stated_channels(options.get("channels") or ())
    typed = {name: value for name in (*_OPTIONS, "channels") if _is_said(value := options.get(name))}
    how["part"] = part_of(part) if part is not None else None
    responses: tuple[Any, ...] = (response,) if isinstance(response, str | int) else tuple(response or ())
    sha256, tables = tables_at(path, options.get("max_size", MOST_MB))
    how["channels"] = [channel.of(place, str(path)) for channel in stated]
    how, told = with_beside(*place_of(path), how | ({"response": responses[0]} if responses else {}))
    said, own = how.pop("response", None), how["channels"]
    seen = []
    for table in tables:
        columns = [parse_column(name, unit) for name, unit in zip(table.names, table.units, strict=True)]
        entry: dict[str, Any] = {
            "record": table.where,
            "channels": [
                {"number": i, "name": c.name, "unit": c.unit_text, "unit_apart": c.base == c.name, "kind": c.kind}
                for i, c in enumerate(columns, start=1)
            ],
            "fs_stated": table.fs,
            "recordings": [],
        }
        read: list[Recording | None] = []
        ways: list[Mapping[str, Any]] = []
        for response in responses or (said,):
            way = typed | ({"response": response} if responses else {})
            try:
                reading = how | {"response": response, "sha256": sha256}
                parts = told.each(lambda reading=reading, table=table: parts_of(table, reading))
                taken = [one.index for one in sought(table, own) if one.index is not None]
                columns_taken = _roles(table, response, how, taken)
                entry["recordings"] += [{"columns": columns_taken, **facts(part)} for part in parts]
                read, ways = [*read, *parts], [*ways, *(way for _ in parts)]
            except BadInput as problem:
                entry["recordings"].append({"refused": str(problem)})
                read, ways = [*read, None], [*ways, way]
        record = table.where.partition("#")[2]
        file = str(path) if "#" in str(path) or not record else f"{path}#{record}"
        seen.append(Seen(entry, tuple(read), file, how["part"], tuple(ways)))
    return seen


def look_at_object(given: Any, options: Mapping[str, Any]) -> list[Seen]:
    """The same of a Recording, or of what a program holds, as ``dashpot.read`` takes it; raises BadInput."""
    from ..recording import Recording, recordings_of
    from ..recording.part import part_of

    known = isinstance(given, Recording)  # which is as it is, whole
    part = None if known or options.get("part") is None else part_of(options["part"])
    return [
        Seen(
            {
                "record": recording.name,
                "channels": [],
                "fs_stated": None,
                "recordings": [{"columns": {}, **facts(recording)}],
            },
            (recording,),
            recording.name if recording.sha256 else None,  # which a file has, and what a program holds has not
            part,
        )
        for recording in recordings_of(given, **options)
    ]


def _is_said(value: Any) -> bool:
    return value is not None and not (isinstance(value, tuple | Mapping) and not value)


def _roles(table: Table, response: str | None, how: Mapping[str, Any], taken: Sequence[int]) -> dict[str, str | None]:
    from ..recording.columns import choose_columns

    moved = how["prescribed"]
    named = how["time"], how["force"], moved or response, how["quantity"], how["base"]
    chosen = choose_columns(table, *named, taken=taken)
    driver = "base" if chosen.base else "force"
    indices = {"time": chosen.time, driver: chosen.force, "prescribed" if moved else "response": chosen.response}
    return {role: None if i is None else table.label(i).strip("'") for role, i in indices.items()}


def facts(recording: Recording) -> dict[str, Any]:
    """What is said of a recording, by names that a program reads; raises BadInput."""
    from ..identify.motion.decays import find_free_motion
    from ..identify.motion.excitation import kind_of
    from ..identify.motion.mode_lines import modes_of
    from ..recording.as_recorded import of_force, of_response

    imposed = recording.prescribed
    free = None if imposed else find_free_motion(recording)
    pieces, left = ([], []) if free is None else _pieces(recording, free)
    signals = [("prescribed" if imposed else "response", recording.response, recording.unit, of_response(recording))]
    if recording.force is not None:
        signals.append(("force", recording.force, recording.force_unit, of_force(recording)))
    signals += [(c.name, c.over(recording.n), c.unit, (1.0, c.unit)) for c in recording.channels]
    return {
        "motion": "prescribed" if free is None else kind_of(recording, free.decays),
        "quantity": recording.quantity,
        "fs": recording.fs,
        "samples": recording.n,
        "duration": recording.duration,
        "start": recording.start,
        "signals": [
            {"role": role, "unit": unit, "min": float(signal.min()), "max": float(signal.max()), "rms": _rms(signal)}
            | {"range": _range(signal, *recorded)}
            | {"picture": sparkline(signal) if np.ptp(signal) > 0 else "the same throughout"}
            for role, signal, unit, recorded in signals
        ],
        "pieces": pieces,
        "left": left,
        "modes": [] if free is None else [mode.as_json() for mode in modes_of([recording], struck=True)],
        "notes": list(dict.fromkeys([*recording.notes, *(() if free is None else free.notes)])),
    }


def _pieces(recording: Recording, free: FreeMotion) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """What a fit would take of a recording, of what kind, and what it would leave, why; each in order.

    From where to where is in s from the first sample, as ``--part`` takes it.
    """
    from ..identify.problem.segments import cut, pace_of
    from ..identify.problem.why_left import why_left
    from ..identify.signals.hilbert import dominant_frequency
    from ..report.used import unused

    known = [decay.omega for decay in free.decays if decay.omega]
    try:
        omega = (
            known[0] if known else 2 * np.pi * dominant_frequency(np.asarray(recording.response, float), recording.fs)
        )
        taken = cut([recording], omega)
    except BadInput:  # nothing moves
        return [], []
    pace = pace_of([recording], omega)
    left = [
        (start, stop, why_left(recording, start, stop, pace))
        for start, stop in unused(recording, [(piece.start, piece.stop) for piece in taken])
    ]
    fs = recording.fs
    return [
        {"kind": piece.kind, "start": piece.start / fs, "stop": piece.stop / fs}
        for piece in sorted(taken, key=lambda piece: piece.start)
    ], [{"start": start / fs, "stop": stop / fs, "why": why} for start, stop, why in left]


def _range(signal: np.ndarray, factor: float, unit: str) -> str:
    """From where to where a signal (n,) goes, in the recorded unit; with a prefix where that is one of SI."""
    from ..model.display import Scale, scale_of

    ends = signal.min(), signal.max()
    as_it_is = factor != 1.0 or unit.startswith("rad")  # what was recorded in rad is read in rad
    scale = Scale(factor, unit) if as_it_is else scale_of(unit, np.array(ends))
    low, high = (f"{scale.factor * end:.4g}" for end in ends)
    return f"{low} to {high} {scale.unit}"


def _rms(signal: np.ndarray) -> float:
    return float(np.std(signal))


def sparkline(signal: np.ndarray, width: int = _WIDTH) -> str:
    """The size of a signal (n,) over time in blocks: how far it swings from its mean in each part of the record."""
    swing = np.abs(signal - signal.mean())
    sizes = np.array([part.max() for part in np.array_split(swing, min(width, signal.size))])
    largest = sizes.max()
    levels = np.zeros(sizes.size) if largest == 0 else np.ceil(sizes / largest * len(_BLOCKS)) - 1
    return "".join(_BLOCKS[int(level)] for level in np.clip(levels, 0, len(_BLOCKS) - 1))


def described(entry: Mapping[str, Any]) -> str:
    """One record of ``look`` in words and pictures."""
    channels = ", ".join(
        f"{channel['number']} {channel['name'] or '(no name)'}"
        + (f" [{channel['unit']}]" if channel["unit"] and channel["unit_apart"] else "")
        for channel in entry["channels"][:40]
    )
    more = len(entry["channels"]) - 40
    lines = [entry["record"]]
    lines += [f"  channels   {channels}{f' and {more} more' if more > 0 else ''}"] if channels else []
    for recording in entry["recordings"]:
        lines += _lines(recording)
    return printable("\n".join(lines))


def _lines(recording: Mapping[str, Any]) -> Sequence[str]:
    from ..identify.motion.mode import Mode

    if "refused" in recording:
        return [f"  refused    {sentence}" for sentence in recording["refused"].split("\n")]
    columns = ", ".join(f"{role} = {name}" for role, name in recording["columns"].items() if name is not None)
    lines = [
        f"  read as    {columns}{'; ' if columns else ''}{recording['quantity']}",
        f"  sampling   {recording['fs']:.6g} Hz, {recording['samples']} samples, {recording['duration']:.6g} s",
        f"  motion     {recording['motion']}",
    ]
    for number, mode in enumerate(recording["modes"] if len(recording["modes"]) > 1 else (), 1):
        lines.append(f"  mode {number}     {Mode.of_json(mode)}")
    for signal in recording["signals"]:
        lines.append(f"  {signal['role']:<10} {signal['picture']}")
        lines.append(f"             {signal['range']}")
    lines += [] if recording["motion"] == "prescribed" else _taken(recording)
    return [*lines, *(f"  note       {note}" for note in recording["notes"])]


def _taken(recording: Mapping[str, Any]) -> list[str]:
    """What a fit would take, under the pictures of the signals, and when that is."""
    pieces, fs = recording["pieces"], recording["fs"]
    if not pieces:
        return ["  taken      nothing"]
    marks = np.full(recording["samples"], " ")
    for piece in pieces:
        marks[round(piece["start"] * fs) : round(piece["stop"] * fs)] = _MARKS[piece["kind"]]
    parts = np.array_split(marks, min(_WIDTH, marks.size))
    row = "".join(max(_MARKS.values(), key=list(part).count) if np.any(part != " ") else " " for part in parts)
    said = []
    for kind, mark in _MARKS.items():
        spans = [f"{piece['start']:.4g} to {piece['stop']:.4g} s" for piece in pieces if piece["kind"] == kind]
        more = f" and {len(spans) - _NAMED} more" if len(spans) > _NAMED else ""
        said += [f"{mark} {kind} {', '.join(spans[:_NAMED])}{more}"] if spans else []
    said += ["the rest is left"] if np.any(marks == " ") else []
    since = " (from the first sample)" if recording["start"] else ""
    return [f"  taken      {row}".rstrip(), f"             {'; '.join(said)}{since}"]

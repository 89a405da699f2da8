"""The manifest of a fleet, ``dashpot-fleet/1``: YAML that names rigs, their recordings, and how each is identified.

Paths are relative to the manifest; a pattern (``sweeps/*.csv``) stands for the files that match it, in the order of
their names, numbers counted as numbers.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.reading import content_of
from .store import FLEET, FORMAT

if TYPE_CHECKING:
    from ..files.yaml_loader import Document
    from .schema import ManifestForm, OptionsForm, RigForm

_MOST_BYTES = 4_000_000
#: Bytes in which a fleet's results say what they are.
_HEAD = 1000
_PATTERN = re.compile(r"[*?\[]")
#: Options of the manifest that say how a recording is read, as ``recording.read`` has them.
READING = (
    *("time", "force", "quantity", "unit", "force_unit", "calibration"),
    *("fs", "part", "amplitude", "max_size", "hold", "base", "relative", "through", "prescribed", "channels"),
)


@dataclass(frozen=True)
class Entry:
    """One model to be made: of which recordings, and how.

    Attributes:
        name: of its own in the manifest.
        rig: the machine; entries of one machine are its life.
        state: what was set or changed; entries of the same rig in the same state are repeats. None: not said.
        when: a number, or a time as ISO 8601; None: not said, the manifest's order counts.
        recordings, holdout: files, with the name of a record behind # where one is meant.
        reading: options of ``recording.read``, and ``response``, a tuple of columns.
        how: ``with``, ``fix``, ``mode``, ``faults``, ``max_left``, ``diagnose``, ``report``.
        start: model to start from.
        laws: Python files with laws of the user's own.
    """

    name: str
    rig: str
    state: str | None
    when: float | str | None
    recordings: tuple[str, ...]
    holdout: tuple[str, ...] = ()
    reading: Mapping[str, Any] = field(default_factory=dict)
    how: Mapping[str, Any] = field(default_factory=dict)
    start: str | None = None
    laws: tuple[str, ...] = ()


@dataclass(frozen=True)
class Manifest:
    """What a manifest asks for."""

    path: Path
    entries: tuple[Entry, ...]


def read_manifest(path: Path) -> Manifest:
    """Read a manifest.

    Raises:
        BadInput: it cannot be read or is none; one line a problem, ``file: line N: $.path: what is wrong``.
    """
    from ..files.yaml_loader import read_yaml
    from .schema import checked

    try:
        text = content_of(path, _MOST_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadInput(f"{path}: is not UTF-8 text, so no manifest; save it as UTF-8") from None
    except (OSError, ValueError) as error:
        raise BadInput(
            f"{path}: cannot be read ({getattr(error, 'strerror', None) or error}); check the path"
        ) from None
    document = read_yaml(text, str(path))
    form = checked(document)
    entries = [entry for i, rig in enumerate(form.rigs) for entry in _entries(form, i, rig, path.parent, document)]
    _distinct(entries, document)
    kinds = {isinstance(entry.when, str) for entry in entries if entry.when is not None}
    if len(kinds) > 1:
        document.report(
            ("rigs",), "'when' is a number in some rigs and a time in others; write all as one or the other"
        )
    if document.problems:
        raise document.error()
    return Manifest(path, tuple(entries))


def _distinct(entries: Sequence[Entry], document: Document) -> None:
    seen: set[str] = set()
    for entry in entries:
        if entry.name.casefold() in seen:  # which are one folder on some disks
            document.report(("rigs",), f"two entries are called {entry.name!r}; give each rig a name of its own")
        seen.add(entry.name.casefold())


def _entries(form: ManifestForm, index: int, rig: RigForm, folder: Path, document: Document) -> Iterator[Entry]:
    """The entries that a rig of the manifest stands for; what is wrong is reported."""
    place: tuple[str | int, ...] = ("rigs", index)
    options = _merged(form.defaults, rig)
    files = _files(rig.recordings, folder, (*place, "recordings"), document)
    holdout = _files(rig.holdout, folder, (*place, "holdout"), document)
    if rig.each and holdout:
        document.report((*place, "holdout"), "cannot be that of 'each' recording; leave one of the two out")
    if options.get("part") and options.get("parts"):
        document.report((*place, "parts"), "stands beside 'part'; keep one of them")
    when = _when(rig.when, (*place, "when"), document)
    if rig.name is None and not rig.each and len(files) > 1:
        document.report(place, "several recordings make one model, which needs a name; write name: ..., or each: true")
        return
    groups = [(_stem(file), (file,)) for file in files] if rig.each else [(_stem(files[0]) if files else "", files)]
    for stem, group in groups:
        name = f"{rig.name}-{stem}" if rig.each and rig.name else rig.name or stem
        made = _entry(name, rig, options, tuple(group), holdout, when, folder, (place, document))
        yield from _parts(made, options.get("parts"))


def _parts(entry: Entry, parts: Sequence[str] | None) -> Iterator[Entry]:
    """An entry for each part of its recordings: repeats of one state."""
    if not parts:
        yield entry
        return
    for i, part in enumerate(parts, start=1):
        yield replace(
            entry,
            name=f"{entry.name}-part{i}",
            state=entry.state if entry.state is not None else entry.name,
            reading={**entry.reading, "part": part},
        )


def _entry(
    name: str,
    rig: RigForm,
    options: Mapping[str, Any],
    files: tuple[str, ...],
    holdout: tuple[str, ...],
    when: float | str | None,
    folder: Path,
    read: tuple[tuple[str | int, ...], Document],
) -> Entry:
    from ..recording.part import parse_part

    place, document = read
    for part in [*(options.get("parts") or []), *([options["part"]] if options.get("part") else [])]:
        try:
            parse_part(part)
        except BadInput as problem:
            document.report(place, str(problem))
    _sound(options, place, document)
    response = options.get("response") or ()
    reading = {key: options[key] for key in READING if options.get(key) is not None}
    fix = dict(options.get("fix") or {})
    if options.get("mass") is not None:
        fix["mass"] = options["mass"]
    mode = options.get("mode")
    how = {
        "with": list(options.get("laws_beside") or []),
        "fix": fix,
        "mode": f"{mode:g}" if isinstance(mode, float | int) else mode,
        "faults": bool(options.get("faults")),
        "max_left": options.get("max_left"),
        "diagnose": options.get("diagnose") or "unfit",
        "report": options.get("report") is not False,
    }
    state = rig.state
    return Entry(
        name=name,
        rig=rig.rig or rig.name or name,
        state=f"{state:g}" if isinstance(state, float | int) else state,
        when=when,
        recordings=files,
        holdout=holdout,
        reading=reading | {"response": [response] if isinstance(response, str) else list(response)},
        how=how,
        start=str(folder / options["start"]) if options.get("start") else None,
        laws=tuple(str(folder / law) for law in options.get("law") or []),
    )


def _sound(options: Mapping[str, Any], place: tuple[str | int, ...], document: Document) -> None:
    """Report what no recording could be identified with, before any is."""
    from ..model.fit_state import parse_most_left
    from ..model.library import find
    from ..model.quantity import plain
    from ..recording.channel import stated_channels

    checks: list[Callable[[], object]] = [
        lambda law=law: find(law) for law in options.get("laws_beside") or [] if not options.get("law")
    ]
    given = {**(options.get("fix") or {}), "mass": options.get("mass")}
    checks += [lambda name=name, value=value: plain(value, name) for name, value in given.items() if value is not None]
    if options.get("max_left") is not None:
        checks.append(lambda: parse_most_left(options["max_left"]))
    if options.get("prescribed"):
        for key in ("fix", "mass", "start", "mode", "faults", "max_left"):
            if options.get(key):
                name = {"start": "from", "max_left": "max-left"}.get(key, key)
                both = f"{name!r} is of an oscillator, and 'prescribed' of a force law by itself"
                document.report(place, f"{both}; leave one of them out")
    elif options.get("channels"):
        document.report(place, "'channels' go with 'prescribed', a force law by itself; leave them out")
    if options.get("channels"):
        checks.append(lambda: stated_channels(options["channels"]))
    for check in checks:
        try:
            check()
        except BadInput as problem:
            document.report(place, str(problem))


def _merged(defaults: OptionsForm, rig: RigForm) -> dict[str, Any]:
    """The options of a rig over the defaults; ``fix`` and ``calibration`` name by name."""
    merged: dict[str, Any] = {}
    for name in type(defaults).model_fields:
        general, own = getattr(defaults, name), getattr(rig, name)
        both = isinstance(general, dict) and isinstance(own, dict)
        merged[name] = {**general, **own} if both else general if own is None else own
    if (rig.part is None) != (rig.parts is None):
        merged["parts" if rig.parts is None else "part"] = None  # what a rig says itself stands for both
    return merged


def _files(given: str | list[str], folder: Path, place: tuple[str | int, ...], document: Document) -> tuple[str, ...]:
    found: list[str] = []
    for name in [given] if isinstance(given, str) else given:
        path, sign, record = name.partition("#")
        if not _PATTERN.search(path) or (folder / path).exists():
            found.append(str(folder / name))
            continue
        if _searches_all(path):
            document.report(
                place, f"{name!r} would search every folder of the disk; begin the pattern with the recordings' folder"
            )
            continue
        matches = sorted(_matching(folder, path), key=_natural)
        if not matches:
            document.report(place, f"no file matches {name!r} in {folder or Path()}; check the pattern")
        found += [f"{match}{sign}{record}" for match in matches]
    if len(set(found)) < len(found):
        document.report(place, "names a recording twice; name each once")
    return tuple(found)


def _searches_all(pattern: str) -> bool:
    """Whether ``**`` stands at the root of a disk, where nobody waits for the end of the search."""
    first, *rest = Path(pattern).parts
    return first == Path(pattern).anchor and rest[:1] == ["**"]


def _matching(folder: Path, pattern: str) -> list[str]:
    """Files that a pattern names, but for what a fleet keeps: its results are no recordings of it."""
    import glob

    # pathlib's refuses absolute patterns
    names = glob.glob(pattern, root_dir=folder, recursive=True)  # noqa: PTH207
    found = [folder / name for name in names if not (folder / name).is_dir()]
    kept = {place for place in {up for file in found for up in file.parents} if _is_kept(place / FLEET)}
    return [str(file) for file in found if kept.isdisjoint(file.parents)]


def _is_kept(file: Path) -> bool:
    """Whether a file is that by which a folder of results is known."""
    if not file.is_file():
        return False
    with file.open("rb") as content:
        return FORMAT.encode() in content.read(_HEAD)


def _natural(text: str) -> list[tuple[int, int, str]]:
    return [(1, int(word), "") if word.isdigit() else (0, 0, word) for word in re.split(r"(\d+)", text)]


def _stem(file: str) -> str:
    path, _, record = file.partition("#")
    stem = os.path.basename(path).removesuffix(".gz").rpartition(".")[0]  # noqa: PTH119
    return f"{stem}-{record}" if record else stem


def _when(given: str | float | None, place: tuple[str | int, ...], document: Document) -> float | str | None:
    if not isinstance(given, str):
        return given
    try:
        return instant(given).isoformat()
    except ValueError:
        document.report(
            place, f"cannot read {given!r}; write a number, or a time such as 2026-03-31 or 2026-03-31T14:05"
        )
        return None


def instant(text: str) -> datetime:
    """A time as ISO 8601; raises ValueError. Times without a zone are taken as UTC, so that all can be compared."""
    time = datetime.fromisoformat(text)
    return time if time.tzinfo else time.replace(tzinfo=UTC)

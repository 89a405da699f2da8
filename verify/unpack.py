"""Unpacking an FMU that may come from anywhere: its sizes, names and number of files are limited before anything is."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path, PurePosixPath

from ..errors import BadInput

#: No FMU needs more: those of whole vehicles, with binaries for all platforms, have some hundred files and megabytes.
MOST_FILES = 10_000
MOST_BYTES = 2 * 1024**3
MOST_DESCRIPTION = 64 * 1024**2
_LONGEST_NAME = 1000
_DESCRIPTION = "modelDescription.xml"
_MODELS = (".yaml", ".yml")


def unpack(fmu: Path, folder: Path) -> None:
    """Unpack the archive ``fmu`` into ``folder``.

    Raises:
        BadInput: where it is no archive, is damaged, or holds more, larger or otherwise named files than an FMU may.
    """
    try:
        with zipfile.ZipFile(fmu) as archive:
            entries = archive.infolist()
            _check(fmu, entries)
            for entry in entries:
                archive.extract(entry, folder)  # no more than the size that was checked, and never as a link
    except (BadInput, MemoryError):
        raise
    except OSError as problem:
        raise BadInput(
            f"{fmu}: cannot be unpacked ({problem.strerror or problem}); check it, and the room in {folder.parent}"
        ) from problem
    except Exception as problem:  # each way of packing has faults of its own, and zipfile does not foresee all
        if fmu.suffix in _MODELS:
            raise BadInput(f"{fmu}: is no FMU; make one of a model file with: dashpot export {fmu} rig.fmu") from None
        raise BadInput(f"{fmu}: not a readable FMU ({_said(problem)}); export it again") from problem


def _check(fmu: Path, entries: list[zipfile.ZipInfo]) -> None:
    if len(entries) > MOST_FILES:
        raise BadInput(
            f"{fmu}: holds {len(entries)} files, more than the {MOST_FILES} that an FMU may; check its origin"
        )
    total = sum(entry.file_size for entry in entries)
    if total > MOST_BYTES:
        raise BadInput(
            f"{fmu}: unpacks to {total / 1024**2:.0f} MB, more than the {MOST_BYTES // 1024**2} that an FMU may; "
            "check its origin"
        )
    seen = set()
    for entry in entries:
        name = entry.filename
        parts = PurePosixPath(name.replace("\\", "/")).parts
        if (
            not name
            or not name.isprintable()
            or len(name) > _LONGEST_NAME
            or ".." in parts
            or re.match(r"[/\\]|[A-Za-z]:", name)
            or (parts and parts in seen)
        ):
            raise BadInput(f"{fmu}: holds a file named {name[:60]!r}, which no FMU may; check its origin")
        seen.add(parts)
        if name == _DESCRIPTION and entry.file_size > MOST_DESCRIPTION:
            raise BadInput(
                f"{fmu}: its {_DESCRIPTION} has {entry.file_size / 1024**2:.0f} MB, more than the "
                f"{MOST_DESCRIPTION // 1024**2} that one may; check its origin"
            )


def stated_version(folder: Path) -> str | None:
    """The FMI version that an unpacked FMU states; None where it states none that can be read."""
    try:
        text = (folder / _DESCRIPTION).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    match = re.search(r"""<fmiModelDescription\b[^>]*?\bfmiVersion\s*=\s*["']([^"']*)["']""", text)
    return match.group(1) if match else None


def _said(problem: Exception) -> str:
    return " ".join(str(problem).split()).rstrip(".")[:200] or type(problem).__name__

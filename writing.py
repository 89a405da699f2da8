"""Files appear whole or not at all; like ``errors``, for every folder to use."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import BadInput


def writable(target: Path) -> None:
    """Make sure that ``target`` can be written, before long work is done for it.

    Raises:
        BadInput: where it is a folder, or its folder cannot be made or written.
    """
    target = Path(target)
    try:
        if target.is_dir():
            raise BadInput(f"{target}: is a folder; name a file in it")
        missing = [folder for folder in target.parents if not folder.exists()]
    except (OSError, ValueError) as problem:  # a name too long, a null byte
        raise _refused(target, problem) from problem
    try:
        with replacing(target) as temporary:
            temporary.unlink()
    finally:
        for folder in missing:  # made again when there is something to put in
            with suppress(OSError):
                folder.rmdir()


def same_place(first: Path, second: Path) -> bool:
    """Whether two names lead to the same file, which need not exist yet."""
    try:
        return first.resolve() == second.resolve() or (first.exists() and second.exists() and first.samefile(second))
    except (OSError, ValueError, RuntimeError):
        return False


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """A temporary path beside ``target`` that takes its name when the block ends well, and goes when it does not.

    Folders that are missing are made.

    Raises:
        BadInput: where the folder cannot be written.
    """
    target = Path(target)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{target.name[:40]}-", suffix=target.suffix, dir=target.parent)
        os.close(handle)
    except (OSError, ValueError) as problem:
        raise _refused(target, problem) from problem
    temporary = Path(name)
    try:
        yield temporary
        if temporary.exists():
            temporary.chmod(0o644)
            try:
                temporary.replace(target)
            except OSError as problem:
                raise _refused(target, problem) from problem
    finally:
        temporary.unlink(missing_ok=True)


def _refused(target: Path, problem: Exception) -> BadInput:
    if isinstance(problem, (FileExistsError, NotADirectoryError)):
        return BadInput(f"{target}: cannot be written, for its folder's name is that of a file; choose another place")
    reason = (problem.strerror if isinstance(problem, OSError) else None) or str(problem)
    return BadInput(f"{target}: cannot be written ({reason}); choose another place")

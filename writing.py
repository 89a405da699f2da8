"""Files appear whole or not at all, and those of one command together; like ``errors``, for every folder to use.

All is written under temporary names first and read back; the files take their places when nothing can go wrong any
more, and where one cannot, those before it are put back. Only regular files are replaced; links are followed.
"""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from .errors import BadInput


@dataclass
class _Pending:
    """What is to take its place when all is well: targets with the temporary file for each; None: it is to go.

    ``folders`` were made for them, the innermost first.
    """

    changes: dict[Path, Path | None] = field(default_factory=dict)
    folders: list[Path] = field(default_factory=list)

    def add(self, target: Path, temporary: Path | None) -> None:
        before = self.changes.pop(target, None)
        if before is not None:
            before.unlink(missing_ok=True)
        self.changes[target] = temporary

    def discard(self) -> None:
        for temporary in self.changes.values():
            if temporary is not None:
                with suppress(OSError):
                    temporary.unlink(missing_ok=True)
        for folder in self.folders:
            with suppress(OSError):  # something lies there
                folder.rmdir()

    def settle(self) -> None:
        """Put all in their places; where one cannot be, as it was before."""
        kept: list[tuple[Path, Path | None]] = []
        target = Path()
        try:
            for target, temporary in self.changes.items():
                aside = _unused(target) if target.exists() else None
                kept.append((target, aside))
                if aside is not None:
                    _second_name(target, aside)
                if temporary is not None:
                    temporary.replace(target)
                else:
                    target.unlink(missing_ok=True)
        except BaseException as problem:
            for place, aside in reversed(kept):
                with suppress(OSError):
                    if aside is None:
                        place.unlink(missing_ok=True)
                    elif aside.exists():
                        aside.replace(place)
                        aside.unlink(missing_ok=True)  # it stays where both are names of one file still
            self.discard()
            if isinstance(problem, OSError):
                raise _refused(target, problem) from problem
            raise
        for _, aside in kept:
            if aside is not None:
                with suppress(OSError):
                    aside.unlink(missing_ok=True)


_pending: ContextVar[_Pending | None] = ContextVar("pending", default=None)


@contextmanager
def together() -> Iterator[None]:
    """What is written in the block appears when it ends well, all of it; else nothing does.

    A block within another is part of that.
    """
    if _pending.get() is not None:
        yield
        return
    pending = _Pending()
    token = _pending.set(pending)
    try:
        yield
    except BaseException:
        pending.discard()
        raise
    finally:
        _pending.reset(token)
    pending.settle()


def write(target: Path, content: str | bytes) -> None:
    """Write a file and read it back, text in UTF-8; folders that are missing are made.

    Raises:
        BadInput: where it cannot be written: no room, no permission, or the place holds what is no regular file.
    """
    with replacing(target) as temporary:
        fill(temporary, content, target)


def fill(path: Path, content: str | bytes, shown: Path | None = None) -> None:
    """Write a file for our own use, at once, and read it back; ``shown`` is its name in messages.

    Raises:
        BadInput: where it cannot be written.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        with path.open("wb") as file:
            file.write(data)
        same = path.read_bytes() == data
    except OSError as problem:
        raise _refused(shown or path, problem) from problem
    if not same:
        raise BadInput(f"{shown or path}: what was written there does not read back the same; choose another place")


def remove(target: Path) -> None:
    """Take a regular file away, together with what is written in the same block."""
    with together():
        pending = _pending.get()
        if pending is not None and target.exists():
            pending.add(_place(target), None)


@contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """A temporary path beside ``target`` that takes its name when the block ends well, and goes when it does not.

    Folders that are missing are made. A new file has the permissions that the user's umask leaves, one that is replaced
    keeps its own.

    Raises:
        BadInput: where the folder cannot be written, there is no room, or ``target`` is no regular file.
    """
    target = Path(target)
    made: list[Path] = []
    try:
        place = _place(target)
        made = [folder for folder in place.parents if not folder.exists()]
        place.parent.mkdir(parents=True, exist_ok=True)
        temporary = _unused(place)
        os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    except (OSError, ValueError, RuntimeError) as problem:
        for folder in made:
            with suppress(OSError):
                folder.rmdir()
        raise _refused(target, problem) from problem
    try:
        yield temporary
        if temporary.exists():
            with together():
                pending = _pending.get()
                assert pending is not None
                if place.exists():
                    temporary.chmod(stat.S_IMODE(place.stat().st_mode))
                pending.add(place, temporary)
                pending.folders += made
    except BaseException as problem:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        for folder in made:
            with suppress(OSError):
                folder.rmdir()
        if isinstance(problem, OSError):
            raise _refused(target, problem) from problem
        raise


def writable(target: Path) -> None:
    """Make sure that ``target`` can be written, before long work is done for it.

    Raises:
        BadInput: where it is a folder, a device or a pipe, or its folder cannot be made or written.
    """
    target = Path(target)
    try:
        place = _place(target)
        missing = [folder for folder in place.parents if not folder.exists()]
    except (OSError, ValueError, RuntimeError) as problem:  # a name too long, a null byte, links in a circle
        raise _refused(target, problem) from problem
    try:
        with replacing(target) as temporary:
            temporary.unlink()
    finally:
        for folder in missing:  # made again when there is something to put in
            with suppress(OSError):
                folder.rmdir()


def check_ours(target: Path, mark: bytes, maker: str = "dashpot") -> None:
    """Make sure that a file which the user did not name, or would hardly write over, is not a stranger's.

    Raises:
        BadInput: where ``target`` is there and its beginning does not hold ``mark``.
    """
    try:
        _place(target)  # a pipe would be waited for
        with target.open("rb") as file:
            ours = mark in file.read(4096)
    except FileNotFoundError:
        return
    except OSError as problem:
        raise _refused(target, problem) from problem
    if not ours:
        raise BadInput(f"{target}: is there and was not made by {maker}; move it away, or choose another name")


def same_place(first: Path, second: Path) -> bool:
    """Whether two names lead to the same file, which need not exist yet."""
    try:
        return first.resolve() == second.resolve() or (first.exists() and second.exists() and first.samefile(second))
    except (OSError, ValueError, RuntimeError):
        return False


def _place(target: Path) -> Path:
    """Where a file of that name lies, links followed; raises BadInput where there is what must not be replaced."""
    place = target.resolve() if target.is_symlink() else target
    try:
        mode = place.stat().st_mode
    except FileNotFoundError:
        return place
    if stat.S_ISDIR(mode):
        raise BadInput(f"{target}: is a folder; name a file in it")
    if not stat.S_ISREG(mode):
        raise BadInput(f"{target}: is a device or a pipe, which cannot be replaced; name a file")
    if not os.access(place, os.W_OK):
        raise BadInput(f"{target}: is there and protected against writing; choose another name")
    return place


def _unused(place: Path) -> Path:
    """A name beside a file that nobody has; its suffix is kept, for writers that go by it."""
    return place.with_name(f".{place.name[:40]}-{secrets.token_hex(6)}{place.suffix[:20]}")


def _second_name(target: Path, aside: Path) -> None:
    try:
        os.link(target, aside)
    except OSError:  # a disk without second names
        aside.write_bytes(target.read_bytes())


def _refused(target: Path, problem: Exception) -> BadInput:
    if isinstance(problem, (FileExistsError, NotADirectoryError)):
        return BadInput(f"{target}: cannot be written, for its folder's name is that of a file; choose another place")
    reason = (problem.strerror if isinstance(problem, OSError) else None) or str(problem)
    return BadInput(f"{target}: cannot be written ({reason}); choose another place")

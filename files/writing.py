"""Files appear whole or not at all, and those of one command together; like ``errors``, for every folder to use.

What is written is kept in memory to the end of its command. Then it is written under temporary names and read back; the
files take their places when nothing can go wrong any more, and where one cannot, those before it are put back. A child
process does this (``run_in_child``), so that an end by force changes nothing of it. Only regular files are replaced;
links are followed.
"""

from __future__ import annotations

import errno
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import BadInput, Unwritable
from .forked_writer import run_in_child


@dataclass
class _Pending:
    """What is to lie where when all is well; None: nothing. ``shown`` are the places' names in messages."""

    contents: dict[Path, bytes | None] = field(default_factory=dict)
    shown: dict[Path, Path] = field(default_factory=dict)

    def add(self, target: Path, content: bytes | None) -> None:
        place = _place(target)
        self.contents.pop(place, None)
        self.contents[place], self.shown[place] = content, target

    def settle(self) -> None:
        """Put all in their places; where one cannot be, all is as it was before."""
        written: dict[Path, Path | None] = {}
        folders: list[Path] = []
        try:
            for place, content in self.contents.items():
                written[place] = None if content is None else self._written(place, content, folders)
            self._exchange(written)
        except BaseException:
            for temporary in written.values():
                if temporary is not None:
                    with suppress(OSError):
                        temporary.unlink(missing_ok=True)
            _remove(folders)
            raise

    def _written(self, place: Path, content: bytes, folders: list[Path]) -> Path:
        """A file beside the place with its content, read back; ``folders`` gets those that were made for it."""
        temporary = _unused(place)
        try:
            _make_parents(place, folders)
            os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
            fill(temporary, content, self.shown[place])
            if place.exists():
                temporary.chmod(stat.S_IMODE(place.stat().st_mode))
        except BaseException as problem:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
            if isinstance(problem, OSError):
                raise _refused(self.shown[place], problem) from problem
            raise
        return temporary

    def _exchange(self, written: dict[Path, Path | None]) -> None:
        kept: list[tuple[Path, Path | None]] = []
        place = Path()
        try:
            for place, temporary in written.items():
                before = _unused(place) if place.exists() else None
                kept.append((place, before))
                if before is not None:
                    _second_name(place, before)
                if temporary is not None:
                    temporary.replace(place)
                else:
                    place.unlink(missing_ok=True)
        except BaseException as problem:
            for former, before in reversed(kept):
                with suppress(OSError):
                    if before is None:
                        former.unlink(missing_ok=True)
                    elif before.exists():
                        before.replace(former)
                        before.unlink(missing_ok=True)  # it stays where both are names of one file still
            if isinstance(problem, OSError):
                raise _refused(self.shown[place], problem) from problem
            raise
        for _, before in kept:
            if before is not None:
                with suppress(OSError):
                    before.unlink(missing_ok=True)


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
    finally:
        _pending.reset(token)
    if pending.contents:
        run_in_child(pending.settle)


def write(target: Path, content: str | bytes) -> None:
    """Write a file and read it back, text in UTF-8; folders that are missing are made.

    A new file has the permissions that the user's umask leaves, one that is replaced keeps its own.

    Raises:
        BadInput: where it cannot be written: no room, no permission, or the place holds what is no regular file.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    with _refusing(Path(target)), together():
        pending = _pending.get()
        assert pending is not None
        pending.add(Path(target), data)


def written_below(folder: Path) -> dict[str, bytes | None]:
    """What the block that this is called in will have written below a folder, by its name there; None: taken away."""
    pending, below = _pending.get(), _place(folder / "file").parent
    if pending is None:
        return {}
    return {
        place.relative_to(below).as_posix(): content
        for place, content in pending.contents.items()
        if place.is_relative_to(below)
    }


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
        raise Unwritable(f"{shown or path}: what was written there does not read back the same; choose another place")


def remove(target: Path) -> None:
    """Take a regular file away, together with what is written in the same block."""
    with together():
        pending = _pending.get()
        if pending is not None and target.exists():
            pending.add(target, None)


def writable(target: Path) -> None:
    """Make sure that ``target`` can be written, before long work is done for it.

    Raises:
        BadInput: where it is a folder, a device or a pipe, or its folder cannot be made or written.
    """
    target = Path(target)

    def attempt() -> None:
        folders: list[Path] = []
        try:
            place = _place(target)
            _make_parents(place, folders)
            temporary = _unused(place)
            os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
            temporary.unlink()
        finally:
            _remove(folders)  # made again when there is something to put in

    with _refusing(target):
        run_in_child(attempt)


@contextmanager
def _refusing(target: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError, RuntimeError) as problem:  # a name too long, a null byte, links in a circle
        raise _refused(target, problem) from problem


def _make_parents(place: Path, made: list[Path]) -> None:
    """Make the folders that are missing, and add each to ``made``, the innermost first."""
    missing = [folder for folder in place.parents if not folder.exists()]
    for folder in reversed(missing):
        folder.mkdir(exist_ok=True)
        made.insert(0, folder)


def _remove(folders: list[Path]) -> None:
    for folder in folders:
        with suppress(OSError):  # something lies there
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
    place = target
    try:
        place = target.resolve() if target.is_symlink() else target
        mode = place.stat().st_mode
    except FileNotFoundError:
        return place
    except (RuntimeError, OSError) as problem:  # RuntimeError: pathlib's word for a circle before Python 3.13
        if isinstance(problem, RuntimeError) or problem.errno == errno.ELOOP:
            raise BadInput(f"{target}: is a link that leads to itself; name a file") from None
        raise
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


def _second_name(target: Path, run_in_child: Path) -> None:
    try:
        os.link(target, run_in_child)
    except OSError:  # a disk without second names
        run_in_child.write_bytes(target.read_bytes())


def _refused(target: Path, problem: Exception) -> BadInput:
    if isinstance(problem, (FileExistsError, NotADirectoryError)):
        return BadInput(f"{target}: cannot be written, for its folder's name is that of a file; choose another place")
    reason = (problem.strerror if isinstance(problem, OSError) else None) or str(problem)
    return Unwritable(f"{target}: cannot be written ({reason}); choose another place")

"""The store of what was compiled: private to its user, and nothing in it is used before its content was checked.

An entry is one file whose name holds two hashes: of all that it was made from, and of what it is. It appears whole, by
renaming, so that two processes may make the same at once. An entry whose content is not what its name says is taken
away and made again. What was not used for ``KEPT_DAYS`` goes when something new is put in, and then what was used
longest ago while there is more than ``MOST_BYTES``.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import re
import shutil
import stat
import sys
import tempfile
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

from .cache import cache_folder

KEPT_DAYS = 90
MOST_BYTES = 512 * 1024**2
#: What a process that was killed left behind is nobody's after this time.
_LEFT_BEHIND_DAYS = 1
_DAY = 86400.0
_ENTRY = re.compile(r"(?P<stem>.+)-(?P<source>[0-9a-f]{24})-(?P<content>[0-9a-f]{32})(?P<suffix>\.\w+)?")
_BUILD = "build-"


def find(stem: str, source: str, suffix: str) -> tuple[Path, bytes] | None:
    """The entry made from ``source`` (24 hexadecimal digits), with its content; None where there is no sound one."""
    folder = private_folder("compiled")
    beginning = f"{stem}-{source}-"
    with suppress(OSError):
        names = (entry.name for entry in os.scandir(folder))  # thousands may lie there
        named = sorted(n for n in names if n.startswith(beginning) and n.endswith(suffix))
        for entry in (folder / name for name in named):
            content = _sound(entry)
            if content is not None:
                return entry, content
    return None


def put(made: Path, stem: str, source: str, suffix: str, content: bytes) -> Path:
    """Move the file ``made``, which lies in the store and holds ``content``, to its place; returns that."""
    entry = private_folder("compiled") / f"{stem}-{source}-{_digest(content)}{suffix}"
    made.chmod(0o600)
    if entry.is_dir() and not entry.is_symlink():  # nothing that we made is a folder there
        shutil.rmtree(entry, ignore_errors=True)
    made.replace(entry)
    _clean(entry.parent, entry)
    return entry


def scratch() -> tempfile.TemporaryDirectory[str]:
    """A folder to build in, on the store's own disk, so that what was built can be renamed into it."""
    return tempfile.TemporaryDirectory(prefix=_BUILD, dir=private_folder("compiled"))


def private_folder(name: str) -> Path:
    """The folder ``name`` of the cache, open to this user alone; where that cannot be, one for this process."""
    folder = _private(cache_folder() / name)
    if not folder.is_dir():  # it was taken away, or went with the command that it was made for
        _private.cache_clear()
        folder = _private(cache_folder() / name)
    return folder


@cache
def _private(folder: Path) -> Path:
    why = why_not_private(folder)
    if why is None:
        return folder
    print(
        f"note: {folder}: {why}; what is compiled is not kept: set DASHPOT_CACHE to a folder of your own",
        file=sys.stderr,
    )
    own = tempfile.mkdtemp(prefix="dashpot-")  # which only this user can open
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    return Path(own)


def why_not_private(folder: Path) -> str | None:
    """Make the folder and see that nobody else can put anything in; in words why that fails, else None."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        found = folder.lstat()
        if not stat.S_ISDIR(found.st_mode):
            return "is no folder"
        if hasattr(os, "geteuid"):
            if found.st_uid != os.geteuid():
                return "belongs to another user"
            if stat.S_IMODE(found.st_mode) != 0o700:
                folder.chmod(0o700)
        with tempfile.TemporaryFile(dir=folder) as trial:  # a read-only or full disk allows all of the above
            trial.write(b"trial" * 1000)
    except (OSError, ValueError) as problem:
        return f"cannot be written ({getattr(problem, 'strerror', None) or problem})"
    return None


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:32]


def _sound(entry: Path) -> bytes | None:
    """The content of an entry that is what its name says; what is not is taken away."""
    named = _ENTRY.fullmatch(entry.name)
    try:
        found = entry.lstat()
        if named is not None and stat.S_ISREG(found.st_mode):
            content = entry.read_bytes()
            if _digest(content) == named["content"]:
                if time.time() - found.st_mtime > _DAY:  # its time says when it was used last, to a day
                    os.utime(entry)
                return content
        entry.unlink()
    except OSError:
        pass  # another process took it away, or it is a folder: then it is not used
    return None


def _clean(folder: Path, newest: Path) -> None:
    """Remove what was not used for long, then what was used longest ago while there is too much."""
    now, entries = time.time(), []
    with suppress(OSError):
        for path in folder.iterdir():
            with suppress(OSError):
                found = path.lstat()
                age = (now - found.st_mtime) / _DAY
                if path.name.startswith(_BUILD) and stat.S_ISDIR(found.st_mode):
                    if age > _LEFT_BEHIND_DAYS:
                        shutil.rmtree(path, ignore_errors=True)
                elif path != newest and _ENTRY.fullmatch(path.name):
                    entries.append((found.st_mtime, found.st_size, path))
    total = sum(size for _, size, _ in entries)
    for used, size, path in sorted(entries):
        if now - used > KEPT_DAYS * _DAY or total > MOST_BYTES:
            with suppress(OSError):
                path.unlink()
            total -= size

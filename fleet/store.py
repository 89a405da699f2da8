"""The store of a fleet's results: it, and no engine, knows what was done, so that any run may end at any time.

An entry has a folder of its own, ``results/NAME-KEY``, in which ``entry.json`` and the other files appear together or
not at all (``writing``). Whoever works on an entry holds its lock, which the system takes back when a process ends in
whatever way; so several runs, on several machines that share the disk, do nothing twice.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from ..errors import BadInput, Unwritable
from ..files.reading import content_of
from ..files.writing import check_ours, together, write, written_below
from .kept_files import changed_file, check_writable
from .outcome import TRIED_AGAIN, Outcome, State, from_json
from .sealed_json import digest, sealed, unsealed

ENTRY, FLEET = "entry.json", "fleet.json"
FORMAT = "dashpot-fleet-results/1"
_MOST_BYTES = 10_000_000


class Busy(Exception):
    """Somebody else works on the entry."""


class Store:
    """The results below a folder, which need not exist yet.

    Raises:
        BadInput: where something else than a fleet's results lies there.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._whole: set[tuple[Path, str]] = set()  # folders found as their entry.json of this hash says
        if folder.exists() and not folder.is_dir():
            raise BadInput(f"{folder}: is a file; name a folder for the results")
        if (folder / FLEET).is_symlink():
            raise BadInput(f"{folder / FLEET}: is a link, which dashpot batch does not make; put the file in its place")
        check_ours(folder / FLEET, FORMAT.encode(), "dashpot batch")
        if folder.exists() and any(folder.iterdir()) and not (folder / FLEET).exists():
            raise BadInput(f"{folder}: holds other files; name an empty folder, or one that dashpot batch made")

    def begin(self) -> None:
        """Mark the folder as a fleet's, before anything else lies in it."""
        if not (self.folder / FLEET).exists():
            write(self.folder / FLEET, sealed({"format": FORMAT, "counts": {}, "entries": [], "files": {}}))

    def place(self, name: str, key: str) -> Path:
        """The folder of an entry's files."""
        return self.folder / "results" / f"{_slug(name)}-{key[:16]}"

    def outcome(self, name: str, key: str) -> Outcome | None:
        """What became of an entry; None where nothing did, or what lies there is of another or was changed."""
        found = self._found(name, key)
        return found if isinstance(found, Outcome) else None

    def changed(self, name: str, key: str) -> str | None:
        """What is wrong with what was kept of an entry, in words; None where nothing is, or nothing was kept."""
        found = self._found(name, key)
        return found if isinstance(found, str) else None

    def _found(self, name: str, key: str) -> Outcome | str | None:
        place = self.place(name, key)
        try:
            content = content_of(place / ENTRY, _MOST_BYTES)
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as problem:
            return f"{ENTRY} cannot be read ({getattr(problem, 'strerror', None) or problem})"
        if place.is_symlink() or (place / ENTRY).is_symlink():
            return f"{ENTRY} is behind a link"
        try:
            outcome = from_json(unsealed(content))
        except ValueError as problem:
            return f"{ENTRY}: {problem}"
        if outcome is None or outcome.key != key:
            return f"{ENTRY} is of another entry, or of another version"
        why = None if (place, digest(content)) in self._whole else changed_file(place, outcome.files)
        if why is None:
            self._whole.add((place, digest(content)))
        return why or outcome

    def check_writable(self, name: str, key: str) -> None:
        """Raises BadInput where a link, or a folder in a file's place, lies where an entry is kept."""
        check_writable(self.place(name, key), self._lock(key))

    def keep(self, outcome: Outcome) -> Outcome:
        """Write what became of an entry, within ``together`` and behind its files; returns it with their hashes."""
        place = self.place(outcome.name, outcome.key)
        files = dict(outcome.files)
        for name, content in written_below(place).items():
            files.pop(name, None)
            if content is not None:
                files[name] = digest(content)
        kept = replace(outcome, files=files)
        write(place / ENTRY, sealed(kept.as_json()))
        return kept

    def failed(self, name: str, key: str, stage: str, state: State, sentence: str, seconds: float) -> Outcome:
        """Keep that a stage did not end well; what an earlier stage found stays."""
        before = self.outcome(name, key) or Outcome(key, name, "open", "")
        again = before.attempts + 1 if before.stage == stage and before.state in TRIED_AGAIN else 1
        outcome = replace(
            before,
            state=state,
            sentence=sentence,
            stage=stage,
            wanted=stage == "diagnose" and state in TRIED_AGAIN,
            attempts=again,
            seconds={**before.seconds, stage: round(seconds, 3)},
        )
        with together():
            return self.keep(outcome)

    def _lock(self, key: str) -> Path:
        return self.folder / "locks" / f"{key}.lock"

    @contextmanager
    def held(self, key: str) -> Iterator[None]:
        """Hold an entry's lock in the block; raises Busy where somebody else does.

        A lock that was made for what then had no room goes with it.
        """
        from filelock import FileLock, Timeout

        place = self._lock(key)
        made = not place.exists()
        place.parent.mkdir(parents=True, exist_ok=True)
        lock = FileLock(place, timeout=0)
        try:
            lock.acquire()
        except Timeout:
            raise Busy from None
        try:
            yield
        except Unwritable:
            if made:
                with suppress(OSError):
                    place.unlink()
                    place.parent.rmdir()
            raise
        finally:
            lock.release()

    def busy(self, key: str) -> bool:
        """Whether somebody works on an entry."""
        if not self._lock(key).exists():
            return False
        try:
            with self.held(key):
                return False
        except Busy:
            return True


def _slug(name: str) -> str:
    """A name that every disk takes."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._")[:80] or "entry"

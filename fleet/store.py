"""The store of a fleet's results: it, and no engine, knows what was done, so that any run may end at any time.

An entry has a folder of its own, ``results/NAME-KEY``, in which ``entry.json`` and the other files appear together or
not at all (``writing``). Whoever works on an entry holds its lock, which the system takes back when a process ends in
whatever way; so several runs, on several machines that share the disk, do nothing twice.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from ..errors import BadInput
from ..files.reading import content_of
from ..files.writing import check_ours, together, write
from .outcome import TRIED_AGAIN, Outcome, State, from_json

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
        if folder.exists() and not folder.is_dir():
            raise BadInput(f"{folder}: is a file; name a folder for the results")
        check_ours(folder / FLEET, FORMAT.encode(), "dashpot batch")
        if folder.exists() and any(folder.iterdir()) and not (folder / FLEET).exists():
            raise BadInput(f"{folder}: holds other files; name an empty folder, or one that dashpot batch made")

    def begin(self) -> None:
        """Mark the folder as a fleet's, before anything else lies in it."""
        if not (self.folder / FLEET).exists():
            write(self.folder / FLEET, json.dumps({"format": FORMAT, "entries": []}) + "\n")

    def place(self, name: str, key: str) -> Path:
        """The folder of an entry's files."""
        return self.folder / "results" / f"{_slug(name)}-{key[:16]}"

    def outcome(self, name: str, key: str) -> Outcome | None:
        """What became of an entry; None where nothing did, or what lies there is of another."""
        try:
            told = json.loads(content_of(self.place(name, key) / ENTRY, _MOST_BYTES))
        except (OSError, ValueError):
            return None
        outcome = from_json(told)
        return outcome if outcome is not None and outcome.key == key else None

    def keep(self, outcome: Outcome) -> None:
        """Write what became of an entry; within ``together``, along with its other files."""
        text = json.dumps(outcome.as_json(), ensure_ascii=False, allow_nan=False)
        write(self.place(outcome.name, outcome.key) / ENTRY, text + "\n")

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
            self.keep(outcome)
        return outcome

    @contextmanager
    def held(self, key: str) -> Iterator[None]:
        """Hold an entry's lock in the block; raises Busy where somebody else does."""
        from filelock import FileLock, Timeout

        place = self.folder / "locks" / f"{key}.lock"
        place.parent.mkdir(parents=True, exist_ok=True)
        lock = FileLock(place, timeout=0)
        try:
            lock.acquire()
        except Timeout:
            raise Busy from None
        try:
            yield
        finally:
            lock.release()

    def busy(self, key: str) -> bool:
        """Whether somebody works on an entry."""
        try:
            with self.held(key):
                return False
        except Busy:
            return True


def _slug(name: str) -> str:
    """A name that every disk takes."""
    return re.sub(r"[^A-Za-z0-9._-]+", "_", name).strip("._")[:80] or "entry"

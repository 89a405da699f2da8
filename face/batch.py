"""A fleet, identified and diagnosed as far as it was not yet: what is open is done, and the tables are made afresh."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from ..errors import BadInput
from ..files.made_by import made_by
from ..files.writing import together, write, written_below
from ..fleet.engine import Engine, Task
from ..fleet.key import key_of
from ..fleet.manifest import Entry, Manifest
from ..fleet.outcome import TRIED_AGAIN, Outcome, from_json
from ..fleet.sealed_json import digest, sealed
from ..fleet.store import FLEET, Store
from ..fleet.table import Row, as_json, csv_text, parquet

CSV, PARQUET, PAGE = "fleet.csv", "fleet.parquet", "index.html"
MODULE = "dashpot.face.batch_entry"
#: How often what another run works on is asked for, s.
_SOON = 1.0


def run(
    manifest: Manifest,
    folder: Path,
    engine: Engine,
    *,
    shard: tuple[int, int] = (1, 1),
    limit: float = 3600.0,
    memory: float | None = None,
    again: bool = False,
    with_parquet: bool = False,
    say: Callable[[str], None] = lambda _: None,
) -> list[Row]:
    """Do what is open of a fleet, and write its table, its page and ``fleet.json``.

    Args:
        manifest: what to do.
        folder: of the results; made where it is missing.
        engine: who does it.
        shard: (k, n): of n runs that share the work this is number k, from 1.
        limit: longest time of a stage, s.
        memory: most memory of a process, MB; None: what there is.
        again: whether what failed is tried again though its input is the same.
        with_parquet: whether the table is written as Parquet too.
        say: called with one line for each entry.

    Returns:
        The rows of this run's share, in the manifest's order.

    Raises:
        BadInput: the folder holds something else, or cannot be written.
    """
    store = Store(folder)
    store.begin()
    keyed = [_keyed(store, entry) for entry in manifest.entries]
    mine = [(entry, key) for entry, key in keyed[shard[0] - 1 :: shard[1]] if isinstance(key, str)]
    for entry, key in mine:
        if why := store.changed(entry.name, key):
            say(f"{entry.name}: what was kept is not as it was written ({why}); it is done again")
    failed = {entry.name for entry, key in mine if again and _failed(store.outcome(entry.name, key))}
    tried: set[tuple[str, str]] = set()
    for stage in ("identify", "diagnose"):
        while open_ones := _open(store, mine, stage, tried, failed):
            free = [(entry, key) for entry, key in open_ones if not store.busy(key)]
            if not free:
                time.sleep(_SOON)  # another run is at them; where it ends without a result they come back
                continue
            tasks = [
                _task(store, entry, key, stage, limit=limit, memory=memory, again=entry.name in failed)
                for entry, key in free
            ]
            _done(engine, tasks, tried, say)
    rows = [_row(store, entry, key) for entry, key in keyed]
    write_tables(manifest, folder, rows, with_parquet=with_parquet)
    return rows[shard[0] - 1 :: shard[1]]


def write_tables(manifest: Manifest, folder: Path, rows: Sequence[Row], *, with_parquet: bool = False) -> None:
    """Write what stands in the store as CSV, JSON and a page, all or none of them."""
    from ..report.fleet_page import fleet_page

    contents: dict[str, str | bytes] = {CSV: csv_text(rows), PAGE: fleet_page(manifest.path.name, rows).html}
    if with_parquet:
        contents[PARQUET] = parquet(rows)
    with together():
        for name, content in contents.items():
            write(folder / name, content)
        write(folder / FLEET, sealed({**as_json(rows), "files": _digests(folder)}))


def _digests(folder: Path) -> dict[str, str]:
    """Hash of each table that is written beside."""
    return {name: digest(content) for name, content in written_below(folder).items() if content is not None}


def _keyed(store: Store, entry: Entry) -> tuple[Entry, str | BadInput]:
    try:
        key = key_of(entry)
        store.check_writable(entry.name, key)
        return entry, key
    except BadInput as problem:  # a file that is not there spoils one row, and is looked for again
        return entry, problem


def _failed(outcome: Outcome | None) -> bool:
    return outcome is not None and outcome.state in ("bad-input", "fault")


def _open(
    store: Store, mine: Sequence[tuple[Entry, str]], stage: str, tried: set[tuple[str, str]], failed: set[str]
) -> list[tuple[Entry, str]]:
    """The entries that a stage is still to be done for; each is tried once in a run."""
    found = []
    for entry, key in mine:
        if (entry.name, stage) in tried:
            continue
        outcome = store.outcome(entry.name, key)
        if stage == "identify":
            todo = outcome is None or (outcome.stage == "identify" and outcome.state in TRIED_AGAIN)
        else:
            todo = outcome is not None and outcome.wanted
        if todo or (entry.name in failed and outcome is not None and outcome.stage == stage):
            found.append((entry, key))
    return found


def _task(store: Store, entry: Entry, key: str, stage: str, *, limit: float, memory: float | None, again: bool) -> Task:
    place = str(store.folder.resolve())
    document = asdict(entry)
    for name in ("recordings", "holdout", "laws"):  # a worker may run in another folder
        document[name] = [os.path.abspath(file) for file in document[name]]  # noqa: PTH100  a name may hold # and a record
    document["start"] = None if entry.start is None else str(Path(entry.start).resolve())
    return {
        **{"store": place, "entry": document, "key": key, "stage": stage},
        **{"limit": limit, "memory": memory, "again": again, "command": made_by().command},
    }


def _done(engine: Engine, tasks: list[Task], tried: set[tuple[str, str]], say: Callable[[str], None]) -> None:
    begun, count = time.monotonic(), 0
    for task, answer in engine(tasks):
        name, stage = task["entry"]["name"], task["stage"]
        count += 1
        outcome = from_json(answer.get("outcome"))
        if outcome is None:  # another run is at it: asked for again
            continue
        tried.add((name, stage))
        rest = (time.monotonic() - begun) / count * (len(tasks) - count)
        seconds = outcome.seconds.get(stage, 0.0)
        say(
            f"{stage} {count}/{len(tasks)}  {name}: {outcome.state}, {seconds:.1f} s"
            + (f"; about {_span(rest)} to go" if rest > 2 else "")
        )


def _span(seconds: float) -> str:
    return (
        f"{seconds:.0f} s"
        if seconds < 90
        else f"{seconds / 60:.0f} min"
        if seconds < 5400
        else f"{seconds / 3600:.1f} h"
    )


def _row(store: Store, entry: Entry, key: str | BadInput) -> Row:
    if isinstance(key, BadInput):
        return Row(entry, Outcome("", entry.name, "bad-input", str(key)), None)
    outcome = store.outcome(entry.name, key) or Outcome(key, entry.name, "open", "not done yet")
    place = store.place(entry.name, key)
    return Row(entry, outcome, place.relative_to(store.folder) if outcome.state != "open" else None)

"""One stage of one entry of a fleet, in a process of its own: identified or diagnosed, and kept in the store.

Whatever ends this process spoils one row. The task comes as a line of JSON on stdin, the answer goes as one to stdout.
When stdin ends, whoever asked is gone, and so is this process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput, Unwritable
from ..files.exit_codes import out_of_memory, sentence
from ..files.made_by import typed
from ..files.writing import together, write
from ..fleet.kept_files import DIAGNOSIS
from ..fleet.manifest import Entry
from ..fleet.outcome import Outcome
from ..fleet.store import Busy, Store
from . import batch_element
from .row import curve_of, page_or_why, parameters_of, picture_of
from .workflow import diagnosed, identified, page_of_diagnosis, prescribed_beside, read_all

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..recording import Recording

MODEL, REPORT = "model.yaml", "report.html"
_READ = {"max_size": 500.0, "calibration": {}} | dict.fromkeys(
    (
        "time",
        "force",
        "quantity",
        "unit",
        "force_unit",
        "fs",
        "part",
        "amplitude",
        "hold",
        "base",
        "relative",
        "through",
        "prescribed",
    )
)


def main() -> None:
    """The process: one task."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    task = json.loads(sys.stdin.buffer.readline())
    threading.Thread(target=_end_with_whoever_asked, daemon=True).start()
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as out:
        with open(os.devnull, "wb") as nothing:  # noqa: PTH123  what libraries print is no answer
            os.dup2(nothing.fileno(), 1)
        _bounded(task["memory"])
        with typed(task.get("command", "")):
            out.write(json.dumps(done(task)) + "\n")
        out.flush()
        os._exit(0)  # nothing that libraries do at their end can spoil what was kept


def _end_with_whoever_asked() -> None:
    while sys.stdin.buffer.read(4096):
        pass
    with suppress(OSError, AttributeError):
        os.killpg(0, signal.SIGKILL)  # all that this process started
    os._exit(1)


def _bounded(megabytes: float | None) -> None:
    if megabytes is None:
        return
    import resource

    limit = int(megabytes * 1e6)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def done(task: Mapping[str, Any]) -> dict[str, Any]:
    """Do a task: ``store``, ``entry``, ``key`` and ``stage``; ``again`` does what failed before.

    Returns:
        ``{"outcome": ...}``; ``{"busy": true}`` where another run is at it; ``{"refused": sentence}`` where the store
        cannot be written.
    """
    values: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in task["entry"].items()}
    entry = Entry(**values)
    key, stage = task["key"], task["stage"]
    try:
        store = Store(Path(task["store"]))
        with store.held(key):
            before = store.outcome(entry.name, key)
            open_still = before is None or not (before.finished or (stage == "identify" and before.wanted))
            if before is not None and not open_still and not task["again"]:
                return {"outcome": before.as_json()}  # another run has done it meanwhile
            return {"outcome": _kept(store, entry, key, stage, before).as_json()}
    except Busy:
        return {"busy": True}
    except BadInput as problem:
        return {"refused": str(problem)}


def _kept(store: Store, entry: Entry, key: str, stage: str, before: Outcome | None) -> Outcome:
    """Do a stage and keep what came of it; raises BadInput only where that, or what it takes, cannot be written."""
    begun = time.monotonic()
    place = store.place(entry.name, key)
    try:
        if stage == "identify":
            outcome, files = _identified(entry, key)
        else:
            outcome, files = _diagnosed(entry, place, before or Outcome(key, entry.name, "open", ""))
    except Unwritable:  # no fault of the row, which is open still
        raise
    except Exception as problem:  # each row has its own end
        if isinstance(problem, OSError):
            raise Unwritable(sentence(problem)) from problem
        seconds = time.monotonic() - begun
        if isinstance(problem, BadInput):
            return store.failed(entry.name, key, stage, "bad-input", str(problem), seconds)
        state = "memory" if out_of_memory(problem) else "fault"
        return store.failed(entry.name, key, stage, state, sentence(problem), seconds)
    seconds = {**outcome.seconds, stage: round(time.monotonic() - begun, 3)}
    outcome = replace(outcome, seconds=seconds)
    with together():
        files(place)
        return store.keep(outcome)


def _recordings(entry: Entry, say: Callable[[str], None], *, held_out: bool = False) -> list[Recording]:
    from ..recording.channel import of_part, stated_channels

    files, count = (entry.recordings, entry.holdout)[held_out], len(entry.recordings)
    span = (count, None) if held_out else (0, count)
    stated = of_part(stated_channels(entry.reading.get("channels") or {}), *span, count + len(entry.holdout))
    options = {**_READ, **entry.reading, "response": tuple(entry.reading.get("response", ())), "channels": stated}
    return read_all(tuple(map(Path, files)), options, say)


def _prescribed(entry: Entry) -> bool:
    """Whether the motion of an entry was imposed, as the manifest or a file beside its recordings says."""
    return prescribed_beside([Path(file) for file in entry.recordings], entry.reading.get("prescribed")) is not None


def _with_laws(entry: Entry) -> None:
    from ..model.user_laws import load_law_file

    for law in entry.laws:
        load_law_file(law)


def _identified(entry: Entry, key: str) -> tuple[Outcome, Callable[[Path], None]]:
    """The model of an entry, and what writes its files."""
    from ..model.file import save
    from ..model.fit_state import beyond, left_over, parse_most_left
    from ..report.page import identification_page

    _with_laws(entry)
    said: list[str] = []
    how = entry.how

    def read() -> list[Recording]:
        return _recordings(entry, said.append)

    if _prescribed(entry):
        return batch_element.identified(entry, key, read, said, model=MODEL, report=REPORT)
    found = identified(
        read,
        name=entry.name,
        laws=how["with"],
        fixed=how["fix"],
        start=None if entry.start is None else Path(entry.start),
        mode=how["mode"],
        faults=how["faults"],
        notes=said.append,
    )
    model = found.oscillator
    most = how["max_left"]
    unexplained = [] if found.unexplained is None else [found.unexplained]
    more = [*left_over(model), *unexplained] if most is None else beyond(model, parse_most_left(most))
    unfit = bool(more or found.useless or found.modes_left)
    page, without = page_or_why(how["report"], lambda: identification_page(found, files=(MODEL,)).html)
    picture, left = _picture(found)
    outcome = Outcome(
        key=key,
        name=entry.name,
        state="doubtful" if unfit or found.faults else "good",
        sentence=_sentence(found, more),
        wanted=how["diagnose"] == "always" or (unfit and how["diagnose"] == "unfit"),
        parameters=parameters_of(model),
        curve=curve_of(model),
        recordings=tuple(dict(r) for r in model.identified.recordings),
        model=MODEL,
        picture=picture,
        left=left,
        page=None if page is None else REPORT,
        notes=tuple(dict.fromkeys([*(s.removeprefix("note: ") for s in said), *found.notes, *without])),
    )

    def files(place: Path) -> None:
        save(model, place / MODEL)
        if page is not None:
            write(place / REPORT, page)

    return outcome, files


def _sentence(found: Identification, more: list[str]) -> str:
    said = (found.useless, *found.faults, found.modes_left, *more)
    return next(filter(None, said), "the model leaves no more than it may")


def _diagnosed(entry: Entry, place: Path, before: Outcome) -> tuple[Outcome, Callable[[Path], None]]:
    """What a diagnosis makes of an entry, and what writes its files."""
    from ..diagnose.files import MODEL as MENDED
    from ..diagnose.files import REPORT as PAGE
    from ..diagnose.files import write_folder
    from ..model.file import load

    _with_laws(entry)
    said: list[str] = []
    training, held = (_recordings(entry, said.append, held_out=held_out) for held_out in (False, True))
    if _prescribed(entry):
        return batch_element.diagnosed(entry, before, training, held)
    model = load(place / MODEL)
    found, fmu = diagnosed(model, training, held, mode=entry.how["mode"], notes=said.append)
    page, without = page_or_why(True, lambda: page_of_diagnosis(found, fmu).html)
    whole = found.remainder is None
    state = "good" if found.verdict == "consistent" else "mended" if found.mended and whole else "doubtful"
    outcome = replace(
        before,
        state=state,
        sentence=found.sentence,
        stage="diagnose",
        wanted=False,
        attempts=0,
        verdict=found.verdict,
        effects=tuple(effect.effect for effect in found.effects),
        parameters=parameters_of(found.model) if found.mended else before.parameters,
        curve=curve_of(found.model) if found.mended else before.curve,
        recordings=tuple(dict(r) for r in found.model.identified.recordings) if found.mended else before.recordings,
        left=() if found.mended else before.left,
        model=f"{DIAGNOSIS}/{MENDED}" if found.mended else before.model,
        page=before.page if page is None else f"{DIAGNOSIS}/{PAGE}",
        notes=tuple(dict.fromkeys([*before.notes, *found.notes, *without])),
    )

    def written(folder: Path) -> None:
        write_folder(folder / DIAGNOSIS, found, page or "".join(without), fmu)

    return outcome, written


def _picture(found: Identification) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The size of the first recording's motion in each part of its time, 0 to 1, and of what the model leaves of it."""
    import numpy as np

    recording = found.recordings[0]
    motion = recording.response - recording.response.mean()
    left = np.zeros(recording.n)
    for part in found.fit.segments:
        if part.segment.recording == 0:
            left[part.segment.start : part.segment.stop] = part.segment.response - part.simulated
    return picture_of(motion, left)

"""In place of ``batch_entry``: the name of an entry says what becomes of it; each begin is noted."""

from __future__ import annotations

import errno
import os
import signal
import time
from pathlib import Path

from dashpot.errors import BadInput, Unwritable
from dashpot.face import batch_entry
from dashpot.files.writing import write
from dashpot.fleet.outcome import Outcome


def noted(entry, stage):
    with Path(os.environ["BEGUN"]).open("a", encoding="utf-8") as file:
        file.write(f"{stage} {entry.name}\n")
        file.flush()
    time.sleep(float(os.environ.get("TAKES", "0")))


def happens(name):
    if "crash" in name:
        os.kill(os.getpid(), signal.SIGSEGV)
    if "slow" in name:
        time.sleep(600)
    if "hungry" in name:
        bytearray(8_000_000_000)
    if "memory" in name:
        raise MemoryError
    if "bad" in name:
        raise BadInput("no such thing")
    if "full" in name and not Path(os.environ["BEGUN"]).with_name("room").exists():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "results.csv")
    if "place" in name and not Path(os.environ["BEGUN"]).with_name("room").exists():
        raise Unwritable("/tmp takes nothing")
    if "fault" in name:
        raise ValueError("a mistake")


def identified(entry, key):
    noted(entry, "identify")
    if "later" not in entry.name:
        happens(entry.name)
    unfit = "unfit" in entry.name
    outcome = Outcome(key, entry.name, "doubtful" if unfit else "good", "", wanted=unfit, model="model.yaml")
    return outcome, lambda place: write(place / "model.yaml", "model")


def diagnosed(entry, place, before):
    noted(entry, "diagnose")
    happens(entry.name)
    outcome = batch_entry.replace(before, state="mended", stage="diagnose", wanted=False, verdict="missing-physics")
    return outcome, lambda folder: write(folder / "diagnosis" / "model.yaml", "mended")


batch_entry._identified = identified
batch_entry._diagnosed = diagnosed
main = batch_entry.main

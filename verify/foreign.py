"""The process in which an FMU runs, alone: whatever it does to it, the process that asks goes on.

What the FMU writes to its output goes nowhere, its working folder is that which it was unpacked into, and when the
asking process is gone this one ends and removes that folder.
"""

from __future__ import annotations

import os
import shutil
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from ..errors import BadInput
from .messages import receive, send

#: How often is said that the FMU still makes steps, and looked whether anybody listens, s.
_BEAT = 0.5
#: The largest file that an FMU may write.
_LARGEST_FILE = 1024**3


class _Host:
    """What answers: its one FMU, and the thread that says that it is alive while steps are made."""

    def __init__(self, replies: BinaryIO, folder: Path, shown: str) -> None:
        self.replies, self.folder, self.shown = replies, folder, shown
        self.lock = threading.Lock()
        self.slave: Any = None
        self.asking = os.getppid()
        threading.Thread(target=self._watch, daemon=True).start()

    def _watch(self) -> None:
        seen = -1
        while True:
            time.sleep(_BEAT)
            if os.getppid() != self.asking:
                shutil.rmtree(self.folder, ignore_errors=True)
                os._exit(1)
            made = getattr(self.slave, "made", seen)
            if made != seen:
                seen = made
                self.reply({"alive": True})

    def reply(self, head: dict[str, Any], numbers: bytes = b"") -> None:
        """Send one message, from whichever thread."""
        with self.lock, suppress(OSError):
            send(self.replies, head, numbers)

    def open(self) -> dict[str, Any]:
        """Load the FMU; what it says of itself."""
        from .slave import opened

        description, self.slave = opened(self.folder, self.shown)
        return {
            "orders": self.slave.orders,
            "variables": [
                {
                    "name": v.name,
                    "reference": v.valueReference,
                    "causality": v.causality,
                    "variability": v.variability,
                    "unit": v.unit or (v.declaredType.unit if v.declaredType else None),
                    "description": v.description,
                    "start": None if v.start is None else str(v.start),
                }
                for v in description.modelVariables
            ],
        }

    def record(self, head: dict[str, Any], numbers: bytes) -> bytes:
        """One run; the output at its samples."""
        import numpy as np

        from .slave import run

        rows, jumps = np.frombuffer(numbers), None
        if head["jumps"]:
            rows, jumps = rows[: -head["jumps"]], rows[-head["jumps"] :].tolist()
        table = rows.reshape(-1, self.slave.columns).tolist() if head["pushed"] else None
        return run(self.slave, head, table, jumps).tobytes()

    def answer(self, head: dict[str, Any], numbers: bytes) -> None:
        """Do what is asked and say what came of it."""
        from .slave import Stopped

        try:
            result: dict[str, Any] = {}
            out = b""
            if head["do"] == "open":
                result = self.open()
            elif head["do"] == "record":
                out = self.record(head, numbers)
            elif head["do"] == "end" and self.slave is not None:
                self.slave.close()
            said = [] if self.slave is None else [str(text) for text in self.slave.said]
            if self.slave is not None:
                self.slave.said.clear()
            self.reply({**result, "said": said}, out)
        except BadInput as problem:
            self.reply({"refused": str(problem)})
        except Stopped as stopped:
            self.failed(stopped.__cause__ or stopped, stopped.reached.tobytes())
        except Exception as problem:
            self.failed(problem)

    def failed(self, problem: BaseException, reached: bytes = b"") -> None:
        """Say what FMPy says of one of the FMU's calls, or does not foresee, and how far the run came."""
        said: object = problem
        if self.slave is not None and self.slave.said:
            said = self.slave.said[-1]
            self.slave.said.clear()
        self.reply({"failed": " ".join(str(said).split()).rstrip(".")[:200] or type(problem).__name__}, reached)


def main() -> None:
    """Answer until nothing more is asked: arguments are the unpacked FMU's folder and the name to call it by."""
    asked, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nowhere, descriptor)
    with suppress(ImportError, ValueError, OSError):  # Windows has no such limits
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (_LARGEST_FILE, _LARGEST_FILE))
    host = _Host(replies, Path(sys.argv[1]), sys.argv[2])
    import fmpy.fmi2  # noqa: F401  while the asking process unpacks
    import numpy  # noqa: F401  pyright: ignore

    host.reply({"alive": True})  # from here on it is the FMU that takes the time
    while (message := receive(asked)) is not None:
        host.answer(*message)
        if message[0].get("do") == "end":
            break
    os._exit(0)  # an FMU's own words at the end of a process are not waited for

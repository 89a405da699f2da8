"""The asking side of the process that an FMU runs in: a question, a time limit, an answer or a sentence why not."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any, BinaryIO, cast

from ..errors import BadInput
from ..files import process_group
from .messages import packed, receive
from .pipe_ends import MOMENT, Reader, Writer

#: Longest time without a step that the FMU finished, s; ``dashpot verify --time-limit`` sets another.
TIME_LIMIT = 30.0
#: For Python to start, on however busy a machine.
_START = 120.0
_GOODBYE = 3.0


class FmuProcess:
    """A process of its own for one FMU; it begins to start at once.

    Args:
        folder: where the FMU is unpacked, and may write.
        shown: its name in messages.
        limit: longest time without an answer or a finished step, s.
    """

    def __init__(self, folder: Path, shown: str, limit: float = TIME_LIMIT) -> None:
        self.shown, self.limit = shown, limit
        paths = os.pathsep.join(path for path in sys.path if path)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", "from dashpot.verify.foreign import main; main()", str(folder), shown],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": paths},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # so that all it starts can be ended with it
        )
        asked, said = cast(BinaryIO, self._process.stdin), cast(BinaryIO, self._process.stdout)
        self._asked = Writer(os.dup(asked.fileno()), lambda: self._process.poll() is not None)
        self._said = Reader(os.dup(said.fileno()))
        for stream in (asked, said):  # of which a buffered one is locked while it is read
            stream.close()
        self._answers: queue.Queue[tuple[dict[str, Any], bytes] | None] = queue.Queue(maxsize=4)
        self._fresh = True
        threading.Thread(target=self._listen, daemon=True, name="fmu listener").start()

    def _listen(self) -> None:
        """Hand on what is said, until the pipe is closed, ``close`` ends it, or no message comes."""
        message: tuple[dict[str, Any], bytes] | None = ({}, b"")
        while message is not None:
            message = None
            with contextlib.suppress(OSError, ValueError, RecursionError):
                message = receive(self._said)
            while not self._said.ended:
                with contextlib.suppress(queue.Full):
                    self._answers.put(message, timeout=MOMENT)
                    break
        self._said.close()

    def ask(self, head: dict[str, Any], numbers: bytes = b"", *, doing: str) -> tuple[dict[str, Any], bytes]:
        """The answer to a question.

        Args:
            head: with ``do``, what to do.
            numbers: that go with it.
            doing: the same in words, to follow "the FMU ... while".

        Raises:
            BadInput: where the FMU refuses, ends or breaks its process, or takes longer than the limit.
        """
        wait = max(self.limit, _START) if self._fresh else self.limit
        with contextlib.suppress(OSError):  # it has gone: the answer says so
            if not self._asked.write(packed(head, numbers), wait) and self._process.poll() is None:
                raise self._too_long(wait, doing)
        while True:
            answer = self._next(wait, doing)
            self._fresh = False
            if answer is None:
                raise BadInput(f"{self.shown}: {self._gone()} {doing}; such an FMU cannot be used")
            if "alive" in answer[0]:
                wait = self.limit
                continue
            if "refused" in answer[0]:
                raise BadInput(str(answer[0]["refused"]))
            return answer

    def _next(self, wait: float, doing: str) -> tuple[dict[str, Any], bytes] | None:
        """The next message; None where there is none to come, also because the process is over.

        The pipe alone does not tell that: a process that the FMU left may hold the other end of it open.
        """
        until = time.monotonic() + wait
        while (left := until - time.monotonic()) > 0:
            over = self._process.poll() is not None  # before the look: what it said until then is there by now
            with contextlib.suppress(queue.Empty):
                return self._answers.get(timeout=2 * MOMENT if over else min(left, MOMENT))
            if over:
                return None
        raise self._too_long(wait, doing)

    def _too_long(self, wait: float, doing: str) -> BadInput:
        process_group.end(self._process)
        return BadInput(
            f"{self.shown}: the FMU did not get on for {wait:g} s {doing}; mend it, or give it more "
            "time with --time-limit"
        )

    def _gone(self) -> str:
        """How the process ended, in words."""
        try:
            code = self._process.wait(_GOODBYE)
        except subprocess.TimeoutExpired:
            return "the FMU closed what it has to answer by"
        if code >= 0:
            return f"the FMU ended the process that it runs in (exit code {code})"
        with contextlib.suppress(ValueError):
            return f"the FMU crashed ({signal.Signals(-code).name})"
        return f"the FMU crashed (signal {-code})"

    def close(self) -> None:
        """End the process and all that it started."""
        if self._process.poll() is None and not self._fresh:
            limit, self.limit = self.limit, min(self.limit, _GOODBYE)
            with contextlib.suppress(BadInput):
                self.ask({"do": "end"}, doing="at its end")
            self.limit = limit
        process_group.end(self._process)
        self._asked.close()
        self._said.end()

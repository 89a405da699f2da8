"""A task in a process of its own, with a time limit: what ends the process ends that task and nothing else."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..files import process_group
from .store import Busy, Store

_PROGRAM = "import sys; sys.path[:0] = {path!r}; from {module} import main; main()"


class Children:
    """Processes that work on tasks; ``end`` ends all of them.

    Args:
        module: whose ``main`` reads a task as a line of JSON on stdin and answers with one on stdout.
    """

    def __init__(self, module: str) -> None:
        self._line = [sys.executable, "-P", "-c", _PROGRAM.format(path=[p for p in sys.path if p], module=module)]
        self._running: set[subprocess.Popen[bytes]] = set()
        self._ended = False

    def answer(self, task: Mapping[str, Any]) -> dict[str, Any]:
        """What became of a task, as ``done`` of the module has it; what did not end by itself is kept so.

        Raises:
            BadInput: the store cannot be written, or ``end`` was called.
        """
        process = subprocess.Popen(
            self._line,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # so that all it starts can be ended with it
        )
        self._running.add(process)
        try:
            if self._ended:
                raise BadInput("the run was ended")
            return self._waited_for(process, task)
        finally:
            _end(process)
            self._running.discard(process)

    def _waited_for(self, process: subprocess.Popen[bytes], task: Mapping[str, Any]) -> dict[str, Any]:
        assert process.stdin is not None
        assert process.stdout is not None
        limit, stage = task["limit"], task["stage"]
        with contextlib.suppress(OSError):  # it has gone: its end says so
            process.stdin.write(json.dumps(task).encode() + b"\n")
            process.stdin.flush()  # and left open: its end would end the process
        try:
            code = process.wait(limit)
        except subprocess.TimeoutExpired:
            _end(process)
            return _failed(task, "timeout", f"{stage} took longer than {limit:g} s (--time-limit) and was ended", limit)
        if self._ended:
            raise BadInput("the run was ended")
        with contextlib.suppress(ValueError):
            if os.name == "posix":  # what it started may hold the pipe open; all that it said itself is in there
                os.set_blocking(process.stdout.fileno(), False)
            answer = json.loads(process.stdout.read() or b"")
            if "refused" in answer:
                raise BadInput(answer["refused"])
            return answer
        how = f"exit code {code}"
        if code < 0:
            with contextlib.suppress(ValueError):
                how = signal.Signals(-code).name
        return _failed(
            task, "killed", f"{stage}: its process was ended ({how}); it is tried again in the next run", 0.0
        )

    def end(self) -> None:
        """End all of them."""
        self._ended = True
        for process in tuple(self._running):
            _end(process)


def _failed(task: Mapping[str, Any], state: Any, sentence: str, seconds: float) -> dict[str, Any]:
    """Keep that a task did not end well, unless another run is at it, or has done it meanwhile."""
    store, name, key = Store(Path(task["store"])), task["entry"]["name"], task["key"]
    try:
        with store.held(key):
            there = store.outcome(name, key)
            done = there is not None and (there.finished or (task["stage"] == "identify" and there.wanted))
            if there is not None and done and not task["again"]:
                return {"outcome": there.as_json()}
            return {"outcome": store.failed(name, key, task["stage"], state, sentence, seconds).as_json()}
    except Busy:
        return {"busy": True}


def _end(process: subprocess.Popen[bytes]) -> None:
    process_group.end(process)
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with contextlib.suppress(OSError):
                stream.close()

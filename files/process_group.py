"""Ending a process with all that it started."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from typing import Any


def end(process: subprocess.Popen[Any]) -> None:
    """Kill a process that leads a session of its own (``start_new_session``) and what it started; wait for its end.

    What it started is ended where it is over itself, too: a group exists as long as one of its processes. Where there
    are no groups of processes (Windows), the process alone is killed.
    """
    with contextlib.suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()
    process.wait()

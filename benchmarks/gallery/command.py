"""One command of the product in a process of its own, with a limit in time: what a user would see of it."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from dashpot.files import process_group

_DASHPOT = (sys.executable, "-P", "-m", "dashpot")
_TRACEBACK = "Traceback (most recent call last)"


@dataclass(frozen=True)
class Run:
    """A command that was run.

    Attributes:
        arguments: after ``dashpot``.
        exit_code: None where it was stopped at the limit.
        seconds: it took.
        last_line: of stderr; what a refusal says.
        notes: lines of stderr that begin with ``note:``, without that.
        traceback: whether it broke down instead of saying what is wrong.
    """

    arguments: tuple[str, ...]
    exit_code: int | None
    seconds: float
    last_line: str
    notes: tuple[str, ...]
    traceback: bool

    @property
    def end(self) -> str:
        """``done`` (0 or 1), ``refused`` (2, one line), ``timeout``, or ``fault``: a breakdown, a signal."""
        if self.exit_code is None:
            return "timeout"
        if self.traceback or self.exit_code not in (0, 1, 2):
            return "fault"
        return "refused" if self.exit_code == 2 else "done"


def run(arguments: Sequence[str], folder: Path, limit: float) -> Run:
    """Run ``dashpot`` with these arguments in a folder, for at most so many seconds; output is added to its log.txt."""
    began = time.monotonic()
    process = subprocess.Popen(
        [*_DASHPOT, *arguments],
        cwd=folder,
        env={"DASHPOT_SECONDS": "inf"} | os.environ,  # what is found may not depend on the speed of the machine
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,  # so that what the command itself started ends with it
    )
    exit_code: int | None
    try:
        out, err = process.communicate(timeout=limit)
        exit_code = process.returncode
    except subprocess.TimeoutExpired:
        process_group.end(process)
        out, err = process.communicate()
        exit_code = None
    seconds = time.monotonic() - began
    with (folder / "log.txt").open("a", encoding="utf-8") as log:
        log.write(f"$ dashpot {' '.join(arguments)}\n{out}{err}exit code {exit_code} after {seconds:.1f} s\n\n")
    return read_run(tuple(arguments), exit_code, seconds, err)


def read_run(arguments: tuple[str, ...], exit_code: int | None, seconds: float, err: str) -> Run:
    """What the stderr of a command that ended so tells."""
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    notes = tuple(line.removeprefix("note: ") for line in lines if line.startswith("note: "))
    return Run(arguments, exit_code, seconds, lines[-1] if lines else "", notes, _TRACEBACK in err)

"""A command that meets its end, or a full disk, at instants of any kind: what it then leaves.

    interrupted.py FOLDER SEED COUNT COMMAND...

FOLDER holds the inputs and what was there before. The command is run in copies of it, forked from this process, which
has loaded all that it needs: undisturbed first, and then COUNT times with one disturbance each. Disturbances are
SIGKILL, SIGTERM and SIGINT at a random time or at a random one of the command's calls that touch files, folders or
processes; a disk that is full from such a call on; one that takes no file beyond a random size; and memory that ends
after a random size.

Held: the folder is afterwards the one before or the one that was asked for, with nothing beside it (`batch` keeps each
row as it is done: typed again, it makes the one asked for); nothing is left
among temporary files and in the cache, but by SIGKILL: the command's own temporary folder, what a compiler was building
in the cache, or the file by which Python tries where temporary files can be; the exit code is that of the ends, but
where memory ends inside of CasADi, which then ends the process itself (SIGABRT, as if by SIGKILL); and
nobody sees a traceback. Prints as JSON how often each disturbance met which end, and the faults.
"""

from __future__ import annotations

import errno
import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from pathlib import Path

import casadi  # noqa: F401
import matplotlib.pyplot  # noqa: F401
import numpy  # noqa: F401
import scipy.optimize
import scipy.signal  # noqa: F401
from dashpot.commands import cli
from dashpot.files import writing

SIGNALS = {"SIGKILL": signal.SIGKILL, "SIGTERM": signal.SIGTERM, "SIGINT": signal.SIGINT}
KINDS = (*SIGNALS, "full disk", "largest file")
if os.environ.get("DASHPOT_FUZZ"):  # where memory ends a library may do anything
    KINDS += ("memory",)
#: Bytes that a command may take beyond what it has when it begins, at most: enough for some, too few for others.
ROOM = 100e6
#: Audit events of Python that touch what stays behind.
WATCHED = ("open", "os.", "shutil.", "tempfile.", "subprocess.", "ctypes.dlopen")
LONGEST = 300.0
#: Commands that keep what is done and go on from there, and s that their own processes may take to end.
GO_ON, GRACE = ("batch",), 2.0
if os.environ.get("CARELESS"):  # a program that does not do what is tested here, by which the tests are tested
    writing.run_in_child = lambda work: work()
    KINDS = ("SIGKILL",)


def contents(folder: Path) -> dict[str, bytes | None]:
    """All files of a folder and below it; None for a folder."""
    found = {}
    for path in sorted(folder.rglob("*")):
        try:
            found[path.relative_to(folder).as_posix()] = path.read_bytes() if path.is_file() else None
        except FileNotFoundError:
            return contents(folder)  # it is at work still
    return found


def disturb(kind: str, at: float, command: int) -> None:
    """In the command's process: see to it that the disturbance comes; ``at`` counts calls, or bytes."""
    if kind == "memory":
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + int(at), resource.RLIM_INFINITY))
        return
    if kind == "largest file":
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(at), resource.RLIM_INFINITY))
        return
    calls = 0

    def meet(event: str, given: tuple) -> None:
        nonlocal calls
        if not event.startswith(WATCHED):
            return
        calls += 1
        if kind == "none":
            os.write(9, b".")
        elif kind in SIGNALS and calls == at:
            os.kill(command, SIGNALS[kind])
        elif kind == "full disk" and calls >= at and makes(event, given):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), given[0] if isinstance(given[0], str) else None)

    sys.addaudithook(meet)


def makes(event: str, given: tuple) -> bool:
    """Whether an event makes something on a disk."""
    if event == "open":
        flags = given[2] if isinstance(given[2], int) else 0
        return bool(flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)) and given[0] != os.devnull
    return event in ("os.mkdir", "os.link")


class Run:
    """One run of a command in a copy of a folder."""

    def __init__(self, given: Path, cache: Path, arguments: list[str], kind: str = "none", at: float = 0.0) -> None:
        self.place = Path(tempfile.mkdtemp(prefix="instant-"))
        self.work, self.temporary, self.cache = (self.place / name for name in ("work", "tmp", "cache"))
        shutil.copytree(given, self.work)
        shutil.copytree(cache, self.cache)
        self.cache.chmod(0o700)
        self.temporary.mkdir()
        self.arguments = arguments
        self.start(kind, at)

    def start(self, kind: str = "none", at: float = 0.0) -> None:
        """Begin the command, in the folder as it is."""
        heard, said = os.pipe()
        counted, count = os.pipe()
        self.began = time.monotonic()
        self.process = os.fork()
        if self.process == 0:
            self._command(self.arguments, kind, at, said, count)
        os.close(said)
        os.close(count)
        self.heard, self.counted = heard, counted

    def _command(self, arguments: list[str], kind: str, at: float, said: int, count: int) -> None:
        code = 99
        try:
            os.dup2(said, 1)
            os.dup2(said, 2)
            os.dup2(count, 9)
            os.chdir(self.work)
            os.environ["DASHPOT_CACHE"], os.environ["TMPDIR"] = str(self.cache), str(self.temporary)
            tempfile.tempdir = None
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # as at the start of the command; a background job ignores it
            disturb(kind, at, os.getpid())
            try:
                cli.main(arguments)
                code = 0
            except SystemExit as end:
                code = end.code if isinstance(end.code, int) else 0 if end.code is None else 98
        finally:
            sys.stderr.flush()
            os._exit(code)

    def end(self) -> int:
        """Wait for the end; the exit code, or minus the signal's number."""
        os.set_blocking(self.heard, False)
        self.words, self.calls = b"", 0
        while True:
            pid, status = os.waitpid(self.process, os.WNOHANG)
            for stream in (self.heard, self.counted):
                os.set_blocking(stream, False)
                try:
                    piece = os.read(stream, 1 << 20)
                except BlockingIOError:
                    continue
                if stream == self.heard:
                    self.words += piece
                else:
                    self.calls += len(piece)
            if pid:
                break
            if time.monotonic() - self.began > LONGEST:
                os.kill(self.process, signal.SIGKILL)
                self.words += b"Traceback: it hung"
            time.sleep(0.002)
        self.took = time.monotonic() - self.began
        os.close(self.heard)
        os.close(self.counted)
        return os.waitstatus_to_exitcode(status)

    def left(self) -> list[str]:
        """What lies among temporary files, and unfinished in the cache."""
        builds = [path.name for path in self.cache.rglob("build-*")]
        return [path.name for path in self.temporary.iterdir()] + builds


def faults_of(run: Run, kind: str, code: int, before: dict, asked: dict, loose: set[str], usual: int) -> list[str]:
    """What is not as it must be after a disturbed run."""
    found = []
    words, left = run.words.decode(errors="replace"), run.left() if kind != "SIGKILL" else []
    if goes_on := run.arguments[0] in GO_ON and contents(run.work) != before:
        time.sleep(GRACE)
        run.start()
        run.end()
    until = time.monotonic() + 10.0
    while True:  # what was under way when the command was killed is done to its end
        after = contents(run.work)
        same = after.keys() == asked.keys() and all(after[name] == asked[name] for name in asked.keys() - loose)
        if after == before or same or time.monotonic() > until:
            break
        time.sleep(0.01)
    if after != before and not same:
        names = sorted(n for n in after.keys() | before.keys() if after.get(n, 0) != before.get(n, 0))
        found.append(f"the folder is neither: {names}")
    if "Traceback" in words or "fault of dashpot" in words or "Exception ignored" in words:
        found.append(words[-800:])
    if kind == "SIGKILL":
        allowed = {-signal.SIGKILL, usual}
    elif kind in SIGNALS:
        allowed = {130, usual, -SIGNALS[kind]}
    else:
        allowed = {2, usual}
    aborted = kind == "memory" and code == -signal.SIGABRT and "std::bad_alloc" in words
    if code not in allowed and not aborted:
        found.append(f"exit code {code}: {words[-300:]}")
    if code == usual and usual in (0, 1) and kind != "SIGKILL" and not same and not goes_on:
        found.append("says that all is done, and it is not")
    if code == 2 and usual != 2 and "dashpot: " not in words:
        found.append("refused without a word")
    if left and not aborted:
        found.append(f"left behind: {left}")
    return found


def main(folder: Path, seed: int, count: int, arguments: list[str]) -> None:
    """Run the command and its disturbances."""
    dice = random.Random(seed)
    cache = Path(tempfile.mkdtemp(prefix="instants-"))
    first = Run(folder, cache, arguments)
    usual = first.end()
    plain = Run(folder, first.cache, arguments)  # with what was compiled before
    plain.end()
    before, asked = contents(folder), contents(first.work)
    second = contents(plain.work)
    loose = {name for name in asked if second.get(name, 0) != asked[name]}
    largest = max((len(content) for content in asked.values() if content), default=1)
    ends: Counter[str] = Counter()
    faults = []
    for number in range(count):
        kind = KINDS[number % len(KINDS)]
        timed = kind in SIGNALS and dice.random() < 0.5
        most = {"largest file": largest, "memory": int(ROOM)}.get(kind, plain.calls + 1)
        at = dice.randrange(1, max(2, most))
        cold = dice.randrange(20) == 0
        run = Run(folder, cache if cold else first.cache, arguments, "timed" if timed else kind, at)
        if timed:
            time.sleep(dice.uniform(0.0, plain.took))
            with suppress(ProcessLookupError):
                os.kill(run.process, SIGNALS[kind])
        code = run.end()
        ends[f"{kind}: {code}"] += 1
        for fault in faults_of(run, kind, code, before, asked, loose, usual):
            faults.append(f"{number} {kind} at {'a time' if timed else at}{' cold' if cold else ''}: {fault}")
        shutil.rmtree(run.place, ignore_errors=True)
    for place in (cache, first.place, plain.place):
        shutil.rmtree(place, ignore_errors=True)
    print(json.dumps({"usual": usual, "calls": plain.calls, "took": plain.took, "ends": ends, "faults": faults}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:])

"""A short piece of work that is done to its end whatever becomes of the process that asked for it.

Files take their places one after another. A process that is ended by force in between (SIGKILL, out of memory) would
leave some of them new and some old, and temporary ones beside them; so a child in a session of its own does it, which
is hit by none of that, while its parent waits. Where there is no such thing as a child that shares what is in memory
(Windows, and macOS, whose libraries do not stand it), the process itself does it, and only an end by force harms.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator

from ..errors import DashpotError

_HELD = {getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)}


def run_in_child(work: Callable[[], None]) -> None:
    """Do ``work``; what it raises is raised here. Signals that ask for an end are heard when it is done."""
    with signals_held():
        if not sys.platform.startswith("linux"):
            work()
            return
        answer, said = os.pipe()
        try:
            with warnings.catch_warnings():
                # Python 3.12 warns of locks that other threads may hold: nothing here takes one but malloc's, and the
                # C library frees that in a child
                warnings.simplefilter("ignore", DeprecationWarning)
                child = os.fork()
        except OSError:  # no room for another process
            os.close(answer)
            os.close(said)
            work()
            return
        if child == 0:
            _child(work, said)
        os.close(said)
        with os.fdopen(answer, "rb") as stream:
            outcome = stream.read()
        with contextlib.suppress(ChildProcessError):  # whoever asked may not keep count of children
            os.waitpid(child, 0)
    problem = pickle.loads(outcome) if outcome else DashpotError("the writing of files was ended by force; try again")
    if problem is not None:
        raise problem


def _child(work: Callable[[], None], said: int) -> None:
    """Work, say what came of it, and end without anything that a process does at its end."""
    try:
        with contextlib.suppress(OSError):
            os.setsid()
        problem: BaseException | None = None
        try:
            work()
        except BaseException as raised:
            problem = raised
        try:
            outcome = pickle.dumps(problem)
        except Exception:
            outcome = pickle.dumps(RuntimeError(f"{type(problem).__name__}: {problem}"))
        with os.fdopen(said, "wb") as stream:
            stream.write(outcome)
    finally:
        os._exit(0)


@contextlib.contextmanager
def signals_held() -> Iterator[None]:
    """Signals that ask for an end are heard behind the block.

    A mask keeps them from this thread alone: another one (of a library's pool) may take them, and then the main thread
    would still run what Python does at a signal. So there that is put off as well.
    """
    heard: list[int] = []
    before = {}
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, _HELD) if hasattr(signal, "pthread_sigmask") else None
    try:
        if threading.current_thread() is threading.main_thread():
            for number in _HELD:
                if signal.getsignal(number) not in (signal.SIG_IGN, None):  # None: set by no Python
                    before[number] = signal.signal(number, lambda number, _: heard.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number in dict.fromkeys(heard):
            signal.raise_signal(number)

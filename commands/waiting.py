"""What a terminal shows while a command works: what it does, and for how long, once that is more than two seconds.

The line stands on stderr, on a terminal alone, and goes before anything else is written there.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

#: After how long a wait is shown, and how often it is shown anew, s.
_LONG, _EVERY = 2.0, 1.0
_WIDEST = 76  # characters: a longer line would wrap, and what wraps cannot be taken back
_CLEAR = "\r\x1b[K"


class Waiting:
    """The line, and the thread that keeps it."""

    def __init__(self, stream: Any, long: float = _LONG, every: float = _EVERY) -> None:
        self.stream, self.long, self.every = stream, long, every
        self.doing, self.silent = "reading", False
        self.began = time.monotonic()
        self.shown = False
        self.lock = threading.RLock()
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self._keep, daemon=True, name="dashpot-waiting")

    def tell(self, doing: str) -> None:
        """Say what is done from now on."""
        with self.lock:
            self.clear()
            self.doing, self.began = doing, time.monotonic()

    def clear(self) -> None:
        """Take the line away."""
        with self.lock:
            if self.shown:
                self._write(_CLEAR)
                self.shown = False

    def _keep(self) -> None:
        while not self.ended.wait(self.every):
            seconds = time.monotonic() - self.began
            with self.lock:
                if seconds >= self.long and not self.silent:
                    self._write(f"{_CLEAR}… {self.doing[:_WIDEST]} ({seconds:.0f} s)")
                    self.shown = True

    def _write(self, text: str) -> None:
        with suppress(OSError, ValueError):  # a terminal that went away
            self.stream.write(text)
            self.stream.flush()


class _Cleared:
    """A stream before whose every text the line goes."""

    def __init__(self, stream: Any, waiting: Waiting) -> None:
        self._stream, self._waiting = stream, waiting

    def write(self, text: str) -> int:
        with self._waiting.lock:
            self._waiting.clear()
            return self._stream.write(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


_now: Waiting | None = None


@contextmanager
def waiting_shown() -> Iterator[None]:
    """While this lasts, a terminal shows what is worked at."""
    global _now
    if _now is not None or sys.stderr is None or not sys.stderr.isatty():
        yield
        return
    out, err = sys.stdout, sys.stderr
    _now = Waiting(err)
    sys.stderr = _Cleared(err, _now)
    if out is not None and out.isatty():
        sys.stdout = _Cleared(out, _now)
    _now.thread.start()
    try:
        yield
    finally:
        _now.ended.set()
        _now.clear()
        sys.stdout, sys.stderr, _now = out, err, None


def doing(what: str) -> None:
    """Say what is worked at from now on, where a terminal shows it."""
    if _now is not None:
        _now.tell(what)


@contextmanager
def another_shows() -> Iterator[None]:
    """While this lasts, something else, such as a bar, shows that work goes on."""
    if _now is not None:
        _now.clear()
        _now.silent = True
    try:
        yield
    finally:
        if _now is not None:
            _now.silent, _now.began = False, time.monotonic()


def silence() -> None:
    """Show nothing until the command ends (``--quiet``)."""
    if _now is not None:
        _now.silent = True

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

from .time_to_go import Reached, in_words

#: After how long a wait is shown, and how often it is shown anew, s.
_LONG, _EVERY = 2.0, 1.0
_WIDEST = 76  # characters: a longer line would wrap, and what wraps cannot be taken back
_BAR = 20  # characters
_CLEAR = "\r\x1b[K"


class Waiting:
    """The line, and the thread that keeps it."""

    def __init__(self, stream: Any, long: float = _LONG, every: float = _EVERY) -> None:
        self.stream, self.long, self.every = stream, long, every
        self.doing, self.silent = "reading", False
        self.began = time.monotonic()
        self.whole: float | None = None  # when a work began whose parts are known
        self.reached: Reached | None = None
        self.shown = False
        self.lock = threading.RLock()
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self._keep, daemon=True, name="dashpot-waiting")

    def tell(self, doing: str, part: float | None = None) -> None:
        """Say what is done from now on, and which part of all is done where that is known."""
        with self.lock:
            self.clear()
            now = time.monotonic()
            if part is not None and self.whole is not None and (self.reached is None or part > self.reached.part):
                self.reached = Reached(part, now - self.whole)
            self.doing, self.began = doing, now

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
                    self._write(f"{_CLEAR}{self._line(seconds)}")
                    self.shown = True

    def _line(self, seconds: float) -> str:
        """What is shown of a work that has been at its step for so long."""
        if self.whole is None or self.reached is None:
            return f"… {self.doing[:_WIDEST]} ({seconds:.0f} s)"
        now, part = time.monotonic() - self.whole, self.reached.part
        left = in_words(self.reached.to_go(now))
        bar = "#" * round(_BAR * part)
        times = f"({now:.0f} s{f', {left}' if left else ''})"
        head = f"[{bar:.<{_BAR}}] {100 * part:.0f} % "
        return f"{head}{self.doing[: _WIDEST - len(head) - len(times)]} {times}"

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


def doing(what: str, part: float | None = None) -> None:
    """Say what is worked at from now on, where a terminal shows it, and which part of all is done where it is known."""
    if _now is not None:
        _now.tell(what, part)


@contextmanager
def counted() -> Iterator[None]:
    """While this lasts, parts of a work that begins now are told, and a bar with the time to go is shown."""
    if _now is not None:
        _now.whole, _now.reached = time.monotonic(), None
    try:
        yield
    finally:
        if _now is not None:
            _now.clear()
            _now.whole, _now.reached = None, None


def silence() -> None:
    """Show nothing until the command ends (``--quiet``)."""
    if _now is not None:
        _now.silent = True

"""How a command ends: done (0; 1: bad news), refused in a sentence (2) or interrupted (130), never in a traceback."""

from __future__ import annotations

import _thread
import os
import shutil
import signal
import sys
import tempfile
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NoReturn

import click

from ..errors import DashpotError, printable
from .forked_writer import signals_held

REFUSED, INTERRUPTED = 2, 130
#: How CasADi and the loader of libraries say that memory has ended.
_NO_MEMORY = ("std::bad_alloc", "failed to map segment", "annot allocate memory")
#: Set to anything, it shows where in the program a fault was.
TRACEBACK = "DASHPOT_TRACEBACK"
#: When an interruption that nothing let through comes again, s.
_SOON = 0.02
_HERE = Path(__file__).parents[1]


def ended(command: Callable[[], Any]) -> None:
    """Run a command; whatever happens in it becomes one of its ends.

    Raises:
        SystemExit: where the end is another than "done".
    """
    for stream in (sys.stdout, sys.stderr):  # a terminal of another encoding must not undo what was done
        with suppress(AttributeError, ValueError, OSError):
            stream.reconfigure(errors="replace")  # pyright: ignore[reportAttributeAccessIssue]  # not every stream has it
    with _terminated_as_interrupted() as interrupted:
        try:
            with _own_temporary_folder():
                command()
            if sys.stdout is not None:
                sys.stdout.flush()
        except Exception as problem:  # some libraries make of an interruption a fault of their own
            _end(KeyboardInterrupt() if interrupted() else problem)
        except BaseException as problem:
            _end(problem)


def _end(problem: BaseException) -> NoReturn:
    if os.environ.get(TRACEBACK) and not isinstance(problem, (SystemExit, click.exceptions.Exit)):
        traceback.print_exception(problem)
    if isinstance(problem, SystemExit) and type(sys.stdout).__name__.endswith("PacifyFlushWrapper"):
        problem = BrokenPipeError()  # of which click makes an end of its own, with 1
    if isinstance(problem, SystemExit):
        raise problem
    if isinstance(problem, click.exceptions.Exit):
        sys.exit(problem.exit_code)
    if isinstance(problem, (KeyboardInterrupt, click.exceptions.Abort)):
        sys.exit(INTERRUPTED)
    if isinstance(problem, click.exceptions.NoArgsIsHelpError):  # `dashpot` alone: the help
        problem.show()
        sys.exit(problem.exit_code)
    if isinstance(problem, click.ClickException):
        context = getattr(problem, "ctx", None)
        where = context.command_path if context else "dashpot"
        _say(f"{problem.format_message().rstrip('.')}; see {where} -h")
        sys.exit(problem.exit_code)
    if isinstance(problem, BrokenPipeError):  # whoever read has read enough
        with suppress(OSError, ValueError, AttributeError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    _say(sentence(problem))
    if isinstance(problem, OSError):  # what is still to be written cannot be
        with suppress(OSError, ValueError, AttributeError):
            sys.stdout.flush()
        with suppress(OSError, ValueError, AttributeError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(REFUSED)


def sentence(problem: BaseException) -> str:
    """The sentence that a user reads about a problem."""
    if isinstance(problem, DashpotError):
        return str(problem)
    if out_of_memory(problem):
        return "there is not enough memory for this; use a part of the recordings (--part), or a lower sampling rate"
    if isinstance(problem, OSError) and problem.strerror:
        what = problem.filename if isinstance(problem.filename, str) else "the system"
        return f"{what}: {problem.strerror}; check the room, the permissions and the limits there"
    words = " ".join(str(problem).split())[:200]
    return (
        f"this is a fault of dashpot and not of your input ({type(problem).__name__}{f': {words}' if words else ''}; "
        f"{_place(problem)}); please write to those who make dashpot, with the command, its files and what "
        f"{TRACEBACK}=1 before it shows"
    )


def out_of_memory(problem: BaseException) -> bool:
    """Whether a problem is that memory has ended."""
    return isinstance(problem, MemoryError) or any(words in str(problem) for words in _NO_MEMORY)


def _place(problem: BaseException) -> str:
    """The last line of ours that a problem passed through."""
    for frame in reversed(traceback.extract_tb(problem.__traceback__)):
        file = Path(frame.filename)
        if file.is_relative_to(_HERE) and ".venv" not in file.parts:
            return f"{file.relative_to(_HERE).as_posix()}, line {frame.lineno}"
    return "outside of it"


def _say(line: str) -> None:
    with suppress(OSError, ValueError):
        click.echo(f"dashpot: {printable(line)}", err=True)


@contextmanager
def _terminated_as_interrupted() -> Iterator[Callable[[], bool]]:
    """A request to end (SIGTERM, SIGHUP) is taken like Ctrl-C, so that nothing half-written stays.

    Yields what says whether there was one. One that Python could not deliver, because it came in the middle of what
    lets no exception through, comes again.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    asked = 0

    def interrupt(number: int, _: Any) -> None:
        nonlocal asked
        asked = number
        raise KeyboardInterrupt

    def undelivered(what: Any) -> None:
        if isinstance(what.exc_value, KeyboardInterrupt):
            again = threading.Timer(_SOON, _ask_again, [asked])  # at once, it would come here
            again.daemon = True
            again.start()
        else:
            hook(what)

    before, hook = {}, sys.unraisablehook
    try:
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
                before[number] = signal.signal(number, interrupt)
        sys.unraisablehook = undelivered
        yield lambda: bool(asked)
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


def _ask_again(number: int) -> None:
    if hasattr(signal, "pthread_kill"):  # which also ends a wait
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        _thread.interrupt_main(signal.Signals(number))


@contextmanager
def _own_temporary_folder() -> Iterator[None]:
    """What is made for a while, by this process or by those it starts, lies in one folder, which goes at the end.

    So nothing is left wherever an interruption comes. Where there is no place for such a folder, all is as it was.
    """
    folder, before, variable = None, tempfile.tempdir, os.environ.get("TMPDIR")
    try:
        with signals_held(), suppress(OSError):  # which is said by what needs one
            folder = tempfile.mkdtemp(prefix="dashpot-")
            tempfile.tempdir = os.environ["TMPDIR"] = folder
        yield
    finally:
        interrupted = None
        while folder is not None:
            try:
                with signals_held():
                    shutil.rmtree(folder, ignore_errors=True)
                    tempfile.tempdir = before
                    os.environ.pop("TMPDIR", None)
                    if variable is not None:
                        os.environ["TMPDIR"] = variable
                    folder = None
            except KeyboardInterrupt as asked:  # on the way in, when nothing was held yet: it is heard behind this
                interrupted = asked
        if interrupted is not None:
            raise interrupted

"""What commands say, where, and what they check before they work."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import click

from ..errors import BadInput, printable
from .time_to_go import Reached, in_words
from .waiting import counted, doing, silence

_QUIET, _VERBOSE = "dashpot.quiet", "dashpot.verbose"


def outputs_checked(outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Check the files to write before any work is done: each can be written, none is an input or named twice."""
    from ..files.writing import same_place, writable

    seen: list[Path] = []
    read = [place for source in inputs for place in (source, Path(str(source).partition("#")[0]))]  # FILE#RECORD
    for output in outputs:
        writable(output)
        if any(same_place(output, source) for source in read):
            raise BadInput(f"{output}: is an input and would be overwritten; name another file to write")
        if any(same_place(output, other) for other in seen):
            raise BadInput(f"{output}: is to be written twice; name a file for each")
        seen.append(output)


def say(line: str, *, always: bool = False) -> None:
    """Progress and remarks go to stderr, so that what a program reads from stdout stays clean.

    With ``--quiet`` only what must ``always`` be said is: bad news, which the exit code tells too.
    """
    if always or not quiet():
        with contextlib.suppress(OSError):  # what is done is done, also where nobody reads the message
            click.echo(printable(line), err=True)


def stage(line: str) -> None:
    """The same of what is worked at from now on, which a terminal shows while it lasts: no note, no result."""
    say(line)
    doing(printable(line).partition("\n")[0])


def drawing() -> None:
    """Show on a terminal that the files of a result are made, which is no line of its own."""
    from ..face.workflow import WRITING

    doing(WRITING)


def quiet() -> bool:
    """Whether the command was asked to say no more than its result."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(_QUIET))


def verbose() -> bool:
    """Whether the command was asked to say what it tries."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(_VERBOSE))


def _ask_for_quiet(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked:
        _asked_alone(context, _VERBOSE)
        context.meta[_QUIET] = True
        silence()


def _ask_for_verbose(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked:
        _asked_alone(context, _QUIET)
        context.meta[_VERBOSE] = True
        _LOGGER.addHandler(_FACTS)
        _LOGGER.setLevel(logging.INFO)


def _asked_alone(context: click.Context, other: str) -> None:
    if context.meta.get(other):
        raise click.UsageError("--quiet and --verbose exclude each other; give one of them")


class _Facts(logging.Handler):
    """Each fact that the package logs as a line on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print one fact."""
        with contextlib.suppress(OSError):  # what is done is done, also where nobody reads the message
            click.echo(" ".join(printable(record.getMessage()).split()), err=True)


_LOGGER, _FACTS = logging.getLogger("dashpot"), _Facts(logging.INFO)


@contextlib.contextmanager
def facts_shown() -> Iterator[None]:
    """While this lasts, ``--verbose`` prints what the package logs; the logger is then as it was before."""
    level = _LOGGER.level
    try:
        yield
    finally:
        _LOGGER.removeHandler(_FACTS)
        _LOGGER.setLevel(level)


def with_quiet(command: click.Command) -> None:
    """Give a command the options ``--quiet`` and ``--verbose``."""
    command.params.append(
        click.Option(
            ["-v", "--verbose"],
            is_flag=True,
            expose_value=False,
            is_eager=True,
            callback=_ask_for_verbose,
            help="Print on stderr what is tried and why it is dropped, one line a fact.",
        )
    )
    command.params.append(
        click.Option(
            ["-q", "--quiet"],
            is_flag=True,
            expose_value=False,
            is_eager=True,
            callback=_ask_for_quiet,
            help="Print the result alone: no progress, no notes. Errors and bad news are printed.",
        )
    )


def coloured(text: str, colour: str) -> str:
    """The text in a colour on a terminal (``click.echo`` takes it off elsewhere), unless NO_COLOR is set."""
    return text if os.environ.get("NO_COLOR") else click.style(text, fg=colour)


def print_json(value: Any) -> None:
    """A result for another program, on stdout."""
    # a stream that the caller closed is None
    encoding = (getattr(sys.stdout, "encoding", None) or "ascii").lower().replace("-", "")
    click.echo(json.dumps(value, indent=2, ensure_ascii=encoding != "utf8"))


@contextlib.contextmanager
def progress_shown() -> Iterator[Callable[[str, float], None]]:
    """A bar on a terminal, one line a stage elsewhere; yields what takes the stage and the part that is done."""
    if quiet():
        yield lambda _what, _part: None
    elif sys.stderr.isatty() and not verbose():
        with counted():
            yield doing
    else:
        said: set[tuple[int, str]] = set()
        begun = time.monotonic()

        def stage(what: str, part: float) -> None:
            done = round(100 * part)
            if (done, what) in said:
                return
            said.add((done, what))
            seconds = time.monotonic() - begun
            left = in_words(Reached(part, seconds).to_go(seconds)) if done < 100 else ""
            say(f"{done:3d} % {what}{f', {left}' if left else ''}")

        yield stage

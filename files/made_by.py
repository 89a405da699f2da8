"""What made a result: version and commit of dashpot, versions of what computes, and the command line that was typed."""

from __future__ import annotations

import os
import platform
import shlex
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path

from .. import __version__

#: Packages whose numbers are in every result.
_COMPUTING = ("numpy", "scipy", "casadi")
#: Characters of a command line that are kept: thousands of recordings may stand in one.
LONGEST_COMMAND = 1000
_GIT_SECONDS = 5.0

_typed: list[str] = []


@dataclass(frozen=True)
class MadeBy:
    """What made a result.

    Attributes:
        software: name and version, ``dashpot 0.1.0``.
        commit: of the checkout that it ran from, ``-dirty`` behind where that was changed; "" where it is installed.
        versions: of Python and of the packages that compute, by name.
        command: line as it was typed, "" where none was: paths in it are those of whoever typed it.
    """

    software: str
    commit: str = ""
    versions: Mapping[str, str] = field(default_factory=dict)
    command: str = ""

    def sentence(self) -> str:
        """For the foot of a page."""
        commit = f" (commit {self.commit})" if self.commit else ""
        beside = f" with {', '.join(f'{name} {version}' for name, version in self.versions.items())}"
        command = f", by: {self.command}" if self.command else ""
        return f"Made by {self.software}{commit}{beside if self.versions else ''}{command}."


def made_by() -> MadeBy:
    """What makes the results of this process."""
    return MadeBy(f"dashpot {__version__}", _commit(), _versions(), _typed[-1] if _typed else "")


def line_of(arguments: Sequence[str]) -> str:
    """The command line ``dashpot`` with these arguments, as a shell takes it."""
    return shlex.join(["dashpot", *arguments])


@contextmanager
def typed(line: str) -> Iterator[None]:
    """While this lasts, results are made by that command line; what does not print becomes U+FFFD."""
    line = "".join(c if c.isprintable() else "\ufffd" for c in line)
    _typed.append(line if len(line) <= LONGEST_COMMAND else f"{line[: LONGEST_COMMAND - 4]} ...")
    try:
        yield
    finally:
        _typed.pop()


@cache
def _versions() -> Mapping[str, str]:
    found = {"python": platform.python_version()}
    for name in _COMPUTING:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:  # it came without what pip leaves of a package
            continue
    return found


@cache
def _commit() -> str:
    """The commit of the checkout in which this package lies; "" where it lies in none, or there is no git.

    A virtual environment within a checkout of something else is none.
    """
    root = Path(__file__).parents[1]
    if not (root / ".git").exists():
        return ""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}  # of a hook that runs us
    line = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    try:
        run = subprocess.run(
            line, env=clean, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=_GIT_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return run.stdout.strip()[:60] if run.returncode == 0 else ""

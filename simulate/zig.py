"""The C compiler in the Python package ``ziglang``: one that builds for every platform from any machine.

It brings the C libraries of its targets as sources and builds them at the first use of a target: some seconds, for
Windows a minute or two. What it made then stays in a cache of its own.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from importlib import metadata, util
from pathlib import Path

from .cache import cache_folder

#: How to have it, as all messages say it.
MORE = 'pip install "dashpot[platforms]"'


def zig_version() -> str | None:
    """Version of the package ``ziglang``; None where it is not installed."""
    if util.find_spec("ziglang") is None:
        return None
    try:
        return metadata.version("ziglang")
    except metadata.PackageNotFoundError:  # on the path without having been installed
        return "unknown"


def zig_command(target: str | None = None) -> tuple[str, ...]:
    """How the compiler is called, for a target triple of zig's or, without one, for this machine.

    Never for the processor at hand: the same texts are to give the same bits on every machine.
    """
    # -P: a folder of the sources' must not hide the package
    command = (sys.executable, "-P", "-m", "ziglang", "cc")
    return (*command, "-target", target) if target else (*command, "-mcpu=baseline")


def zig_environment(scratch: Path) -> Mapping[str, str]:
    """Environment for one call: what is made for the target is kept, what is made of the texts goes to ``scratch``."""
    return {**os.environ, "ZIG_GLOBAL_CACHE_DIR": str(_kept()), "ZIG_LOCAL_CACHE_DIR": str(scratch)}


def is_prepared(target: str) -> bool:
    """Whether the target was built for before, so that it is fast now."""
    return _mark(target).exists()


def note_prepared(target: str) -> None:
    """Remember that the target was built for."""
    _mark(target).touch()


def _mark(target: str) -> Path:
    # in zig's cache, so that the two go together
    return _kept() / f"dashpot-{zig_version()}-{target}"


def _kept() -> Path:
    """``$ZIG_GLOBAL_CACHE_DIR`` where zig is in use already, else a folder in our own cache."""
    return Path(os.environ.get("ZIG_GLOBAL_CACHE_DIR") or cache_folder() / "zig")

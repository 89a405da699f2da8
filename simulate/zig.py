"""The C compiler in the Python package ``ziglang``: one that builds for every platform from any machine.

It brings the C libraries of its targets as sources and builds what it needs of them at the first use of a target, which
takes some seconds. What it made then stays in a cache of its own.
"""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata, util
from pathlib import Path

from .. import engine
from .store import private_folder

#: How to have it, as all messages say it.
MORE = 'pip install "dashpot[platforms]"'
WINDOWS = "x86_64-windows-gnu"
_RUNTIME = engine.WINDOWS_RUNTIME
_OBJECT = "library.o"
#: Parts of the C library that Windows has had since 10.
_SYSTEM = ("heap", "string", "stdio", "math")


def zig_version() -> str | None:
    """Version of the package ``ziglang``; None where it is not installed."""
    if util.find_spec("ziglang") is None:
        return None
    try:
        return _installed()
    except metadata.PackageNotFoundError:  # on the path without having been installed
        return "unknown"


@cache
def _installed() -> str:
    # an export asks several times, and each time a file would be searched for and read
    return metadata.version("ziglang")


def zig_target() -> str | None:
    """The target for this machine; None leaves it to zig."""
    return WINDOWS if sys.platform == "win32" and platform.machine().upper() == "AMD64" else None


def zig_command() -> tuple[str, ...]:
    """How zig is called."""
    # -P: a folder of the sources' must not hide the package
    return sys.executable, "-P", "-m", "ziglang"


def zig_steps(target: str | None, flags: Sequence[str], main: str, name: str) -> list[tuple[str, ...]]:
    """The commands, one after the other, that make a shared library.

    Args:
        target: zig's triple, or None for this machine. Never for the very processor at hand: the same texts are to give
            the same bits on every machine.
        flags: for the compiler.
        main: the file to compile.
        name: of the library.
    """
    compile_ = (*zig_command(), "cc", *(("-target", target) if target else ("-mcpu=baseline",)))
    if target != WINDOWS:
        return [(*compile_, *flags, "-o", name, main, "-lm")]
    for_object = [flag for flag in flags if flag not in ("-shared", "-s")]
    link = (*zig_command(), "build-lib", "-dynamic", "-target", target, "-O", "ReleaseFast", "-fstrip", "-fcompiler-rt")
    system = [f"-lapi-ms-win-crt-{part}-l1-1-0" for part in _SYSTEM]
    return [
        (*compile_, *for_object, "-c", "-o", _OBJECT, main),
        (*link, f"-femit-bin={name}", _OBJECT, _RUNTIME, *system),
    ]


def zig_sources(target: str | None) -> Mapping[str, str]:
    """Texts that have to lie beside those that are compiled for the target."""
    if target != WINDOWS:
        return {}
    return {_RUNTIME: engine.text(_RUNTIME)}


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
    given = os.environ.get("ZIG_GLOBAL_CACHE_DIR")
    return Path(given) if given else private_folder("zig")

"""The machine's C compiler, and shared libraries built once and kept in a cache."""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from ..errors import ToolchainMissing

#: No fused multiply-add and no reordering: the same model gives the same bits on every machine.
FLAGS = ("-O2", "-fPIC", "-shared", "-std=c99", "-ffp-contract=off", "-fvisibility=hidden")
_SUFFIX = {"Windows": ".dll", "Darwin": ".dylib"}.get(platform.system(), ".so")


def find_compiler() -> str | None:
    """Path of a C compiler: ``$CC`` when set, else cc, gcc or clang; None where there is none."""
    for name in (os.environ.get("CC"), "cc", "gcc", "clang"):
        if name and (path := shutil.which(name)):
            return path
    return None


def cache_folder() -> Path:
    """Where built cores are kept: ``$DASHPOT_CACHE``, else the user's cache folder."""
    if "DASHPOT_CACHE" in os.environ:
        return Path(os.environ["DASHPOT_CACHE"])
    base = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME")
    return Path(base) / "dashpot" if base else Path.home() / ".cache" / "dashpot"


def shared_library(sources: Mapping[str, str], main: str, *, flags: tuple[str, ...] = ()) -> Path:
    """Compile C texts into a shared library, or take it from the cache when the same texts were built before.

    Args:
        sources: file name to text; written side by side.
        main: the file to compile (it includes the others).
        flags: further compiler flags.

    Returns:
        Path of the library in the cache.

    Raises:
        ToolchainMissing: where no C compiler is found, or it fails.
    """
    compiler = find_compiler()
    if compiler is None:
        raise ToolchainMissing(
            "no C compiler was found (looked for $CC, cc, gcc, clang); install gcc or clang, "
            "for example with: apt-get install gcc libc6-dev"
        )
    command = [*FLAGS, *flags]
    key = hashlib.sha256(repr((platform.machine(), compiler, command, sorted(sources.items()), main)).encode())
    target = cache_folder() / f"core-{key.hexdigest()[:24]}{_SUFFIX}"
    if target.exists():
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        built = Path(folder) / target.name
        run = subprocess.run(
            [compiler, *command, "-o", str(built), main, "-lm"], cwd=folder, capture_output=True, text=True, check=False
        )
        if run.returncode != 0:
            raise ToolchainMissing(
                f"the C compiler {compiler} failed: {run.stderr.strip()[-400:]}; "
                "check that it can compile and link a small C program (headers: libc6-dev)"
            )
        built.replace(target)  # atomic: two processes may build the same core at once
    return target

"""One call of a compiler: in a time that is stated, ended with all that it started, and what it made looked at."""

from __future__ import annotations

import os
import struct
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..errors import BadInput, ToolchainMissing
from ..files import process_group

#: Longest time for one call; ``$DASHPOT_COMPILER_SECONDS`` sets another.
LONGEST_SECONDS = 120.0
#: The same of zig, which builds the C library of a target at its first use: two minutes on a busy machine.
LONGEST_SECONDS_OF_ZIG = 900.0
_STARTS = {
    ".so": (b"\x7fELF",),
    ".dll": (b"MZ",),
    ".dylib": (b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe"),
}


def longest_seconds(usual: float) -> float:
    """How long one call may take, ``usual`` if nothing else is set; raises BadInput where what is set is no number."""
    text = os.environ.get("DASHPOT_COMPILER_SECONDS", "")
    try:
        seconds = float(text or usual)
    except ValueError:
        seconds = 0.0
    if not 0.0 < seconds < 1e9:
        raise BadInput(f"DASHPOT_COMPILER_SECONDS is {text[:40]!r}; set it to a positive number of seconds")
    return seconds


def call(command: Sequence[str], folder: Path, environment: Mapping[str, str] | None, usual: float) -> tuple[int, str]:
    """Exit code of a command and what it said, its last 400 characters; ``usual`` is how many seconds it has.

    Raises:
        ToolchainMissing: where it cannot be started, or takes too long; all that it started is then ended.
    """
    seconds = longest_seconds(usual)
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # a compiler is several processes, which have to end together
        )
    except OSError as problem:
        raise ToolchainMissing(
            f"{command[0]} cannot be started ({problem.strerror or problem}); set CC to a C compiler that can"
        ) from problem
    with process:
        try:
            said, _ = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            process_group.end(process)
            raise ToolchainMissing(
                f"it did not end within {seconds:g} s; check it, or give it more by setting DASHPOT_COMPILER_SECONDS"
            ) from None
        except BaseException:
            process_group.end(process)
            raise
    return process.returncode, " ".join(said.decode("utf-8", errors="replace").split())[-400:]


def library_made(path: Path) -> bytes:
    """Content of the shared library that a compiler says it made.

    Raises:
        ToolchainMissing: where there is none, or not a whole one.
    """
    content = path.read_bytes() if path.is_file() else b""
    starts = _STARTS.get(path.suffix)
    if not content or (starts and not content.startswith(starts)) or not _whole(content):
        what = "nothing" if not content else f"{len(content)} bytes that are no whole shared library"
        raise ToolchainMissing(f"it says that all went well and made {what}")
    return content


def _whole(content: bytes) -> bool:
    """Whether an ELF file of 64 bits goes as far as its table of sections, which linkers put last."""
    if content[:5] != b"\x7fELF\x02":
        return True
    if len(content) < 64:
        return False
    order = "<" if content[5] == 1 else ">"
    (offset,) = struct.unpack_from(f"{order}Q", content, 40)
    size, count = struct.unpack_from(f"{order}HH", content, 58)
    return offset + size * count <= len(content)

"""The platforms that an FMU can hold a binary for, and their names: ours, those of FMI 2 and of FMI 3, and zig's."""

from __future__ import annotations

import difflib
import platform
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from ..errors import BadInput


@dataclass(frozen=True)
class Platform:
    """Where a binary runs.

    Attributes:
        name: on the command line.
        words: for people.
        fmi2: folder below ``binaries`` by FMI 2.0.5, section 2.3.
        fmi3: folder by FMI 3.0.2, section 2.5.1.4.1: architecture and system.
        suffix: of a shared library.
        needs: what must be there, as zig builds it; empty for a platform that it is not asked to build for.
        target: zig's triple; None for a platform that only its own compiler builds for.
    """

    name: str
    words: str
    fmi2: str
    fmi3: str
    suffix: str
    needs: str = ""
    target: str | None = None


# FMI 2 names x86 alone and since 2.0.4 sends everybody else to the tuples of FMI 3; so aarch64-linux. On a Mac,
# importers look in darwin64 whatever the processor, which is why a universal binary goes there. The versions are the
# oldest that make sense: glibc 2.17 is of 2012, arm64 came with macOS 11, the C runtime in use with Windows 10.
PLATFORMS = (
    Platform(
        name="linux64",
        words="Linux x86-64",
        fmi2="linux64",
        fmi3="x86_64-linux",
        suffix=".so",
        needs="glibc 2.17",
        target="x86_64-linux-gnu.2.17",
    ),
    Platform(
        name="linux-arm64",
        words="Linux arm64",
        fmi2="aarch64-linux",
        fmi3="aarch64-linux",
        suffix=".so",
        needs="glibc 2.17",
        target="aarch64-linux-gnu.2.17",
    ),
    Platform(
        name="win64",
        words="Windows x64",
        fmi2="win64",
        fmi3="x86_64-windows",
        suffix=".dll",
        needs="Windows 10",
        target="x86_64-windows-gnu",
    ),
    Platform(
        name="darwin-x64",
        words="macOS x64",
        fmi2="darwin64",
        fmi3="x86_64-darwin",
        suffix=".dylib",
        needs="macOS 10.13",
        target="x86_64-macos.10.13",
    ),
    Platform(
        name="darwin-arm64",
        words="macOS arm64",
        fmi2="darwin64",
        fmi3="aarch64-darwin",
        suffix=".dylib",
        needs="macOS 11",
        target="aarch64-macos.11.0",
    ),
)
_ALL = "all"
#: What one may write for several.
GROUPS = {
    _ALL: PLATFORMS,
    # FMI 2 has one folder for both, so whoever names it means both
    "darwin64": tuple(p for p in PLATFORMS if p.fmi2 == "darwin64"),
}
_ARCHITECTURES = {
    "amd64": "x86_64",
    "x64": "x86_64",
    "arm64": "aarch64",
    "i386": "x86",
    "i486": "x86",
    "i586": "x86",
    "i686": "x86",
}


def parse_platforms(text: str) -> tuple[Platform, ...]:
    """The platforms that a list with commas names: ours, tuples of FMI 3, or ``all``; in the order of ``PLATFORMS``.

    Raises:
        BadInput: where a name is not known, or none is given.
    """
    known = {**{p.fmi3: (p,) for p in PLATFORMS}, **{p.name: (p,) for p in PLATFORMS}, **GROUPS}
    names = [part.strip().lower() for part in text.split(",") if part.strip()]
    listed = ", ".join([_ALL, *(p.name for p in PLATFORMS)])
    if not names:
        raise BadInput(f"no platform is named in {text!r}; known are {listed}")
    for name in names:
        if name not in known:
            close = difflib.get_close_matches(name, known, n=1)
            meant = f"did you mean {close[0]}? Known" if close else "known"
            raise BadInput(f"unknown platform {name!r}; {meant} are {listed} (several with commas between them)")
    wanted = {p for name in names for p in known[name]}
    return tuple(p for p in PLATFORMS if p in wanted)


def own_platform() -> Platform:
    """The platform of this Python, which may be none of ``PLATFORMS``: it then has no target."""
    system = {"Windows": "windows", "Darwin": "darwin"}.get(platform.system(), platform.system().lower())
    machine = platform.machine().lower()
    architecture = _ARCHITECTURES.get(machine, machine)
    if architecture == "x86_64" and sys.maxsize <= 2**32:  # a 32-bit Python on a 64-bit machine
        architecture = "x86"
    tuple_ = f"{architecture}-{system}"
    for known in PLATFORMS:
        if known.fmi3 == tuple_:
            return known
    suffix = {"windows": ".dll", "darwin": ".dylib"}.get(system, ".so")
    fmi2 = {"x86-windows": "win32", "x86-linux": "linux32"}.get(tuple_, tuple_)
    return Platform(tuple_, f"{platform.system()} {machine}", fmi2, tuple_, suffix)


def folders(platform: Platform, others: Iterable[Platform], version: int) -> tuple[str, ...]:
    """The folders below ``binaries`` for a platform's binary in an FMU with those of ``others``.

    Args:
        platform: whose binary it is.
        others: all platforms that the FMU has binaries for.
        version: of FMI, 2 or 3.
    """
    if version >= 3:
        return (platform.fmi3,)
    if platform.fmi3 == "aarch64-linux" and not any(p.fmi2 == "linux64" for p in others):
        # Where FMPy and others on such a machine look, as does an FMU that OpenModelica makes there. With a binary for
        # x86-64 the place is taken, by rights.
        return (platform.fmi2, "linux64")
    return (platform.fmi2,)


def library_for_here(unpacked: Path, identifier: str) -> Path | None:
    """The binary of an unpacked FMU that runs on this machine; None where none says so by the name of its folder.

    Importers differ in where they look: FMPy knows no aarch64-linux in FMI 2.
    """
    own = own_platform()
    for folder in (own.fmi3, own.fmi2):
        path = unpacked / "binaries" / folder / f"{identifier}{own.suffix}"
        if path.is_file():
            return path
    return None

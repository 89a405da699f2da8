"""What of all that dashpot can use is there: versions, a compiler that works, platforms, extras, a cache."""

from __future__ import annotations

import platform
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import metadata
from typing import Any

from .. import __version__
from ..errors import BadInput, DashpotError

#: What an extra is for that reads no file: of those that do, the table of formats knows.
_PLATFORMS = "FMUs for Linux, Windows and macOS from any machine"
_PROBE = """#include <math.h>
#ifdef _WIN32
__declspec(dllexport)
#else
__attribute__((visibility("default")))
#endif
double dp_probe(double x) { return sin(x); }
"""
_REQUIREMENT = re.compile(r"(?P<name>[\w.-]+)(?P<bounds>[^;]*?)(?:\s*;\s*extra == ['\"](?P<extra>[\w-]+)['\"])?$")


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes:
        what: its name.
        good: whether it is there and works.
        needed: whether dashpot needs it, so that its lack is bad news.
        words: what was found, or what to do.
    """

    what: str
    good: bool
    needed: bool
    words: str


@dataclass(frozen=True)
class Checkup:
    """All that was looked at; ``good`` where everything that is needed is there."""

    version: str
    python: str
    machine: str
    findings: tuple[Finding, ...]

    @property
    def good(self) -> bool:
        """Whether everything that is needed is there."""
        return all(finding.good for finding in self.findings if finding.needed)

    def sentence(self) -> str:
        """The outcome in one sentence."""
        lacking = [finding.what for finding in self.findings if finding.needed and not finding.good]
        return "all that is needed is there" if self.good else f"not in order: {', '.join(lacking)}"

    def __str__(self) -> str:
        return self.text(lambda text, _: text)

    def text(self, coloured: Callable[[str, str], str]) -> str:
        """One line a finding; ``coloured`` takes a text and the name of a colour."""
        marks = {(True, True): ("✓", "green"), (True, False): ("✓", "green")}
        marks |= {(False, True): ("✗", "red"), (False, False): ("–", "yellow")}
        width = max(len(finding.what) for finding in self.findings)
        lines = [
            f"  {coloured(*marks[finding.good, finding.needed])} {finding.what:<{width}}  {finding.words}"
            for finding in self.findings
        ]
        head = f"dashpot {self.version}, Python {self.python}, {self.machine}"
        return "\n".join([head, *lines, coloured(self.sentence(), "green" if self.good else "red")])

    def as_json(self) -> dict[str, Any]:
        """The same for another program."""
        return {
            "format": "dashpot-doctor/1",
            "version": self.version,
            "python": self.python,
            "machine": self.machine,
            "findings": [{"what": f.what, "good": f.good, "needed": f.needed, "words": f.words} for f in self.findings],
            "good": self.good,
        }


def checkup() -> Checkup:
    """Look at everything; a few seconds where a compiler is tried for the first time. Raises nothing."""
    findings = (
        _python(),
        *_packages(),
        _compiler(),
        _platforms(),
        _cache(),
        *_sizes(),
        *_extras(),
        *_laws(),
        *_readers(),
    )
    machine = f"{platform.system()} {platform.machine()}"
    return Checkup(__version__, platform.python_version(), machine, findings)


def _python() -> Finding:
    fits = sys.version_info >= (3, 11)
    return Finding("Python", fits, True, platform.python_version() + ("" if fits else "; 3.11 or newer is needed"))


def _requirements() -> Iterator[tuple[str, str, str]]:
    """Package, bounds and extra of everything that the installed dashpot asks for; none where it is not installed."""
    try:
        required = metadata.requires("dashpot") or []
    except metadata.PackageNotFoundError:
        return
    for text in required:
        if match := _REQUIREMENT.match(text):
            yield match["name"], match["bounds"].strip(), match["extra"] or ""


def _found(package: str, bounds: str) -> tuple[bool, str]:
    """Whether a package is there in a version that is new enough, and what to say of it."""
    try:
        version = metadata.version(package)
    except metadata.PackageNotFoundError:
        return False, "not installed"
    least = re.search(r">=\s*([\d.]+)", bounds)
    if least and _numbers(version) < _numbers(least[1]):
        return False, f"{version}, and {least[1]} or newer is needed"
    barred = re.search(r"!=\s*([\d.]+)", bounds)
    if barred and _numbers(version) == _numbers(barred[1]):
        return False, f"{version}, which does not work; take another version"
    return True, version


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"\d+", version.partition("+")[0])[:3])


def _packages() -> Iterator[Finding]:
    required = [(package, bounds) for package, bounds, extra in _requirements() if not extra]
    if not required:
        yield Finding("installation", False, True, "dashpot is imported from a folder; install it with pip")
    for package, bounds in required:
        good, words = _found(package, bounds)
        yield Finding(package, good, True, words if good else f"{words}; pip install --upgrade dashpot")


def _compiler() -> Finding:
    """A compiler counts where it makes a library that can be called: there are ones without the C library's headers."""
    import ctypes

    from ..simulate.compiler import loaded_library, machine_compiler

    compiler = machine_compiler()
    try:
        probe = loaded_library({"probe.c": _PROBE}, "probe.c").dp_probe
        probe.restype, probe.argtypes = ctypes.c_double, [ctypes.c_double]
        good = probe(0.0) == 0.0
        name = "ziglang" if compiler is None or compiler.path is None else compiler.path
        return Finding("C compiler", good, True, f"{name}, tried")
    except (DashpotError, OSError, AttributeError) as problem:
        return Finding("C compiler", False, True, str(problem).partition("\n")[0])


def _platforms() -> Finding:
    from ..export.binaries import can_build
    from ..export.platforms import PLATFORMS

    built = can_build()
    there = all(p in built for p in PLATFORMS)
    names = ", ".join(p.name for p in built) or "none"
    advice = "" if there else '; for all: pip install "dashpot[platforms]"'
    return Finding("FMUs for", there, False, names + advice)


def _cache() -> Finding:
    from ..simulate.cache import cache_folder
    from ..simulate.store import why_not_private

    folder = cache_folder() / "compiled"
    why = why_not_private(folder)
    if why is not None:
        return Finding("cache", False, False, f"{folder}: {why}; set DASHPOT_CACHE to a folder of your own")
    size = sum(file.stat().st_size for file in cache_folder().rglob("*") if file.is_file()) / 1e6
    return Finding("cache", True, False, f"{cache_folder()}, {size:.0f} MB")


def _sizes() -> Iterator[Finding]:
    """What the installation takes on the disk, and what the compiler for all platforms adds to it."""
    from .sizes import in_words, sizes_of

    base = sizes_of()
    if not base:
        return
    more = {name: size for name, size in sizes_of("dashpot", "platforms", base).items() if name not in base}
    added = f"; platforms adds {in_words(more)}" if more else ""
    yield Finding("size", True, False, f"{in_words(base)}{added}")


def _extras() -> Iterator[Finding]:
    from ..recording.formats import FORMATS

    reads: dict[str, list[str]] = {}
    for suffix, kind in FORMATS.items():
        if kind.extra:
            reads.setdefault(kind.extra, []).append(suffix)
    purposes = {"platforms": _PLATFORMS} | {extra: f"reads {', '.join(all_)}" for extra, all_ in reads.items()}
    for package, bounds, extra in _requirements():
        if extra in purposes:
            good, words = _found(package, bounds)
            how = words if good else f'{words}; pip install "dashpot[{extra}]"'
            yield Finding(extra, good, False, f"{purposes[extra]}: {package} {how}")


def _readers() -> Iterator[Finding]:
    """What other packages bring to the kinds of files that are read."""
    from ..recording.formats import FORMATS
    from ..recording.formats.installed import installed_readers

    for suffix, name, load in installed_readers():
        try:
            load()
        except BadInput as problem:
            yield Finding(name, False, False, str(problem).partition("\n")[0])
            continue
        read = suffix not in FORMATS
        yield Finding(name, read, False, f"reads {suffix}" if read else f"is not asked: dashpot reads {suffix} itself")


def _laws() -> Iterator[Finding]:
    """What other packages bring to the library of laws."""
    from ..model.library import installed_laws

    for name, load in installed_laws():
        try:
            laws = load()
            yield Finding(name, True, False, f"laws: {', '.join(law.name for law in laws)}")
        except BadInput as problem:
            yield Finding(name, False, False, str(problem).partition("\n")[0])

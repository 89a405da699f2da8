"""Machines on which the C host can run here: this one, Windows under wine, 64-bit ARM under qemu-user.

Traps:
    - Debian's wine64 puts no command in the path; wine without a folder of its own writes into the user's home, and
      asks for Mono and Gecko in windows unless those two libraries are switched off.
    - qemu-user runs foreign Linux programs, but they want the C library of their machine: libc6-arm64-cross brings
      it. A static program needs none, but cannot load an FMU.
    - ziglang compiles the C library of a foreign machine at first use: minutes for Windows on a busy machine; it keeps
      it in the user's cache. Compiling the FMU itself takes a second.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

#: No fused multiply-add, as in the binaries that dashpot makes: the same model gives the same bits on every machine.
_LIBRARY = ("-std=c99", "-O2", "-shared", "-fPIC", "-ffp-contract=off", "-fvisibility=hidden")
_PROGRAM = ("-std=c11", "-O2", "-Wall", "-Wextra", "-Werror")


class NotHereError(Exception):
    """What would be needed is not on this machine; the text says what."""


@dataclass(frozen=True)
class Machine:
    """A machine.

    Attributes:
        folders: its name below ``binaries`` in FMI 2.0 and in FMI 3.0.
        suffix: of a shared library.
        target: zig's name; None for this machine, whose own compiler is taken.
        libraries: linker options of a program that loads libraries.
    """

    folders: tuple[str, str]
    suffix: str
    target: str | None = None
    libraries: tuple[str, ...] = ()

    def compile(self, flags: tuple[str, ...], source: Path, out: Path) -> Path:
        """Compile one C file, in its folder.

        Raises:
            NotHereError: where there is no compiler for the machine.
        """
        if self.target is None:
            name = next((n for n in (os.environ.get("CC"), "cc", "gcc", "clang") if n and shutil.which(n)), None)
            if name is None:
                raise NotHereError("there is no C compiler")
            command = [name]
        elif find_spec("ziglang") is None:
            raise NotHereError("ziglang is not installed")
        else:
            command = [sys.executable, "-P", "-m", "ziglang", "cc", "-target", self.target]
        made = subprocess.run(
            [*command, *flags, "-o", str(out), source.name, *self.libraries],
            cwd=source.parent,
            capture_output=True,
            text=True,
            check=False,
        )
        if made.returncode != 0:
            raise RuntimeError(f"{source.name} does not compile for {self.target or 'this machine'}: {made.stderr}")
        return out

    def program(self, source: Path, out: Path) -> Path:
        """A program from one C file."""
        return self.compile(_PROGRAM, source, out)

    def library(self, source: Path, out: Path) -> Path:
        """A shared library from one C file."""
        return self.compile(_LIBRARY, source, out)

    def command(self, program: Path) -> list[str]:
        """What runs a program of the machine here.

        Raises:
            NotHereError: where the emulator is missing.
        """
        if self.target is None:
            return [str(program)]
        if "windows" in self.target:
            return [_wine(), str(program)]
        return [_qemu(), "-L", "/usr/aarch64-linux-gnu", str(program)]

    def environment(self, folder: Path) -> Mapping[str, str]:
        """What the emulator is to be told; its own files go below ``folder``."""
        if self.target and "windows" in self.target:
            told = {"WINEDEBUG": "-all", "WINEDLLOVERRIDES": "mscoree,mshtml=", "WINEPREFIX": str(folder / "wine")}
            return {**os.environ, **told}
        return os.environ


def _here() -> Machine:
    system = {"Windows": "win", "Darwin": "darwin"}.get(platform.system(), "linux")
    long_system = {"win": "windows"}.get(system, system)
    processor = {"AMD64": "x86_64", "arm64": "aarch64"}.get(platform.machine(), platform.machine())
    suffix = {"win": ".dll", "darwin": ".dylib"}.get(system, ".so")
    bits = 64 if sys.maxsize > 2**32 else 32
    libraries = ("-ldl",) if system == "linux" else ()
    return Machine((f"{system}{bits}", f"{processor}-{long_system}"), suffix, None, libraries)


#: By the names that the tests use.
MACHINES = {
    "here": _here(),
    "windows": Machine(("win64", "x86_64-windows"), ".dll", "x86_64-windows-gnu"),
    "aarch64": Machine(("aarch64-linux", "aarch64-linux"), ".so", "aarch64-linux-gnu.2.17", ("-ldl", "-lm")),
}


def _wine() -> str:
    places = (shutil.which("wine64"), shutil.which("wine"), "/usr/lib/wine/wine64")
    path = next((place for place in places if place and Path(place).exists()), None)
    if path is None or sysconfig.get_platform() != "linux-x86_64":
        raise NotHereError("wine is not installed (wine64)")
    return path


def _qemu() -> str:
    path = shutil.which("qemu-aarch64-static") or shutil.which("qemu-aarch64")
    if path is None:
        raise NotHereError("qemu-user is not installed (qemu-user-static)")
    if not Path("/usr/aarch64-linux-gnu/lib/ld-linux-aarch64.so.1").exists():
        raise NotHereError("the C library of 64-bit ARM is not installed (libc6-arm64-cross)")
    return path

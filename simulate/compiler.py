"""C compilers, and shared libraries built once and kept in the store."""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import ToolchainMissing, Unwritable
from . import store, zig
from .cache import cache_folder
from .compiler_run import LONGEST_SECONDS, LONGEST_SECONDS_OF_ZIG, call, library_made

#: No fused multiply-add and no reordering: the same model gives the same bits on every machine. Numbers are not packed
#: in pairs: a law has few that are alike, and packing them takes longer than it saves.
FLAGS = (
    "-O2",
    "-fPIC",
    "-shared",
    "-std=c99",
    "-ffp-contract=off",
    "-fvisibility=hidden",
    "-fno-tree-slp-vectorize",
)
NO_COMPILER = (
    "no C compiler was found (looked for $CC, cc, gcc, clang and the Python package ziglang); install gcc or clang, "
    f"for example with: apt-get install gcc libc6-dev, or a compiler for all platforms with: {zig.MORE}"
)
#: Of a shared library on this machine.
SUFFIX = {"Windows": ".dll", "Darwin": ".dylib"}.get(platform.system(), ".so")


@dataclass(frozen=True)
class Compiler:
    """A C compiler: the machine's own by its path, or without one zig's for a target (None: this machine)."""

    identity: str
    path: str | None = None
    target: str | None = None

    def steps(self, flags: Sequence[str], main: str, name: str) -> list[tuple[str, ...]]:
        """The commands that make the shared library ``name`` of the file ``main``."""
        if self.path is None:
            return zig.zig_steps(self.target, flags, main, name)
        return [(self.path, *flags, "-o", name, main, "-lm")]


def find_compiler() -> str | None:
    """Path of a C compiler: ``$CC`` when set, else cc, gcc or clang; None where there is none."""
    for name in (os.environ.get("CC"), "cc", "gcc", "clang"):
        if name and (path := shutil.which(name)):
            return path
    return None


def zig_compiler(target: str | None) -> Compiler | None:
    """The compiler of the package ``ziglang`` for a target triple, None meaning this machine; None without it."""
    version = zig.zig_version()
    return None if version is None else Compiler(f"zig {version} {target or platform.platform()}", target=target)


def machine_compiler() -> Compiler | None:
    """What builds for this machine: its own compiler, else zig's; None where there is neither."""
    if path := find_compiler():
        return Compiler(f"{platform.machine()} {path}", path)
    return zig_compiler(zig.zig_target())


def shared_library(sources: Mapping[str, str], main: str, *, flags: tuple[str, ...] = ()) -> Path:
    """Compile C texts into a shared library for this machine, or take it from the store when it was built before.

    Args:
        sources: file name to text; written side by side.
        main: the file to compile (it includes the others).
        flags: further compiler flags.

    Returns:
        Path of the library in the store, its content checked.

    Raises:
        ToolchainMissing: where no C compiler is found, or it fails.
    """
    compiler = machine_compiler()
    if compiler is None:
        raise ToolchainMissing(NO_COMPILER)
    return build(compiler, sources, main, f"core{SUFFIX}", flags=flags)[0]


def loaded_library(sources: Mapping[str, str], main: str, *, flags: tuple[str, ...] = ()) -> ctypes.CDLL:
    """The same, loaded into this process.

    Raises:
        ToolchainMissing: as ``shared_library``, and where the library does not load.
    """
    path = shared_library(sources, main, flags=flags)
    try:
        return ctypes.CDLL(str(path))
    except OSError as problem:
        raise ToolchainMissing(
            f"what was compiled does not load ({problem}); check the C compiler, and that programs may run from "
            f"{path.parent}, or set DASHPOT_CACHE to another folder"
        ) from problem


def build(
    compiler: Compiler,
    sources: Mapping[str, str],
    main: str,
    name: str,
    *,
    flags: tuple[str, ...] = (),
    before: Callable[[], None] | None = None,
) -> tuple[Path, bytes]:
    """Build a shared library with a compiler, or take it from the store; it appears there whole or not at all.

    Args:
        compiler: what to build with.
        sources: file name to text; written side by side.
        main: the file to compile (it includes the others).
        name: of the library with its suffix; some formats keep it inside.
        flags: further compiler flags.
        before: called when it has to be built.

    Returns:
        Path of the library in the store, and its content.

    Raises:
        Unwritable: where there is no room to build in.
        ToolchainMissing: where the compiler fails, does nothing, or does not end.
    """
    steps = compiler.steps([*FLAGS, *flags], main, name)
    texts = {**sources, **(zig.zig_sources(compiler.target) if compiler.path is None else {})}
    # without the first words, which are paths
    made_of = repr((compiler.identity, [step[1:] for step in steps], sorted(texts.items())))
    entry = Path(name).stem[:40], hashlib.sha256(made_of.encode()).hexdigest()[:24], Path(name).suffix
    kept = store.find(*entry)
    if kept is not None:
        return kept
    if before is not None:
        before()
    try:
        with store.scratch() as scratch:
            folder = Path(scratch) / "build"
            folder.mkdir()
            for file, text in texts.items():
                (folder / file).write_text(text, encoding="utf-8", newline="\n")
            _compile(compiler, steps, folder)
            try:
                content = library_made(folder / name)
            except ToolchainMissing as problem:
                raise ToolchainMissing(_failed(compiler, str(problem))) from problem
            return store.put(folder / name, *entry, content), content
    except OSError as problem:
        raise Unwritable(
            f"{problem.filename or store.private_folder('compiled')}: nothing can be compiled there "
            f"({problem.strerror or problem}); make room, or set DASHPOT_CACHE to another folder"
        ) from problem


def _compile(compiler: Compiler, steps: Sequence[Sequence[str]], folder: Path) -> None:
    environment, usual = None, LONGEST_SECONDS
    if compiler.path is None:
        environment, usual = zig.zig_environment(folder.parent / "zig"), LONGEST_SECONDS_OF_ZIG
    for step in steps:
        try:
            code, said = call(step, folder, environment, usual)
        except ToolchainMissing as problem:
            raise ToolchainMissing(_failed(compiler, str(problem))) from problem
        if code != 0:
            raise ToolchainMissing(_failed(compiler, said or f"it ended with code {code} and said nothing"))


def _failed(compiler: Compiler, said: str) -> str:
    if compiler.path is None:
        return (
            f"the C compiler of the package ziglang failed: {said}; where that is not about the model's own C, check "
            f"that {cache_folder()} can be written and has 200 MB to spare, then: pip install --force-reinstall ziglang"
        )
    return (
        f"the C compiler {compiler.path} failed: {said}; "
        "check that it can compile and link a small C program (headers: libc6-dev)"
    )

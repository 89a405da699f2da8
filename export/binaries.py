"""The binaries of an FMU: which platforms can be built for here, each one built, and what to say of them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence

from ..errors import ToolchainMissing
from ..files.spoken import spoken
from ..simulate import zig
from ..simulate.compiler import NO_COMPILER, Compiler, build, machine_compiler, zig_compiler
from ..simulate.zig import MORE
from .platforms import PLATFORMS, Platform, folders, own_platform
from .universal import universal

_SMALL = ("-g0", "-s")


def can_build() -> tuple[Platform, ...]:
    """The platforms that can be built for here: all with zig, this machine's with its own compiler, or none."""
    own = (own_platform(),) if machine_compiler() is not None else ()
    if zig.zig_version() is None:
        return own
    return (*PLATFORMS, *(p for p in own if p not in PLATFORMS))


def default_platforms() -> tuple[Platform, ...]:
    """What is built for where nothing is asked for: everything that can be; where nothing can be, this machine's."""
    return can_build() or (own_platform(),)


def chosen(platforms: Sequence[Platform] | None) -> tuple[Platform, ...]:
    """The platforms to build for: those asked for, or all that can be built for here.

    Raises:
        ToolchainMissing: where one that was asked for cannot be built here, or none can be.
    """
    possible = can_build()
    wanted = tuple(platforms or default_platforms())
    missing = [p.name for p in wanted if p not in possible]
    if not missing:
        return wanted
    if not possible:
        raise ToolchainMissing(NO_COMPILER)
    raise ToolchainMissing(
        f"no compiler for {', '.join(missing)} was found, only for {', '.join(p.name for p in possible)}; "
        f"get one for all platforms with: {MORE}"
    )


def binaries(
    sources: Mapping[str, str],
    main: str,
    identifier: str,
    platforms: Sequence[Platform],
    *,
    version: int = 2,
    progress: Callable[[str], None] | None = None,
) -> dict[str, bytes]:
    """Build an FMU's binaries.

    Args:
        sources: C texts by file name.
        main: the one to compile; it includes the others.
        identifier: the model's identifier, after which the binaries are named.
        platforms: what to build for, as ``chosen`` makes it.
        version: of FMI, 2 or 3: it says which folder is for which platform.
        progress: called with one line before a build that takes long.

    Returns:
        Contents by name in the archive, ``binaries/FOLDER/IDENTIFIER.SUFFIX``.

    Raises:
        ToolchainMissing: where a platform's compiler is missing or fails.
    """
    contents: dict[str, list[bytes]] = {}
    for platform in platforms:
        content = _built(sources, main, identifier, platform, progress)
        for folder in folders(platform, platforms, version):
            contents.setdefault(f"binaries/{folder}/{identifier}{platform.suffix}", []).append(content)
    return {name: universal(thin) if len(thin) > 1 else thin[0] for name, thin in contents.items()}


def inside(platforms: Sequence[Platform]) -> str:
    """What the binaries of an FMU run on, as one sentence for its documentation."""
    everywhere = zig.zig_version() is not None
    runs = [f"{p.words} ({p.needs} or newer)" if everywhere and p.needs else p.words for p in platforms]
    built = "" if everywhere else ", on systems at least as new as that which it was built on"
    return f"The FMU runs on {spoken(runs)}{built}; for others its C sources are inside."


def remark(platforms: Sequence[Platform]) -> str:
    """What the binaries of an FMU run on, as one line for whoever exports it, with how to have the others."""
    line = f"the FMU runs on {spoken([p.words for p in platforms])}"
    return line if zig.zig_version() is not None else f"{line}; for all desktops: {MORE}"


def _compiler(platform: Platform) -> Compiler | None:
    # zig before the machine's own compiler: the FMU is then the same from whatever machine
    compiler = zig_compiler(platform.target) if platform.target else None
    return compiler or (machine_compiler() if platform == own_platform() else None)


def _built(
    sources: Mapping[str, str],
    main: str,
    identifier: str,
    platform: Platform,
    progress: Callable[[str], None] | None,
) -> bytes:
    compiler = _compiler(platform)
    if compiler is None:
        raise ToolchainMissing(f"no compiler for {platform.name} was found; get one for all platforms with: {MORE}")
    name = f"{identifier}{platform.suffix}"
    flags = _SMALL
    if platform.suffix == ".dylib":
        # else the name is the path at which the library was linked
        flags = (*flags, f"-Wl,-install_name,@rpath/{name}")
    if compiler.path is not None and sys.platform == "darwin":
        flags = tuple(flag for flag in flags if flag != "-s")  # which Apple's linker calls obsolete
    slow = compiler.target if compiler.target and not zig.is_prepared(compiler.target) else None
    built = False

    def before() -> None:
        nonlocal built
        built = True
        if slow and progress is not None:
            progress(f"compiling for {platform.words}; the first time this takes some seconds")

    try:
        _, library = build(compiler, sources, main, name, flags=flags, before=before)
    except ToolchainMissing as problem:
        raise ToolchainMissing(f"the binary for {platform.name}: {problem}") from problem
    if slow and built:
        zig.note_prepared(slow)
    return library

"""How the model inside an FMU runs: as a binary, or in Python where no compiler is."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence

from ..errors import BadInput
from ..simulate.zig import MORE
from .binaries import can_build
from .platforms import Platform

BACKENDS = ("native", "python")


def choose_backend(
    backend: str | None, platforms: Sequence[Platform] | None = None, progress: Callable[[str], None] | None = None
) -> str:
    """The back-end to use: the one asked for, else ``native``, or ``python`` where no C compiler is.

    Args:
        backend: ``native``, ``python``, or None for whatever is possible here.
        platforms: what binaries are asked for by name; then it is ``native``.
        progress: called with a sentence where it has to be ``python``; left out, it is a Python warning.

    Raises:
        BadInput: where there is no such back-end, or platforms are named for Python.
    """
    if backend not in (None, *BACKENDS):
        raise BadInput(f"unknown FMU backend {backend!r}; use 'native' or 'python'")
    if backend == "python" and platforms:
        raise BadInput("an FMU in Python has no binaries of its own to choose platforms for; leave the platforms out")
    if backend is not None or platforms or can_build():
        return backend or "native"
    (progress or warnings.warn)(
        "no C compiler was found, so the FMU runs its model in Python: wherever it is used it needs Python with the "
        "package casadi, it is about a hundred times slower, and it is for FMI 2.0 co-simulation only; "
        f"for a compiled one: {MORE}"
    )
    return "python"

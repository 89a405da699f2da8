"""The integrator of the virtual rigs: compiled once from the C beside this file, then called through ctypes.

It shares nothing with the product. Errors raised: RuntimeError where the machine has no C compiler or a run diverges.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

SOURCES = ("drive.c", "laws.c", "surfaces.c", "integrate.c")
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
PROBLEMS = {1: "diverged", 2: "needed too many steps", 3: "ran out of memory"}
TOLERANCE = 1e-11  # of each state's size, a step
STEPS_PER_CYCLE = 150  # at least


@dataclass(frozen=True)
class Drive:
    """A force: `kind` is none, linear, logarithmic, multisine, straight or hits; `peak` N, `start`, `end` Hz, times s.

    `lines` of a multisine, (n, 3): frequency Hz, amplitude as a part of `peak`, phase rad; of straight lines, (n, 2):
    force at the beginning of each sample interval and its rise over it, as parts of `peak`; of hits, (n, 3): when each
    begins s, its part of `peak`, how long it lasts s.
    """

    kind: str
    peak: float = 0.0
    start: float = 0.0
    end: float = 0.0
    length: float = 1.0
    ramp: float = 1.0
    lines: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))

    def numbers(self) -> list[float]:
        """Give the drive as the C program takes it."""
        kind = ("none", "linear", "logarithmic", "multisine", "straight", "hits").index(self.kind)
        return [kind, self.peak, self.start, self.end, self.length, self.ramp]


@dataclass(frozen=True)
class Response:
    """What a run gave: `force` N as commanded, `x` m of the mass, and what its sensor `shown`, (n,) each, no noise.

    The sensor shows m, or m/s² where it is an accelerometer.
    """

    force: np.ndarray
    x: np.ndarray
    shown: np.ndarray
    steps: int
    events: int


def _compiler() -> str:
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        if name and shutil.which(name):
            return name
    raise RuntimeError("the virtual rigs are simulated in C, and no compiler was found; install gcc")


@cache
def library() -> ctypes.CDLL:
    """Compile the C program, or find it compiled already in the user's cache, and load it."""
    here = Path(__file__).parent
    texts = b"".join((here / name).read_bytes() for name in ("rig.h", *SOURCES))
    key = hashlib.sha256(texts + " ".join(FLAGS).encode() + os.uname().machine.encode()).hexdigest()[:16]
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "dashpot-concealed"
    try:
        home.mkdir(parents=True, exist_ok=True)
    except OSError:  # no home that can be written
        home = Path(tempfile.mkdtemp(prefix="concealed-"))
    target = home / f"rig-{key}.so"
    if not target.exists():
        handle, made = tempfile.mkstemp(suffix=".so", dir=home)
        os.close(handle)
        command = [_compiler(), *FLAGS, "-o", made, *(str(here / name) for name in SOURCES), "-lm"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if run.returncode:
            Path(made).unlink()
            raise RuntimeError(f"the virtual rigs' C program does not compile: {run.stderr.strip()}")
        Path(made).replace(target)
    loaded = ctypes.CDLL(str(target))
    loaded.concealed_parameters.restype = ctypes.c_char_p
    return loaded


@cache
def parameter_names() -> tuple[str, ...]:
    """Names of the C program's parameters, in its order."""
    return tuple(library().concealed_parameters().decode().split())


def simulate(
    parameters: Mapping[str, float],
    drive: Drive,
    x0: float,
    fs: float,
    samples: int,
    tolerance: float = TOLERANCE,
    steps_per_cycle: float = STEPS_PER_CYCLE,
    rest: np.ndarray | None = None,
) -> Response:
    """Simulate `samples` samples at `fs` Hz of a rig that rests at `x0` m until the time 0.

    `parameters` by the names of rig.h, SI and per unit mass; those not given are zero: their physics is off. `rest`,
    (samples,) N, acts on the mass besides the drive, straight between the samples, and is not in the force given back.
    Raises ValueError for an unknown name, RuntimeError for a run that diverges.
    """
    unknown = set(parameters) - set(parameter_names())
    if unknown:
        raise ValueError(f"the virtual rig has no parameter {', '.join(sorted(unknown))}")
    numbers = np.array([parameters.get(name, 0.0) for name in parameter_names()], dtype=float)
    longest = 2 * np.pi / parameters["omega"] / steps_per_cycle
    lines = np.ascontiguousarray(drive.lines, dtype=float)
    settings = np.array(drive.numbers(), dtype=float)
    force, x, shown = np.zeros((3, samples))
    besides = None if rest is None else np.column_stack([rest, np.diff(rest, append=rest[-1])])
    counted = np.zeros(2, dtype=ctypes.c_long)

    def pointer(array: np.ndarray) -> ctypes.c_void_p:
        return array.ctypes.data_as(ctypes.c_void_p)

    status = library().concealed_run(
        pointer(numbers),
        pointer(settings),
        pointer(lines),
        ctypes.c_int(len(lines)),
        None if besides is None else pointer(besides),
        ctypes.c_double(x0),
        ctypes.c_double(fs),
        ctypes.c_int(samples),
        ctypes.c_double(tolerance),
        ctypes.c_double(longest),
        *(pointer(array) for array in (force, x, shown, counted)),
    )
    if status:
        raise RuntimeError(f"the virtual rig's run {PROBLEMS[status]}")
    return Response(force, x, shown, int(counted[0]), int(counted[1]))

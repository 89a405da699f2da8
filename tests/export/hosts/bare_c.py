"""A simulator in plain C (``host.c``), FMI 2.0 and 3.0 co-simulation, on any of ``machines``.

The binary is the FMU's own for that machine; where it has none, its sources are compiled for it.
"""

from __future__ import annotations

import subprocess
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from described import CO_SIMULATION, SLOPE, Described, describe
from machines import MACHINES, Machine, NotHereError

NEEDS = ()
INTERFACE = CO_SIMULATION
HOLDS = {2: ("zero", "first"), 3: ("zero", "first")}
#: The first start of wine makes its folder.
_SECONDS = 300


def run(
    fmu: Path,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    *,
    source: str = "F",
    output: str = "x",
    machine: str = "here",
) -> np.ndarray:
    """(n,) output at the samples of the force.

    Raises:
        NotHereError: where the machine cannot be compiled for or run here.
    """
    with prepared(fmu, force, dt, parameters, hold, source=source, output=output, machine=machine) as play:
        return np.array([float(line) for line in play().split()])


@contextmanager
def prepared(
    fmu: Path,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    *,
    source: str = "F",
    output: str = "x",
    machine: str = "here",
    repeat: int = 0,
    environment: Mapping[str, str] | None = None,
) -> Iterator[Callable[[], str]]:
    """The host and its plan, ready to be run any number of times: gives the outputs, a line each.

    With ``repeat`` it gives the processor time of one step (set, step, get) in nanoseconds instead, the whole force
    run that often.
    """
    known, target = describe(fmu), MACHINES[machine]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = target.command(folder / "host.exe")  # first: compiling for what cannot be run is time lost
        target.program(Path(__file__).with_name("host.c"), folder / "host.exe")
        library = _library(fmu, known, target, folder)
        starts = "".join(f"set {known.references[n]} {float(v)!r}\n" for n, v in parameters.items())
        (folder / "plan.txt").write_text(
            f"library ./{library.relative_to(folder).as_posix()}\n"
            f"resources {(folder / 'fmu' / 'resources').as_uri()}\n"
            f"version {known.version}\ntoken {known.token}\nstep {dt!r}\nfirst {int(hold == 'first')}\n"
            f"source {known.references[source] if source else -1}\n"
            f"slope {known.references[SLOPE] if SLOPE in known.inputs else -1}\n"
            f"output {known.references[output]}\nrepeat {repeat}\n{starts}"
            f"force {force.size}\n" + "".join(f"{float(value)!r}\n" for value in force)
        )

        def play() -> str:
            played = subprocess.run(
                [*command, "plan.txt"],
                cwd=folder,
                env={**target.environment(folder), **(environment or {})},
                capture_output=True,
                text=True,
                check=False,
                timeout=_SECONDS,
            )
            if played.returncode != 0:
                raise RuntimeError(f"the host ended with {played.returncode}: {played.stderr[-500:]}")
            return played.stdout

        yield play


def _library(fmu: Path, known: Described, machine: Machine, folder: Path) -> Path:
    """The binary for the machine below ``folder``: the FMU's own, or made of its sources."""
    identifier = known.identifiers[INTERFACE]
    own = f"binaries/{machine.folders[known.version - 2]}/{identifier}{machine.suffix}"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder / "fmu")
    if (folder / "fmu" / own).exists():
        return folder / "fmu" / own
    main = folder / "fmu" / "sources" / "all.c"
    if not main.exists():
        raise NotHereError(f"the FMU has neither {own} nor sources")
    return machine.library(main, folder / f"{identifier}{machine.suffix}")

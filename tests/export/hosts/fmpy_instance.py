"""FMPy's object for an FMU of either version and interface."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from described import CO_SIMULATION, MODEL_EXCHANGE, Described, describe


def made(known: Described, folder: str | Path, interface: str) -> Any:
    """The object over an unpacked FMU, not yet instantiated."""
    from fmpy import fmi2, fmi3

    kinds = {
        (2, CO_SIMULATION): fmi2.FMU2Slave,
        (2, MODEL_EXCHANGE): fmi2.FMU2Model,
        (3, CO_SIMULATION): fmi3.FMU3Slave,
        (3, MODEL_EXCHANGE): fmi3.FMU3Model,
    }
    return kinds[known.version, interface](
        guid=known.token,
        unzipDirectory=str(folder),
        modelIdentifier=known.identifiers[interface],
        instanceName="rig",
    )


@contextmanager
def opened(fmu: Path, interface: str) -> Iterator[tuple[Described, Any]]:
    """An instance before its initialization mode, with what the FMU says of itself; ended and removed afterwards."""
    from fmpy import extract

    known, folder = describe(fmu), extract(str(fmu))
    try:
        instance = made(known, folder, interface)
        instance.instantiate()
        if known.version == 2:
            instance.setupExperiment(startTime=0.0)
        yield known, instance
        instance.terminate()
        instance.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)

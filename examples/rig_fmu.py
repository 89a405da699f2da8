"""One rig's FMU under FMPy as the plant of an example: variables by name, a step at a time (FMI 2, co-simulation)."""

from __future__ import annotations

import shutil
from pathlib import Path


class RigFmu:
    """An instance of the FMU; start values and parameters by name. Call ``end`` when it is done with."""

    def __init__(self, fmu: Path, **start: float) -> None:
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave

        description = read_model_description(str(fmu))
        self._reference = {v.name: v.valueReference for v in description.modelVariables}
        self._folder = extract(str(fmu))
        self._fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="rig",
        )
        self._fmu.instantiate()
        self._fmu.setupExperiment(startTime=0.0)
        self._fmu.enterInitializationMode()
        self._fmu.setReal(self._references(*start), list(start.values()))
        self._fmu.exitInitializationMode()
        self._time = 0.0

    def _references(self, *names: str) -> list[int]:
        return [self._reference[name] for name in names]

    def get(self, *names: str) -> list[float]:
        """Values of variables."""
        return self._fmu.getReal(self._references(*names))

    def rates(self, *names: str) -> list[float]:
        """First derivatives of outputs by time."""
        return self._fmu.getRealOutputDerivatives(self._references(*names), [1] * len(names))

    def push(self, force: float, *derivatives: float) -> None:
        """The force over the coming step, N, and its first, second and third derivative as far as they are known."""
        at = self._references("F")
        self._fmu.setReal(at, [force])
        if derivatives:
            orders = list(range(1, len(derivatives) + 1))
            self._fmu.setRealInputDerivatives(at * len(orders), orders, list(derivatives))

    def move(self, displacement: float, velocity: float, acceleration: float) -> None:
        """The motion at the beginning of the coming step, of a force law by itself."""
        at = self._references("displacement", "velocity", "acceleration")
        self._fmu.setReal(at, [displacement, velocity, acceleration])

    def step(self, seconds: float) -> None:
        """Run over one step."""
        self._fmu.doStep(self._time, seconds)
        self._time += seconds

    def end(self) -> None:
        """Terminate the instance and remove what was unpacked."""
        self._fmu.terminate()
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

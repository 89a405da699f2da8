from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from dashpot.export.fmu import export_fmu
from dashpot.export.platforms import own_platform
from dashpot.model import Oscillator, Response, oscillator_with

for scripts in ("hosts", "reading"):  # they are in no package
    sys.path.append(str(Path(__file__).parent / scripts))

if TYPE_CHECKING:
    from calling import Caller

#: The paper's stand (Eq. 17 in SI).
STAND = {
    "mass": 0.27,
    "omega0": 2 * math.pi * 12.67,
    "viscous": 5.0,
    "dry": 0.015,
    "cubic": 4.6e5,
    "preload": 0.02 / 0.27,
}


def _massless() -> Oscillator:
    values = {name: value for name, value in STAND.items() if name != "mass"}
    return Oscillator.from_values(values, name="massless", response=Response("displacement", "rad"))


#: One model of every kind that the exports must carry.
MODELS: dict[str, Callable[[], Oscillator]] = {
    "base": lambda: Oscillator.from_values(STAND, name="stand"),
    "massless": _massless,
    "drag": lambda: oscillator_with(
        {**STAND, "quadratic-drag.coefficient": 3.0}, name="drag", effects=("quadratic-drag",)
    ),
    "velocity": lambda: Oscillator.from_values(STAND, name="velocity", response=Response("velocity", "m/s")),
    "acceleration": lambda: Oscillator.from_values(
        STAND, name="acceleration", response=Response("acceleration", "m/s2")
    ),
    "volts": lambda: Oscillator.from_values(STAND, name="volts", response=Response("displacement", "V")),
    "counts": lambda: Oscillator.from_values(STAND, name="counts", response=Response("displacement", "counts")),
}


@pytest.fixture(scope="session")
def models() -> dict[str, Callable[[], Oscillator]]:
    return MODELS


@pytest.fixture(scope="session")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str], Path]:
    """FMU of a model by its name, built once."""
    folder = tmp_path_factory.mktemp("fmus")

    def get(name: str, backend: str = "native") -> Path:
        path = folder / f"{name}-{backend}.fmu"
        return path if path.exists() else export_fmu(MODELS[name](), path, backend=backend)

    return get


@pytest.fixture(scope="session")
def everywhere(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """The FMU of the base model with binaries for all platforms, for a version of FMI, built once."""
    from dashpot.export.platforms import PLATFORMS
    from dashpot.simulate.zig import zig_version

    if zig_version() is None:
        pytest.skip("the package ziglang, which builds for other platforms, is not installed")
    folder = tmp_path_factory.mktemp("everywhere")

    def get(version: int = 2) -> Path:
        path = folder / f"rig-{version}.fmu"
        return path if path.exists() else export_fmu(MODELS["base"](), path, version=version, platforms=PLATFORMS)

    return get


@pytest.fixture(scope="session")
def fmu_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Native FMU of a model for this machine and a version of FMI, built once."""
    folder = tmp_path_factory.mktemp("versions")

    def get(version: int = 2, name: str = "base") -> Path:
        path = folder / f"{name}-{version}.fmu"
        if not path.exists():
            export_fmu(MODELS[name](), path, version=version, platforms=(own_platform(),))
        return path

    return get


class Instance:
    """An FMU under FMPy, its variables by name; every status above a warning raises."""

    def __init__(self, folder: Path, description: Any, logger: list[str]) -> None:
        import ctypes

        from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

        def log(environment: object, name: bytes, status: int, category: bytes, message: bytes) -> None:
            logger.append(message.decode())

        self.messages = logger
        self.reference = {v.name: v.valueReference for v in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="rig",
        )
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(log)
        self.callbacks.allocateMemory = type(self.callbacks.allocateMemory)(lambda n, size: 0)
        self.callbacks.freeMemory = type(self.callbacks.freeMemory)(lambda pointer: None)
        self.fmu.instantiate(callbacks=self.callbacks, loggingOn=True)  # PythonFMU is silent otherwise
        self.component = ctypes.c_void_p(self.fmu.component)

    def start(self, at: float = 0.0, stop: float | None = None, **values: float) -> Instance:
        self.fmu.setupExperiment(startTime=at, stopTime=stop)
        self.fmu.enterInitializationMode()
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values: float) -> None:
        if values:
            self.fmu.setReal([self.reference[name] for name in values], list(values.values()))

    def get(self, *names: str) -> list[float]:
        return self.fmu.getReal([self.reference[name] for name in names])

    def step(self, t: float, dt: float, force: float | None = None, end: float | None = None) -> None:
        """One step with the force held, or in a straight line to ``end``."""
        if force is not None:
            self.set(F=force)
            if end is not None and "F_rate" in self.reference:
                self.set(F_rate=(end - force) / dt)
            elif end is not None:
                self.fmu.setRealInputDerivatives([self.reference["F"]], [1], [(end - force) / dt])
        self.fmu.doStep(t, dt)

    def record(self, force: Any, dt: float, *names: str) -> list[list[float]]:
        """Outputs at every sample, the force in straight lines between its samples."""
        rows = [self.get(*names)]
        for k in range(len(force) - 1):
            self.step(k * dt, dt, force[k], force[k + 1])
            rows.append(self.get(*names))
        return rows


@pytest.fixture
def instances(fmus: Callable[[str, str], Path], tmp_path: Path) -> Iterator[Callable[..., Instance]]:
    """Makes instances of the FMU of a model, all in this process, and ends them after the test."""
    from fmpy import extract, read_model_description

    made: list[Instance] = []
    known: dict[tuple[str, str], tuple[Path, Any]] = {}

    def make(name: str = "base", backend: str = "native") -> Instance:
        if (name, backend) not in known:
            folder = Path(extract(str(fmus(name, backend)), unzipdir=str(tmp_path / f"{name}-{backend}")))
            known[name, backend] = folder, read_model_description(str(folder))
        made.append(Instance(*known[name, backend], []))
        return made[-1]

    yield make
    for instance in made:
        instance.fmu.fmi2FreeInstance(instance.fmu.component)


@pytest.fixture(scope="session")
def law_fmu(tmp_path_factory: pytest.TempPathFactory, with_law: Callable[..., Oscillator]) -> Callable[..., Path]:
    """Native FMU of the stand with laws of the library, built once: ``law_fmu(3, "hysteresis")``."""
    folder = tmp_path_factory.mktemp("laws")

    def get(version: int, *effects: str, **further: Any) -> Path:
        name = "-".join([str(version), *effects, *(f"{k}={v}" for k, v in further.items())]).replace("/", "_")
        path = folder / f"{name}.fmu"
        if not path.exists():
            with pytest.MonkeyPatch.context() as patch:  # what only surrounds the model takes half of the time
                patch.setattr("dashpot.export.fmu.further_contents", lambda *_: {})
                patch.setattr("dashpot.export.fmu.documentation", lambda *_: "")
                export_fmu(with_law(*effects, **further), path, version=version, platforms=(own_platform(),))
        return path

    return get


@pytest.fixture
def callers(tmp_path: Path) -> Iterator[Callable[..., Caller]]:
    """Makes instances of FMUs of either version and interface in this process, and ends them after the test."""
    from calling import Caller
    from described import MODEL_EXCHANGE, describe
    from fmpy import extract

    made: list[Caller] = []
    known: dict[Path, Any] = {}

    def make(fmu: Path, interface: str = MODEL_EXCHANGE, **how: bool) -> Caller:
        if fmu not in known:
            known[fmu] = describe(fmu), Path(extract(str(fmu), unzipdir=str(tmp_path / f"fmu{len(known)}")))
        made.append(Caller(*known[fmu], interface, **how))
        return made[-1]

    yield make
    for caller in made:
        caller.free()

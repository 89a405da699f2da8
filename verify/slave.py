"""One co-simulation FMU under FMPy, FMI 2.0 or 3.0: an input that runs in curves or lines, and one output."""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..export.platforms import library_for_here

#: Inputs of an FMU whose motion is given; the last is the one that runs in curves or lines.
MOTION = ("displacement", "velocity", "acceleration")
#: What is kept of an FMU that never stops talking.
_MOST_SAID, _LONGEST_SAID = 1000, 2000


class Slave(ABC):
    """An FMU held open: started, stepped, read and started again, any number of times.

    Args:
        description: as FMPy reads it.
        folder: where the FMU was unpacked.
        library: its binary; None for that which FMPy finds.

    Raises:
        BadInput: where the FMU refuses to be instantiated, with what it says.

    Attributes:
        orders: derivatives of the input that a step takes; 0 where the input is held.
        columns: numbers that a step takes: of a motion that is given its place and its channels, the input and its
            derivatives.
        fmu: FMPy's own object.
        said: messages of the FMU, the first ``_MOST_SAID`` of them.
        made: steps made so far.
    """

    def __init__(self, description: Any, folder: str, library: Path | None) -> None:
        self._variables = {v.name: v.valueReference for v in description.modelVariables}
        moved = is_moved(description)
        self._driven = MOTION[-1] if moved else "F"
        beside = channels_of(description)
        self._places = [self._variables[name] for name in (*MOTION[:-1], *beside)] if moved else []
        self._rate = self._variables.get(f"{self._driven}_rate")
        self.orders = 0 if self._rate is None else 1
        self.fmu = self._made()(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="verify",
            libraryPath=None if library is None else str(library),
        )
        self.said: list[str] = []
        self.made = 0
        try:
            self._instantiate()
        except Exception as problem:
            raise BadInput(self.said[-1] if self.said else str(problem)) from problem
        output = next(v for v in description.modelVariables if v.causality == "output")
        self._here = (ctypes.c_uint * 1)(self._variables[self._driven])
        self.show(output.name)
        self._value = (ctypes.c_double * 1)()
        self._fresh = True

    @staticmethod
    @abstractmethod
    def _made() -> Any:
        """FMPy's class."""

    @abstractmethod
    def _instantiate(self) -> None:
        """Instantiate with a logger that keeps what the FMU says."""

    def _log(self, *arguments: Any) -> None:
        """The callback of both versions: the message is its last argument."""
        if len(self.said) < _MOST_SAID:
            self.said.append((arguments[-1] or b"")[:_LONGEST_SAID].decode("utf-8", errors="replace"))

    @abstractmethod
    def _begin(self, time: float, values: Mapping[int, float]) -> None:
        """Initialize at a time with values by their references."""

    @property
    def columns(self) -> int:
        """Numbers of a row."""
        return len(self._places) + 1 + self.orders

    def push(self, row: Sequence[float]) -> None:
        """What is given at the start of the next step: so many numbers as there are ``columns``."""
        if self._places:
            self.put(self._places, row[: len(self._places)])
            row = row[len(self._places) :]
        self.drive(row)

    @abstractmethod
    def put(self, references: Sequence[int], values: Sequence[float]) -> None:
        """Set variables by their references."""

    @abstractmethod
    def drive(self, row: Sequence[float]) -> None:
        """The input at the start of the next step and its derivatives, as many as ``orders``."""

    @abstractmethod
    def step(self, time: float, length: float) -> None:
        """One communication step. Raises FMPy's exception where the FMU cannot do it."""

    @abstractmethod
    def read(self) -> float:
        """The output now: see ``show``."""

    def show(self, output: str) -> None:
        """Read this output from now on; before that it is the first one."""
        self._there = (ctypes.c_uint * 1)(self._variables[output])

    def start(self, time: float, values: Mapping[str, float]) -> None:
        """Start afresh at ``time`` with values by the variables' names."""
        if not self._fresh:
            self.fmu.reset()
        self._fresh = False
        self._begin(time, {self._variables[name]: float(value) for name, value in values.items()})

    def stop(self) -> None:
        """End a run."""
        self.fmu.terminate()

    def close(self) -> None:
        """Give the FMU back."""
        self.fmu.freeInstance()


class Slave2(Slave):
    """FMI 2.0. An FMU of dashpot takes three derivatives of its input, another that can interpolate one."""

    def __init__(self, description: Any, folder: str, library: Path | None) -> None:
        super().__init__(description, folder, library)
        self._curved = bool(description.coSimulation.canInterpolateInputs)
        if self._curved:
            self.orders = 3 if "dashpot" in (description.generationTool or "") else 1
            self._references = (ctypes.c_uint * self.orders)(*[self._variables[self._driven]] * self.orders)
            self._order = (ctypes.c_int * self.orders)(*range(1, self.orders + 1))
            self._slopes = (ctypes.c_double * self.orders)()

    @staticmethod
    def _made() -> Any:
        from fmpy.fmi2 import FMU2Slave

        return FMU2Slave

    def _instantiate(self) -> None:
        import fmpy.fmi2 as fmi

        callbacks = fmi.fmi2CallbackFunctions()
        callbacks.logger = fmi.fmi2CallbackLoggerTYPE(self._log)
        callbacks.allocateMemory = fmi.fmi2CallbackAllocateMemoryTYPE(fmi.calloc)
        callbacks.freeMemory = fmi.fmi2CallbackFreeMemoryTYPE(fmi.free)
        self.fmu.instantiate(callbacks=callbacks)

    def _begin(self, time: float, values: Mapping[int, float]) -> None:
        self.fmu.setupExperiment(startTime=time)
        self.fmu.enterInitializationMode()
        self.fmu.setReal(list(values), list(values.values()))
        self.fmu.exitInitializationMode()

    def put(self, references: Sequence[int], values: Sequence[float]) -> None:
        """By the version's call."""
        self.fmu.setReal(references, values)

    def drive(self, row: Sequence[float]) -> None:
        """The input, and its derivatives where the FMU takes them."""
        fmu = self.fmu
        self._value[0] = row[0]
        fmu.fmi2SetReal(fmu.component, self._here, 1, self._value)
        if self._curved:
            self._slopes[:] = row[1:]
            fmu.fmi2SetRealInputDerivatives(fmu.component, self._references, self.orders, self._order, self._slopes)
        elif self._rate is not None:
            fmu.setReal([self._rate], [row[1]])

    def step(self, time: float, length: float) -> None:
        """By the version's doStep."""
        self.fmu.fmi2DoStep(self.fmu.component, time, length, 1)
        self.made += 1

    def read(self) -> float:
        """The output that is shown."""
        self.fmu.fmi2GetReal(self.fmu.component, self._there, 1, self._value)
        return self._value[0]


class Slave3(Slave):
    """FMI 3.0: the slope of the input is an input of its own, ``F_rate`` or ``acceleration_rate``."""

    @staticmethod
    def _made() -> Any:
        from fmpy.fmi3 import FMU3Slave

        return FMU3Slave

    def _instantiate(self) -> None:
        self.fmu.instantiate(logMessage=self._log)

    def _begin(self, time: float, values: Mapping[int, float]) -> None:
        self.fmu.enterInitializationMode(startTime=time)
        self.fmu.setFloat64(list(values), list(values.values()))
        self.fmu.exitInitializationMode()

    def put(self, references: Sequence[int], values: Sequence[float]) -> None:
        """By the version's call."""
        self.fmu.setFloat64(references, values)

    def drive(self, row: Sequence[float]) -> None:
        """The input, and its derivatives where the FMU takes them."""
        references = [self._here[0]] if self._rate is None else [self._here[0], self._rate]
        self.fmu.setFloat64(references, row[: len(references)])

    def step(self, time: float, length: float) -> None:
        """By the version's doStep, which may also end a simulation, or do less than it was asked, and call that OK."""
        _, ended, early, reached = self.fmu.doStep(time, length)
        if ended:
            raise RuntimeError(f"it asked for the end of the simulation at {time:.6g} s")
        untold = reached == 0.0 and not early  # some leave it as it was
        if early or not (untold or abs(reached - (time + length)) <= 1e-6 * length + 1e-12 * abs(time)):
            raise RuntimeError(f"it stopped at {reached:.6g} s in the step from {time:.6g} s over {length:.6g} s")
        self.made += 1

    def read(self) -> float:
        """The output that is shown."""
        self.fmu.fmi3GetFloat64(self.fmu.component, self._there, 1, self._value, 1)
        return self._value[0]


#: By the number before the point of the FMI version that an FMU states.
SLAVES: Mapping[str, type[Slave]] = {"2": Slave2, "3": Slave3}


def opened(folder: Path, shown: str) -> tuple[Any, Slave]:
    """What an unpacked FMU says of itself, and an instance of it by its binary for this machine.

    Raises:
        BadInput: where it is no co-simulation FMU with an input ``F`` and an output, or does not load.
    """
    description = described(folder, shown)
    library = library_for_here(folder, description.coSimulation.modelIdentifier or "")
    try:
        made = SLAVES[str(description.fmiVersion).partition(".")[0]](description, str(folder), library)
    except Exception as problem:
        raise BadInput(
            f"{shown}: it does not load on this machine ({_said(problem, folder, shown)}); export it here again"
        ) from problem
    return description, made


def is_moved(description: Any) -> bool:
    """Whether the motion is given to it, and a force F comes out."""
    inputs = {variable.name for variable in description.modelVariables if variable.causality == "input"}
    return inputs.issuperset(MOTION)


def channels_of(description: Any) -> tuple[str, ...]:
    """Further inputs of an FMU whose motion is given: what its force depends on."""
    known = {*MOTION, f"{MOTION[-1]}_rate"}
    return tuple(v.name for v in description.modelVariables if v.causality == "input" and v.name not in known)


def described(folder: Path, shown: str) -> Any:
    """What an unpacked FMU says of itself, as FMPy reads it.

    Raises:
        BadInput: where it is no co-simulation FMU with an input ``F`` and an output.
    """
    import fmpy

    try:
        description = fmpy.read_model_description(str(folder))
    except Exception as problem:  # damaged XML
        raise BadInput(f"{shown}: not a readable FMU ({_said(problem, folder, shown)}); export it again") from problem
    if description.coSimulation is None:
        raise BadInput(f"{shown}: verify runs FMUs for co-simulation; this one is for model exchange alone")
    names = [variable.name for variable in description.modelVariables]
    if "F" not in names or not any(variable.causality == "output" for variable in description.modelVariables):
        raise BadInput(f"{shown}: the FMU needs an input named F and an output; found {', '.join(names[:8])}")
    return description


def _said(problem: Exception, folder: Path, shown: str) -> str:
    """What went wrong in a line: FMPy lists every finding of its XML schema."""
    words = " ".join(str(problem).split()).rstrip(".")
    return (words if len(words) <= 200 else f"{words[:200]} ...").replace(str(folder), Path(shown).name)


class Stopped(Exception):
    """A run that the FMU ended, for its cause; ``reached`` (n,) has the output until then, and NaN from there on."""

    def __init__(self, reached: np.ndarray) -> None:
        super().__init__("the run was ended")
        self.reached = reached


def run(
    slave: Slave, how: Mapping[str, Any], rows: Sequence[Sequence[float]] | None, jumps: Sequence[float] | None
) -> np.ndarray:
    """(n,) the output of one run from its start.

    Args:
        slave: the FMU.
        how: ``output`` by its name, ``time`` of the first sample, values to be ``given`` at the start by their names,
            ``n`` samples, ``step`` between two rows, ``per_sample`` of them.
        rows: the input and its derivatives at the start of each step; None: it stays as it is.
        jumps: the input that acts on each sample itself, from the second on, where it is held in between.

    Raises:
        Stopped: where a call of the FMU fails.
    """
    start, step, per_sample = how["time"], how["step"], how["per_sample"]
    slave.show(how["output"])
    slave.start(start, how["given"])
    out = np.full(how["n"], np.nan)
    try:
        out[0] = slave.read()
        pushed = iter(rows or ())
        for i in range(1, how["n"]):
            for k in range((i - 1) * per_sample, i * per_sample):
                if rows is not None:
                    slave.push(next(pushed))
                slave.step(start + k * step, step)
            if jumps is not None and i <= len(jumps):
                slave.push([jumps[i - 1], 0.0, 0.0, 0.0][: 1 + slave.orders])  # it acts on this sample
            out[i] = slave.read()
    except Exception as problem:
        with suppress(Exception):
            slave.stop()
        raise Stopped(out) from problem
    slave.stop()
    return out

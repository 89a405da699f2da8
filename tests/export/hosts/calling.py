"""One FMU of either version and interface under FMPy, in this process: the same calls for all, variables by name."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from described import MODEL_EXCHANGE, Described
from fmpy_instance import made
from integrating import Model


class Caller:
    """An instance; what it logs is kept as (status, text). FMPy raises every status above a warning."""

    def __init__(self, known: Described, folder: Path, interface: str, *, logging: bool = True) -> None:
        from fmpy import fmi2

        self.known, self.exchange, self.second = known, interface == MODEL_EXCHANGE, known.version == 2
        self.messages: list[tuple[int, str]] = []
        self.fmu: Any = made(known, folder, interface)
        if self.second:
            calls = fmi2.fmi2CallbackFunctions()
            calls.logger = fmi2.fmi2CallbackLoggerTYPE(self._log)
            calls.allocateMemory = type(calls.allocateMemory)(lambda n, size: 0)
            calls.freeMemory = type(calls.freeMemory)(lambda pointer: None)
            self._callbacks = calls
            self.fmu.instantiate(callbacks=calls, loggingOn=logging)
        else:
            self.fmu.instantiate(loggingOn=logging, logMessage=lambda *said: self._log(said[0], b"", *said[1:]))

    def _log(self, environment: object, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append((int(status), message.decode()))

    @property
    def texts(self) -> list[str]:
        return [text for _, text in self.messages]

    # modes

    def initialise(self, at: float = 0.0, stop: float | None = None, **values: float) -> Caller:
        if self.second:
            self.fmu.setupExperiment(startTime=at, stopTime=stop)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=at, stopTime=stop)
        self.set(**values)
        return self

    def start(self, at: float = 0.0, stop: float | None = None, **values: float) -> Caller:
        """Initialised, and in model exchange settled and in continuous-time mode."""
        self.initialise(at, stop, **values)
        self.fmu.exitInitializationMode()
        if self.exchange:
            self.settle()
            self.fmu.enterContinuousTimeMode()
        return self

    def settle(self) -> bool:
        """Updates the discrete states until they rest: whether states have changed."""
        changed = False
        update = self.fmu.newDiscreteStates if self.second else self.fmu.updateDiscreteStates
        for _ in range(20):
            told = update()
            changed |= bool(told[3])
            if not told[0]:
                return changed
        raise RuntimeError("event mode does not come to an end")

    def event(self) -> bool:
        self.fmu.enterEventMode()
        changed = self.settle()
        self.fmu.enterContinuousTimeMode()
        return changed

    # values

    def references(self, names: Sequence[str]) -> list[int]:
        return [self.known.references[name] for name in names]

    def put(self, references: Sequence[int], values: Sequence[float]) -> None:
        (self.fmu.setReal if self.second else self.fmu.setFloat64)(references, values)

    def take(self, references: Sequence[int]) -> list[float]:
        return (self.fmu.getReal if self.second else self.fmu.getFloat64)(references)

    def set(self, **values: float) -> None:
        if values:
            self.put(self.references(list(values)), list(values.values()))

    def get(self, *names: str) -> list[float]:
        return self.take(self.references(names))

    def derivative(self, unknown: Sequence[str], known: Sequence[str], seed: Sequence[float]) -> list[float]:
        return self.fmu.getDirectionalDerivative(self.references(unknown), self.references(known), list(seed))

    def adjoint(self, unknown: Sequence[str], known: Sequence[str], seed: Sequence[float]) -> list[float]:
        return self.fmu.getAdjointDerivative(self.references(unknown), self.references(known), list(seed), len(known))

    # co-simulation

    def step(self, t: float, dt: float, force: float | None = None, end: float | None = None) -> None:
        """One step with the force held, or in a straight line to ``end``."""
        if force is not None:
            self.set(F=force)
            rate = 0.0 if end is None else (end - force) / dt
            if self.second:
                self.fmu.setRealInputDerivatives(self.references(["F"]), [1], [rate])
            else:
                self.set(F_rate=rate)
        self.fmu.doStep(t, dt)

    # model exchange

    def _taken(self, call: Any, size: int) -> list[float]:
        buffer = (ctypes.c_double * size)()
        call(buffer, size)
        return list(buffer)

    def set_states(self, states: Sequence[float]) -> None:
        size = len(self.known.states)
        self.fmu.setContinuousStates((ctypes.c_double * size)(*states), size)

    def states(self) -> list[float]:
        return self._taken(self.fmu.getContinuousStates, len(self.known.states))

    def nominals(self) -> list[float]:
        return self._taken(self.fmu.getNominalsOfContinuousStates, len(self.known.states))

    def rates(self) -> list[float]:
        call = self.fmu.getDerivatives if self.second else self.fmu.getContinuousStateDerivatives
        return self._taken(call, len(self.known.states))

    def indicators(self) -> list[float]:
        return self._taken(self.fmu.getEventIndicators, self.known.indicators)

    def model(self) -> Model:
        """The calls that an integrator makes."""
        return Model(
            self.fmu.enterInitializationMode,
            self.fmu.exitInitializationMode,
            self.put,
            self.take,
            self.fmu.setTime,
            self.set_states,
            self.states,
            self.rates,
            self.indicators,
            self.fmu.enterEventMode,
            self.settle,
            self.fmu.enterContinuousTimeMode,
            lambda: self.fmu.completedIntegratorStep()[0],
        )

    # stored states

    def keep(self) -> ctypes.c_void_p:
        return self.fmu.getFMUstate() if self.second else self.fmu.getFMUState()

    def back(self, kept: ctypes.c_void_p) -> None:
        (self.fmu.setFMUstate if self.second else self.fmu.setFMUState)(kept)

    def forget(self, kept: ctypes.c_void_p) -> None:
        (self.fmu.freeFMUstate if self.second else self.fmu.freeFMUState)(kept)

    def bytes_of(self, kept: ctypes.c_void_p) -> bytes:
        return bytes((self.fmu.serializeFMUstate if self.second else self.fmu.serializeFMUState)(kept))

    def free(self) -> None:
        (self.fmu.fmi2FreeInstance if self.second else self.fmu.fmi3FreeInstance)(self.fmu.component)

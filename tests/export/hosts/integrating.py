"""An importer's integrator for model exchange: Dormand and Prince's fifth-order pair at a fixed step, events located.

Written for these tests alone, so that what it says of an FMU owes nothing to the engine inside the FMU.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from described import Described

_C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0])
_A = [
    [],
    [1 / 5],
    [3 / 40, 9 / 40],
    [44 / 45, -56 / 15, 32 / 9],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
]
_B = np.array([35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84])
#: An event is located to this part of the sample interval.
_SHARP = 1e-12
#: More events than this within one sample interval, and the FMU is switching without end.
_MOST_EVENTS = 200


@dataclass(frozen=True)
class Model:
    """An instance for model exchange before its initialization mode, as its calls.

    ``settle`` iterates the discrete states in event mode until they rest; ``completed`` says whether the FMU asks for
    event mode after a step.
    """

    enter_initialization: Callable[[], object]
    exit_initialization: Callable[[], object]
    put: Callable[[Sequence[int], Sequence[float]], object]
    take: Callable[[Sequence[int]], Sequence[float]]
    set_time: Callable[[float], object]
    set_states: Callable[[Sequence[float]], object]
    states: Callable[[], Sequence[float]]
    rates: Callable[[], Sequence[float]]
    indicators: Callable[[], Sequence[float]]
    enter_event_mode: Callable[[], object]
    settle: Callable[[], object]
    enter_continuous_time_mode: Callable[[], object]
    completed: Callable[[], bool]


class _Flow:
    """The FMU within one sample interval, in which the force is a straight line, or all inputs what ``given`` says."""

    def __init__(
        self, model: Model, inputs: list[int], given: Callable[[float], Sequence[float]] | None = None
    ) -> None:
        self.model, self.inputs, self.given = model, inputs, given
        self.begin, self.value, self.rate = 0.0, 0.0, 0.0

    def at(self, t: float, x: np.ndarray) -> None:
        self.model.set_time(t)
        if self.given is not None:
            self.model.put(self.inputs, self.given(t))
        elif self.inputs:
            self.model.put(self.inputs, [self.value + self.rate * (t - self.begin)])
        self.model.set_states(x.tolist())

    def step(self, t: float, x: np.ndarray, h: float) -> np.ndarray:
        """One step; leaves the FMU at its end."""
        k: list[np.ndarray] = []
        for c, row in zip(_C, _A, strict=True):
            self.at(t + c * h, x + h * sum((a * r for a, r in zip(row, k, strict=True)), np.zeros(x.size)))
            k.append(np.array(self.model.rates()))
        out = x + h * sum((b * r for b, r in zip(_B, k, strict=True)), np.zeros(x.size))
        self.at(t + h, out)
        return out


def integrate(
    model: Model,
    known: Described,
    force: np.ndarray,
    dt: float,
    parameters: dict[str, float],
    hold: str,
    source: str,
    output: str,
    steps: int = 2,
) -> np.ndarray:
    """(n,) output at the samples of the force, with so many steps to each interval."""
    inputs = [known.references[source]] if source else []
    outputs = [known.references[output]]
    model.enter_initialization()
    if parameters:
        model.put([known.references[name] for name in parameters], list(parameters.values()))
    if inputs:
        model.put(inputs, [force[0]])
    model.exit_initialization()
    model.settle()
    model.enter_continuous_time_mode()
    flow, state = _Flow(model, inputs), np.array(model.states())
    responses = np.empty(force.size)
    responses[0] = model.take(outputs)[0]
    for k in range(force.size - 1):
        flow.begin, flow.value = k * dt, float(force[k])
        flow.rate = float(force[k + 1] - force[k]) / dt if hold == "first" else 0.0
        if hold == "zero" and k > 0 and inputs:  # a jump of an input is an event
            flow.at(k * dt, state)
            state = _event(model)
        for part in range(steps):
            state = _interval(flow, k * dt + part * dt / steps, state, dt / steps)
        responses[k + 1] = model.take(outputs)[0]
    return responses


def integrate_along(
    model: Model,
    inputs: list[int],
    outputs: list[int],
    given: Callable[[float], Sequence[float]],
    dt: float,
    n: int,
    steps: int,
) -> np.ndarray:
    """(n, outputs) outputs at samples ``dt`` apart along inputs that are functions of time, by their references."""
    model.enter_initialization()
    model.put(inputs, given(0.0))
    model.exit_initialization()
    model.settle()
    model.enter_continuous_time_mode()
    flow, state, made = _Flow(model, inputs, given), np.array(model.states()), []
    for k in range(n):
        flow.at(k * dt, state)
        made.append(model.take(outputs))
        for part in range(steps):
            state = _interval(flow, k * dt + part * dt / steps, state, dt / steps)
    return np.array(made)


def _interval(flow: _Flow, t: float, x: np.ndarray, h: float) -> np.ndarray:
    """From t to t + h through all events."""
    model, end = flow.model, t + h
    for _ in range(_MOST_EVENTS):
        flow.at(t, x)
        before = np.array(model.indicators())
        remaining = end - t
        new = flow.step(t, x, remaining)
        if not _crossed(before, np.array(model.indicators())):
            if model.completed():
                return _event(model)
            return new
        low, high = 0.0, remaining
        while high - low > _SHARP * h:
            middle = 0.5 * (low + high)
            flow.step(t, x, middle)
            if _crossed(before, np.array(model.indicators())):
                high = middle
            else:
                low = middle
        flow.step(t, x, high)
        model.completed()
        t, x = t + high, _event(model)
        if end - t <= _SHARP * h:
            return x
    raise RuntimeError(f"more than {_MOST_EVENTS} events around t = {t} s")


def _crossed(before: np.ndarray, after: np.ndarray) -> bool:
    """FMI's rule: an indicator goes from above zero to zero or below, or the other way round."""
    return bool(np.any((before > 0) != (after > 0)))


def _event(model: Model) -> np.ndarray:
    model.enter_event_mode()
    model.settle()
    model.enter_continuous_time_mode()
    return np.array(model.states())

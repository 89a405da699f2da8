"""A model's compiled core: event-exact simulation of whole recordings."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from importlib import resources
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from ..model.equations import equations
from .compiler import shared_library
from .force import Force, straight_lines
from .law_source import law_source

if TYPE_CHECKING:
    from ..model import Oscillator

_DOUBLES = ctypes.POINTER(ctypes.c_double)
#: Internal steps per period of the fastest motion: Dormand-Prince then errs by about 1e-10 of the amplitude a step.
STEPS_PER_PERIOD = 75.0


def template(name: str) -> str:
    """Text of one of the C templates."""
    return resources.files("dashpot.templates").joinpath(name).read_text(encoding="utf-8")


class Core:
    """The compiled equations of one model structure; parameters are an argument, so one core serves a whole fit."""

    def __init__(self, oscillator: Oscillator) -> None:
        self.equations = equations(oscillator)
        self.parameter_names = self.equations.parameter_names
        self.states = len(self.equations.state_names)
        sources = {
            "law.c": law_source(self.equations),
            "engine.h": template("engine.h"),
            "engine.c": template("engine.c"),
            "record.c": template("record.c"),
            "core.c": '#include "law.c"\n#include "engine.c"\n#include "record.c"\n',
        }
        self._library = ctypes.CDLL(str(shared_library(sources, "core.c")))
        self._record = self._library.dp_record
        self._record.restype = ctypes.c_long
        self._record.argtypes = [
            _DOUBLES,
            _DOUBLES,
            ctypes.c_double,
            _DOUBLES,
            ctypes.c_long,
            ctypes.c_int,
            ctypes.c_double,
            ctypes.c_double,
            _DOUBLES,
            _DOUBLES,
        ]

    def record(
        self,
        values: np.ndarray,
        initial: np.ndarray,
        force: Force | np.ndarray | None,
        n: int,
        dt: float,
        max_step: float,
        *,
        start: float = 0.0,
        states: bool = False,
    ) -> np.ndarray:
        """Response over a recording.

        Args:
            values: parameters in the order of ``parameter_names``.
            initial: (2,) displacement and velocity at the first sample.
            force: the force between the samples (see ``force.Force``), or (n,) values joined by straight lines
                (first-order hold, as an FMU takes it); None for free motion.
            n: number of samples.
            dt: sample interval, s.
            max_step: longest internal step, s.
            start: time of the first sample, s.
            states: whether to return the states instead of the response.

        Returns:
            (n,) response as recorded, or (n, states); NaN from where the simulation failed (the motion grew beyond
            bounds or chattered without end).
        """
        values = np.ascontiguousarray(values, float)
        initial = np.ascontiguousarray(initial, float)
        if isinstance(force, np.ndarray):
            force = straight_lines(force, dt)
        if force is not None and force.pieces.shape[0] < (n - 1) * force.fine:
            raise BadInput(f"the force covers {force.pieces.shape[0] // force.fine + 1} samples where {n} are needed")
        y = np.full(n, np.nan)
        z = np.full((n, self.states), np.nan) if states else None
        self._record(
            values.ctypes.data_as(_DOUBLES),
            initial.ctypes.data_as(_DOUBLES),
            start,
            None if force is None else force.pieces.ctypes.data_as(_DOUBLES),
            n,
            1 if force is None else force.fine,
            dt,
            max_step,
            y.ctypes.data_as(_DOUBLES),
            None if z is None else z.ctypes.data_as(_DOUBLES),
        )
        return y if z is None else z


_cores: dict[tuple[object, ...], Core] = {}


def core_of(oscillator: Oscillator) -> Core:
    """The core for the structure of ``oscillator`` (which laws, which response), built at first use."""
    key = (tuple(oscillator.parameters()), oscillator.response.quantity)
    if key not in _cores:
        _cores[key] = Core(oscillator)
    return _cores[key]


def internal_step(oscillator: Oscillator, values: Mapping[str, float], amplitude: float) -> float:
    """Longest internal step for a model: a seventy-fifth of the fastest period within the amplitude.

    The fastest rate is the largest eigenvalue of the linearised equations at rest and at both ends of the motion.
    """
    import casadi as ca

    eq = equations(oscillator)
    jacobian = ca.Function("jacobian", [eq.z, eq.t, eq.u, eq.p, eq.s], [ca.jacobian(eq.zdot, eq.z)])
    p = [values[name] for name in eq.parameter_names]
    rate = 0.0
    for x in (0.0, amplitude, -amplitude):
        matrix = np.array(jacobian([x, 0.0], 0.0, 0.0, p, [1.0] * len(eq.kinds)))
        rate = max(rate, float(np.max(np.abs(np.linalg.eigvals(matrix)))))
    if not np.isfinite(rate) or rate <= 0.0:
        raise BadInput("the model has no motion to integrate: its fastest rate is not a positive number")
    return 2.0 * np.pi / rate / STEPS_PER_PERIOD

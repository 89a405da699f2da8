"""A model's compiled core: event-exact simulation of whole recordings."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .. import engine
from ..errors import BadInput
from ..files.computed_once import computed_once
from ..model.equations import Equations, Structure, equations, equations_of, structure_of
from ..model.law import Expression
from .compiler import loaded_library
from .force import Force, straight_lines
from .law_source import law_source
from .sides import Sides, done, filled
from .slopes_source import LANES
from .work import TOTAL

if TYPE_CHECKING:
    from ..model import Oscillator
    from ..model.element import Element

_DOUBLES = ctypes.POINTER(ctypes.c_double)
_BYTES = ctypes.POINTER(ctypes.c_byte)
_INTEGERS = ctypes.POINTER(ctypes.c_int)
#: Further flags of the compiler where derivatives go along: loops over unknowns side by side become vectors, in which
#: each number is what it would be alone.
CARRYING = ("-ftree-vectorize",)
#: Internal steps per period of the fastest motion: Dormand-Prince then errs by about 1e-10 of the amplitude a step.
STEPS_PER_PERIOD = 75.0


class _Recording(ctypes.Structure):
    """``dp_recording`` of engine/record.c."""

    _fields_: ClassVar = [
        *((name, _DOUBLES) for name in ("p", "z0")),
        ("force", ctypes.c_void_p),
        *((name, _DOUBLES) for name in ("added", "measured", "gain")),
        ("given", _BYTES),
        ("y", _DOUBLES),
        ("z", _DOUBLES),
        ("kept", _BYTES),
        ("sides", ctypes.c_void_p),
        *((name, ctypes.c_long) for name in ("parts", "n")),
        *((name, ctypes.c_double) for name in ("t0", "dt", "max_step", "load")),
        *((name, ctypes.c_int) for name in ("fine", "joined", "lines", "shown", "single")),
    ]


#: How many unknowns go side by side; how each pushes (lanes,), moves the state and what was measured (.., LANES).
_Lanes = tuple[int, np.ndarray, np.ndarray, np.ndarray]


class Core:
    """The compiled equations of one model structure; parameters are an argument, so one core serves a whole fit.

    Args:
        oscillator: has the structure.
        carried: whether it is compiled with what derivatives need at once, for all that is asked of it: that takes
            three times as long, and less than one compilation without it and one with it.
    """

    def __init__(self, oscillator: Oscillator | Element, *, carried: bool = False) -> None:
        self.equations = equations(oscillator)
        self.quantity = self.equations.recorded
        self.parameter_names = self.equations.parameter_names
        self.states = len(self.equations.state_names)
        self._library, self._carries = self._built(carried), carried
        self._record = self._library.dp_record
        self._record.restype = ctypes.c_long
        self._record.argtypes = [ctypes.POINTER(_Recording)]
        self._done = done(self._library)
        self._known_lanes: dict[tuple[int, ...], _Lanes] = {}

    def _built(self, carried: bool) -> ctypes.CDLL:
        """The compiled engine behind these equations, with derivatives that go along or without."""
        before, behind = (engine.CARRIED[:1], engine.CARRIED[1:]) if carried else ((), ())
        files = (*engine.ENGINE, engine.RECORD, *before, *behind)
        sources = {
            "law.c": law_source(self.equations, carried=carried),
            **{name: engine.text(name) for name in files},
            "core.c": engine.included("law.c", *before, engine.ENGINE[-1], *behind, engine.RECORD),
        }
        return loaded_library(sources, "core.c", flags=CARRYING if carried else ())

    @computed_once
    def unknowns(self) -> tuple[str, ...]:
        """What ``record_with_derivatives`` can take derivatives by: the parameters, the initial states, ``load``,
        ``measured``, a constant added to what was measured, and ``drift``, by which that grows in a second."""
        states = (f"initial {name}" for name in self.equations.state_names)
        return (*self.parameter_names, *states, "load", "measured", "drift")

    @computed_once
    def _carried(self) -> Any:
        """``dp_record_carried``, compiled where it is first asked for."""
        record = (self._library if self._carries else self._built(carried=True)).dp_record_carried
        record.restype = ctypes.c_long
        record.argtypes = [
            ctypes.POINTER(_Recording),
            ctypes.c_int,
            ctypes.c_long,
            _DOUBLES,
            _INTEGERS,
            _DOUBLES,
            _DOUBLES,
            ctypes.c_void_p,
            _INTEGERS,
            ctypes.c_int,
            _DOUBLES,
            ctypes.c_void_p,
        ]
        return record

    def begin(self, initial: np.ndarray) -> np.ndarray:
        """(states,) at the start, from displacement, velocity and what the inner states differ by."""
        z = np.zeros(self.states)
        z[: len(initial)] = initial
        for i, leader in enumerate(self.equations.follows):
            z[i] += 0.0 if leader is None else z[leader]
        return z

    def reaches(self, values: np.ndarray) -> np.ndarray:
        """(states,) how far each inner state goes at these parameters; 0 where nothing limits it."""
        return np.concatenate([np.zeros(2), np.array(self._reaches(values)).ravel()])

    @computed_once
    def _reaches(self) -> Expression:
        import casadi as ca

        return ca.Function("reaches", [self.equations.p], [self.equations.reaches])

    def initial(self, z: np.ndarray) -> np.ndarray:
        """What ``begin`` makes the states ``z`` of."""
        states = np.array(z, float)
        for i, leader in enumerate(self.equations.follows):
            states[i] -= 0.0 if leader is None else z[leader]
        return states

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
        measured: np.ndarray | None = None,
        gain: np.ndarray | None = None,
        signs: np.ndarray | None = None,
        keep: np.ndarray | None = None,
        quantity: str | None = None,
        added: np.ndarray | None = None,
        load: float = 0.0,
        out: np.ndarray | None = None,
        sides: Sides | None = None,
    ) -> np.ndarray:
        """Response over a recording, or its prediction from one sample to the next.

        Args:
            values: parameters in the order of ``parameter_names``.
            initial: displacement and velocity at the first sample, (2,), and for a law with a memory also by how much
                its states differ there from what they follow, (states,).
            force: the force between the samples (see ``force.Force``), or (n,) values joined by straight lines
                (first-order hold, as an FMU takes it); None for free motion.
            n: number of samples.
            dt: sample interval, s.
            max_step: longest internal step, s.
            start: time of the first sample, s.
            states: whether to return the states instead of the response.
            measured: (n,) what was measured. The state is moved after each sample by ``gain`` times what was measured
                beyond the response; None simulates freely.
            gain: (states,) by how much; given with ``measured``.
            signs: (n, surfaces + 1) int8, as ``keep`` took them from another run: the response is what the states give
                under these, so that its change with a parameter has no jumps.
            keep: (n, surfaces + 1) int8, filled with the signs at each sample.
            quantity: what the recording shows; None is what the model's response is. Another one is the motion itself:
                the model's laws of a sensor are of its own response.
            added: (n,) samples of what is added to the force, as ``Force.with_added`` joins them, without a copy of it.
            load: a constant that is added to it.
            out: (n,) where the response goes, if given.
            sides: filled with what samples beside a jump are on its other side; of a simulation.

        Returns:
            (n,) response as recorded, or (n, states); NaN from where the simulation failed (the motion grew beyond
            bounds or chattered without end).
        """
        y = np.empty(n) if out is None else out
        y.fill(np.nan)
        z = np.full((n, self.states), np.nan) if states else None
        asked, kept = self._recording(
            values, initial, force, n, dt, max_step, start, measured, gain, signs, added, load
        )
        asked.y, asked.z, asked.kept = _pointer(y), _pointer(z), _bytes(keep)
        asked.shown = self.equations.output(quantity or self.quantity)
        with filled(self._done, sides, asked, 0):
            begin = time.thread_time()
            self._record(ctypes.byref(asked))
            TOTAL.run(n, 0, time.thread_time() - begin)
        del kept
        return y if z is None else z

    def record_with_derivatives(
        self,
        values: np.ndarray,
        initial: np.ndarray,
        force: Force | np.ndarray | None,
        n: int,
        dt: float,
        max_step: float,
        *,
        by: Sequence[int],
        start: float = 0.0,
        measured: np.ndarray | None = None,
        gain: np.ndarray | None = None,
        signs: np.ndarray | None = None,
        keep: np.ndarray | None = None,
        quantity: str | None = None,
        added: np.ndarray | None = None,
        load: float = 0.0,
        out: np.ndarray | None = None,
        rows: Sequence[int] | None = None,
        sides: Sides | None = None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """The response of ``record``, to the bit, and its derivatives from the same run.

        At an event the derivatives of the state jump by the saltation matrix (Aizerman and Gantmacher 1958; Hiskens and
        Pai 2000). A sample of a response that jumps itself has the derivative of the side that it shows.

        Args:
            values, initial, force, n, dt, max_step, start, measured, gain, signs, keep, quantity, added, load,
                sides: as for ``record``.
            by: what to take derivatives by, as places in ``unknowns``.
            out: (more, n) where the derivatives go, in double or in single precision; an array of its own where None.
            rows: in which of its rows each of them goes; the first ones where None.

        Returns:
            (n,) response, and (len(by), n) its derivatives, or ``out``; NaN from where the simulation failed. Where the
            motion grazes a surface the derivatives grow beyond bounds.
        """
        y, derivatives = np.full(n, np.nan), np.empty((len(by), n)) if out is None else out
        into = np.array(range(len(by)) if rows is None else rows, np.int32)
        derivatives[into] = np.nan
        asked, kept = self._recording(
            values, initial, force, n, dt, max_step, start, measured, gain, signs, added, load
        )
        asked.y, asked.kept = _pointer(y), _bytes(keep)
        asked.shown = self.equations.output(quantity or self.quantity)
        with filled(self._done, sides, asked, len(by)):
            self._carry(asked, self._lanes_of(tuple(by)), derivatives, into)
        del kept
        return y, derivatives

    def transitions(
        self,
        values: np.ndarray,
        initial: np.ndarray,
        force: Force | None,
        n: int,
        dt: float,
        max_step: float,
        *,
        start: float = 0.0,
        measured: np.ndarray | None = None,
        gain: np.ndarray | None = None,
        quantity: str | None = None,
        load: float = 0.0,
        sides: Sides | None = None,
        single: bool = False,
    ) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
        """The linearised motion from each sample of a run to the next.

        Args:
            values, initial, force, n, dt, max_step, start, measured, gain, quantity, load, sides: as for ``record``;
                the derivatives of other sides are by the state there, and by the force.
            single: whether the derivatives come in single precision.

        Returns:
            (n,) response; and (n, states, states) derivatives of the state at each sample by that at the one before,
            both before a prediction corrects them; (n, states) by a constant force between the two; (n, states) of the
            response by the state there; (n,) of the response by the force there. NaN from where the simulation failed.
        """
        s, y, kind = self.states, np.full(n, np.nan), np.float32 if single else float
        derivatives = np.full((s + 1, n), np.nan, kind)
        asked, kept = self._recording(values, initial, force, n, dt, max_step, start, measured, gain, None, None, load)
        asked.y, asked.shown = _pointer(y), self.equations.output(quantity or self.quantity)
        which = [len(self.parameter_names)] * s + [len(self.parameter_names) + 1]
        along = np.full((n, s, s + 1), np.nan, kind)
        into = np.arange(s + 1, dtype=np.int32)
        with filled(self._done, sides, asked, s + 1):
            self._carry(asked, self._lanes([*np.eye(s), np.zeros(s)], which, []), derivatives, into, along=along)
        del kept
        return y, (along[:, :, :s], along[:, :, s], derivatives[:s].T, derivatives[s])

    def _lanes_of(self, by: tuple[int, ...]) -> _Lanes:
        """How derivatives by unknowns begin."""
        if by not in self._known_lanes:
            count, states = len(self.parameter_names), self.states
            moved = [np.eye(states)[k - count] if count <= k < count + states else np.zeros(states) for k in by]
            which = [k if k < count else count + 1 if k == count + states else count for k in by]
            sensed = [(float(k == count + states + 1), float(k == count + states + 2)) for k in by]
            self._known_lanes[by] = self._lanes([self.begin(one) for one in moved], which, sensed)
        return self._known_lanes[by]

    def _lanes(
        self, moved: Sequence[np.ndarray], which: Sequence[int], sensed: Sequence[tuple[float, float]]
    ) -> _Lanes:
        """Unknowns side by side: which push, what each moves the state by at the start, and the sensor."""
        blocks = -(-len(moved) // LANES)
        places = np.full(blocks * LANES, len(self.parameter_names), np.int32)
        places[: len(which)] = which
        directions, of_sensor = np.zeros((2 * blocks, self.states, LANES)), np.zeros((blocks, 2, LANES))
        for k, one in enumerate(moved):
            directions[k // LANES, :, k % LANES] = one
        for k, pair in enumerate(sensed):
            of_sensor[k // LANES, :, k % LANES] = pair
        return len(moved), places, directions, of_sensor

    def _carry(
        self,
        asked: _Recording,
        lanes: _Lanes,
        derivatives: np.ndarray,
        into: np.ndarray,
        along: np.ndarray | None = None,
    ) -> None:
        """Run the engine with derivatives by unknowns that move the state at the start, or push later, in rows (n,)."""
        count, places, directions, of_sensor = lanes
        moving, anew, begin = directions.copy(), directions.copy(), time.thread_time()
        self._carried(
            ctypes.byref(asked),
            len(of_sensor),
            count,
            _pointer(moving),
            places.ctypes.data_as(_INTEGERS),
            _pointer(of_sensor),
            _pointer(np.zeros(2 * len(of_sensor) * LANES)),
            derivatives.ctypes.data,
            into.ctypes.data_as(_INTEGERS),
            derivatives.dtype == np.float32,
            _pointer(anew),
            None if along is None else along.ctypes.data,
        )
        TOTAL.run(asked.n, count, time.thread_time() - begin)

    def _recording(
        self,
        values: np.ndarray,
        initial: np.ndarray,
        force: Force | np.ndarray | None,
        n: int,
        dt: float,
        max_step: float,
        start: float,
        measured: np.ndarray | None,
        gain: np.ndarray | None,
        signs: np.ndarray | None,
        added: np.ndarray | None,
        load: float,
    ) -> tuple[_Recording, list[np.ndarray | None]]:
        """What the engine is asked for, and the arrays that it points to."""
        if isinstance(force, np.ndarray):
            force = straight_lines(force, dt)
        if force is not None and force.pieces.shape[0] < (n - 1) * force.fine:
            raise BadInput(f"the force covers {force.pieces.shape[0] // force.fine + 1} samples where {n} are needed")
        pieces = None if force is None else force.pieces
        arrays = [
            np.ascontiguousarray(values, float),
            self.begin(initial),
            None if added is None else np.ascontiguousarray(added[:n], float),
            None if measured is None else np.ascontiguousarray(measured, float),
            None if measured is None else np.ascontiguousarray(gain, float),
        ]
        start_of, *rest = (_pointer(array) for array in arrays)
        asked = _Recording(start_of, rest[0], None if pieces is None else pieces.ctypes.data, *rest[1:], _bytes(signs))
        asked.single = pieces is not None and pieces.dtype == np.float32
        asked.n, asked.parts = n, 0 if pieces is None else pieces.shape[0]
        asked.t0, asked.dt, asked.max_step, asked.load = start, dt, max_step, load
        asked.fine, asked.joined = (1, 1) if force is None else (force.fine, force.joined)
        asked.lines = force is not None and force.hold != "zero" and force.fine == force.joined
        return asked, [*arrays, pieces, signs]

    def signs(self, n: int) -> np.ndarray:
        """(n, surfaces + 1) room for the signs of a run; see ``record``."""
        return np.zeros((n, len(self.equations.kinds) + 1), np.int8)


def _pointer(values: np.ndarray | None) -> Any:
    return None if values is None else values.ctypes.data_as(_DOUBLES)


def _bytes(values: np.ndarray | None) -> Any:
    return None if values is None else values.ctypes.data_as(_BYTES)


_cores: dict[Structure, Core] = {}


@cache
def _linearised(structure: Structure) -> tuple[Equations, Expression, Expression]:
    """Equations of a structure, their Jacobian in the state, and how far inner states reach, as functions."""
    import casadi as ca

    eq = equations_of(structure)
    jacobian = ca.Function("jacobian", [eq.z, eq.t, eq.u, eq.p, eq.s], [ca.densify(ca.jacobian(eq.zdot, eq.z))])
    return eq, jacobian, ca.Function("reaches", [eq.p], [eq.reaches])


def core_of(oscillator: Oscillator | Element, *, carried: bool = False) -> Core:
    """The core for the structure of ``oscillator`` (which laws, which response), built at first use.

    ``carried`` says that derivatives will be asked of it, see ``Core``.
    """
    key = structure_of(oscillator)
    if key not in _cores:
        _cores[key] = Core(oscillator, carried=carried)
    return _cores[key]


#: The same for motions faster than the rig's own (contacts, resonators), which are short or small.
_FAST_STEPS_PER_PERIOD = 30.0
#: A motion at this part of its rate or more is a decay: Dormand-Prince follows it with few steps per time constant.
_DAMPED = 0.5
_STEPS_PER_DECAY = 1.5
#: More internal steps than these are a slip of units, as in the FMU (``DP_MOST_STEPS``).
_MOST_STEPS = 1e8


def internal_step(oscillator: Oscillator, values: Mapping[str, float], amplitude: float) -> float:
    """Longest internal step for a model within the amplitude: ``longest_step`` at its natural frequency."""
    eq = _linearised(structure_of(oscillator))[0]
    known = [values[name] for name in eq.parameter_names]
    return longest_step(oscillator, known, amplitude, values["omega0"])


def longest_step(oscillator: Oscillator | Element, p: Sequence[float], amplitude: float, pace: float) -> float:
    """Longest internal step for a motion of an amplitude at a pace, rad/s; ``p`` are the values of the parameters.

    The rates are the eigenvalues of the linearised equations at rest and at both ends and in the middle of the motion,
    whichever side of its surfaces it is on: a seventy-fifth of the rig's own period, a thirtieth of that of a faster
    motion, and two thirds of a time constant of what merely decays.
    """
    eq, jacobian, reaches = _linearised(structure_of(oscillator))
    reach = np.array(reaches(p)).ravel()
    count = len(eq.kinds)
    speed = amplitude * pace
    rates: list[np.ndarray] = []
    for x, v in ((0.0, 0.0), (amplitude, 0.0), (-amplitude, 0.0), (0.0, speed), (0.0, -speed)):
        for signs in ([1.0] * count, [-1.0] * count):
            begin = [x, v, *(0.0 if leader is None else (x, v)[leader] for leader in eq.follows[2:])]
            begin[2:] = np.add(begin[2:], reach).tolist()
            matrix = np.array(jacobian(begin, 0.0, 0.0, p, signs))
            if np.all(np.isfinite(matrix)):
                rates.append(np.linalg.eigvals(matrix))
    if oscillator.imposed:  # whose motion has no rate of its own
        rates.append(np.array([1j * pace]))
    eigenvalues = np.concatenate(rates) if rates else np.zeros(1)
    size = np.abs(eigenvalues)
    slow = 3.0 * pace if eq.inner or count > 2 else np.inf
    decays = np.abs(np.real(eigenvalues)) > _DAMPED * size
    steps = np.where(size <= slow, STEPS_PER_PERIOD, _FAST_STEPS_PER_PERIOD) / (2 * np.pi)
    fastest = float(np.max(np.where(decays & (size > slow / 3.0), _STEPS_PER_DECAY, steps) * size, initial=0.0))
    if not np.isfinite(fastest) or fastest <= 0.0:
        raise BadInput("the model has no motion to integrate: its fastest rate is not a positive number")
    return 1.0 / fastest


def step_for(oscillator: Oscillator, amplitude: float, seconds: float) -> float:
    """``internal_step`` of a model's own values; raises BadInput where so many seconds take more steps than is sane."""
    step = internal_step(oscillator, oscillator.values(), amplitude)
    if seconds > _MOST_STEPS * step:
        raise BadInput(
            f"the model's fastest motion within {amplitude:.3g} {oscillator.response.displacement_unit} takes "
            f"{1 / step:.1g} steps a second, which are more than {_MOST_STEPS:.0g} "
            f"for {seconds:.4g} s; check units and parameters"
        )
    return step

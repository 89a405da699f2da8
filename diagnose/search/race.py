"""The race: of all starts the one that promises most goes on; one leaves when its promise cannot reach the leader.

A start is a structure with values. Each of its steps is one of Levenberg and Marquardt, and the linearised response
says beforehand what the next one could come to, in the measure in which all are compared. Far from the truth the steps
are those of white noise, near it every frequency is weighted by the noise that the nearest of them leaves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ...errors import DashpotError
from ...identify.fit.from_prediction import EARLY_STEPS, memories
from ...identify.problem.data import Data, likelihood
from ...identify.problem.descent import Descent
from ...identify.problem.limits import KEPT_PROMISE
from ...identify.problem.output_error import OutputError, State
from ...identify.problem.prediction import FREE
from ...identify.problem.search_point import SHOWN
from ...identify.problem.segments import Segment
from ...identify.problem.settle import follows, settled
from ...identify.problem.structure import Fitted, Structure, shapes_of
from ...identify.signals.odds import DECISIVE, ONE_ERROR
from ...identify.signals.registry import budget
from ...model import Oscillator
from ...model.terms import with_values
from ..limits import LEAST_CREDIT
from .measure import Measure, measure_by

PATIENCE = budget(
    3, "steps", why="that a start far from the truth is given before its promise counts: the first turn into its valley"
)
_MOST_STEPS = budget(
    100, "steps", why="quadratic convergence needs ten, the bent valley of a contact with play some dozens"
)


@dataclass(frozen=True, eq=False)
class Entry:
    """A structure with values as it is proposed.

    Attributes:
        laws: name of the structure.
        model: structure and values.
        initial: (segments, states) initial states; found where None.
        offsets: what the sensors show at zero; found where None.
        fixed: names of parameters that keep their values.
        hoped: log-likelihood that whoever proposes it expects, before it has a promise of its own; infinite where it
            must look for itself.
        patience: steps that it is given before its promise counts against it: far from the truth the linearised
            response knows little.
        adds: whether it is the structure that it is held against with something more, which must pay for that.
    """

    laws: tuple[str, ...]
    model: Oscillator
    initial: np.ndarray | None = None
    offsets: np.ndarray | None = None
    fixed: Sequence[str] = ()
    hoped: float = np.inf
    patience: int = 0
    adds: bool = False


class Start:
    """A structure with values, on its way to the maximum of its likelihood.

    Args:
        entry: as it was proposed.
        data: training recordings.
        measure: in which it is compared.

    Attributes:
        laws, model, hoped, patience, adds: see ``Entry``; the model as far as it came.
        value: log-likelihood here, in the measure of all; -inf where it does not simulate.
        near: whether it leaves about the noise.
        ceiling: what it promises to reach.
        resting: whether it is at its maximum, or cannot move.
        steps: taken so far.
    """

    def __init__(self, entry: Entry, data: Data, measure: Measure) -> None:
        self.laws, self.model, self.adds = entry.laws, entry.model, entry.adds
        self.hoped, self.patience = entry.hoped, entry.patience
        self.data = data
        self.structure = Structure(entry.model, data, entry.fixed)
        self.measure = measure
        problem = self.structure.problem
        state, residuals = self._begun(
            problem, self.structure.state(entry.initial, entry.offsets), found=entry.initial is None
        )
        self.descent = Descent(problem, state, residuals=residuals)
        self.steps = 0
        self.credit, self._gained = 1.0, 0.0
        self._white = True
        self._promised: float | None = None
        self._rested: tuple[np.ndarray, ...] | None = None
        self.resting = False
        self._measure()
        self.resting = not np.isfinite(self.value)

    def _begun(self, problem: OutputError, state: State, *, found: bool) -> tuple[State, tuple[np.ndarray, ...]]:
        """Where it begins: as proposed or, where that loses the motion, with initial states that the first cycles show.

        Initial states are unknowns of the search like others. Where whoever proposed it had lost the motion, the motion
        itself shows how it begins: the initial state of a segment that a leader does not follow says nothing of another
        law's. Also returned are the residuals there.

        Args:
            problem: what is fitted.
            state: as proposed.
            found: whether its initial states are to be found anyway.
        """
        if found:
            state = settled(problem, state)
        residuals = problem.residuals(state)
        for shown in (state.initial, self.structure.state(None).initial):
            lost = _lost(problem.segments, residuals)
            if not any(lost):
                break
            begun = state.initial.copy()
            begun[lost, :SHOWN] = shown[lost, :SHOWN]
            state, residuals = _nearer(problem, (state, residuals), settled(problem, replace(state, initial=begun)))
        return state, residuals

    def _settled_anew(self) -> bool:
        """Whether initial states found anew at these parameters lead on, where the old ones had lost a stretch.

        Where a small change decides, as where friction holds once more or once less, no step of a search leads on; what
        the stretch before it ends with does.
        """
        problem = self.descent.problem
        if self.near or self.data.memory != FREE:
            return False
        here = self.descent.state, self.descent.residuals
        state, residuals = _nearer(problem, here, settled(problem, self.descent.state))
        value = self.measure.value(residuals)
        if not value - self.value > DECISIVE:
            return False
        self.descent, self.value, self._promised = Descent(problem, state, residuals=residuals), value, None
        if not self._white:
            self._to_coloured()
        return True

    def measured_by(self, measure: Measure) -> None:
        """Go on in another measure."""
        if measure is not self.measure:
            self.measure = measure
            self._measure()

    def _measure(self) -> None:
        self.value, self._gained = self.measure.value(self.descent.residuals), 0.0
        if self._promised is not None:
            self._promised = self.measure.value(self.descent.expected)
        if not self._white:
            self._to_coloured()
        self._weigh()
        self.resting = self.resting and self._white

    @property
    def count(self) -> int:
        """Parameters it fits."""
        return len(self.structure.free)

    @property
    def ceiling(self) -> float:
        """What it promises: its proposer's hope until its own derivatives are known.

        Far from its maximum the linearised response sees to the next bend and no farther: a step may then bring what
        the one before it brought.
        """
        if self.resting:
            return self.value
        promised = self.hoped if self._promised is None else self._promised
        if self.steps == 0 and self._promised is None and self.value >= promised:
            return np.inf  # better than was hoped: nobody knows how far it goes
        return self.value + max(self.credit * max(promised - self.value, 0.0), self._gained)

    @property
    def hopes(self) -> float:
        """What it may reach where a promise is as much too small as it is ever taken to be too large."""
        if self._promised is None:
            return np.inf
        return self.value + max(self._promised - self.value, self._gained) / LEAST_CREDIT

    @property
    def fitted(self) -> Fitted:
        """Where it is."""
        state = self.descent.state
        residuals = self.descent.residuals
        value = likelihood(residuals, self.model, self.data)
        return Fitted(self.model, state.initial, residuals, value, self.structure.free, state.offsets)

    @property
    def locked(self) -> tuple[str, ...]:
        """Shapes of its laws that it keeps: the sharpness of a bend, say."""
        return tuple(name for name in shapes_of(self.model) if name not in self.structure.free)

    def unlock(self, steps: int) -> None:
        """Free the shapes of its laws as well, with some steps before its promise counts again."""
        self._freed([n for n in self.model.parameters() if n not in self.structure.free and n not in self.locked])
        self.patience, self.credit = self.steps + steps, 1.0
        self.resting = self.steps >= _MOST_STEPS

    def gains_anew(self, measure: Measure) -> bool:
        """Whether it came decisively farther since it last began anew, or never did."""
        return self._rested is None or self.value - measure.value(self._rested) > DECISIVE

    def begin_anew(self) -> None:
        """Go on from where it rests as if it had been put in here, with steps as bold as at first."""
        self._rested = self.descent.residuals
        self._freed([name for name in self.model.parameters() if name not in self.structure.free])
        self.resting = self.steps >= _MOST_STEPS

    def _freed(self, fixed: Sequence[str]) -> None:
        """The same place with other parameters free, simulated anew with the steps that suit it."""
        self.structure = Structure(self.model, self.data, fixed)
        self.descent = Descent(self.structure.problem, self.descent.state)
        self._promised = None
        self._measure()

    def look(self) -> None:
        """Make its own promise: what the linearised response would leave."""
        if self._promised is None and not self.resting:
            self._promised = self.measure.value(self.descent.expected)

    @property
    def looked(self) -> bool:
        """Whether it has made its own promise."""
        return self._promised is not None

    def step(self) -> None:
        """One step; at rest where none helps."""
        self.look()
        promised = max((self._promised or self.value) - self.value, 0.0)
        self.steps += 1
        before, state, residuals, self._gained = self.value, self.descent.state, self.descent.residuals, 0.0
        moved = self.descent.step(ONE_ERROR)
        if moved:
            model = with_values(self.structure.model, self.descent.state.values)
            value = self.measure.value(self.descent.residuals)
            if value < before and not self._white:  # the levels moved against each other
                self.descent.state, self.descent.residuals, self.resting = state, residuals, True
                return
            self._gained = max(value - before, 0.0)
            self.model, self.value, self._promised = model, value, None
            kept = self._gained / promised if self._gained < KEPT_PROMISE * promised else 1.0
            self.credit = max(kept, LEAST_CREDIT)
            self.resting = self.steps >= _MOST_STEPS
        self._weigh()
        if not moved and self._settled_anew():
            return
        if not self._white:
            self.resting = self.resting or not moved
            self._to_coloured()
        elif not moved:
            self.resting = self.measure.noise is None
            self._to_coloured()

    def _weigh(self) -> None:
        """Near the truth, weigh every frequency by the noise."""
        self.near = np.isfinite(self.value) and self.measure.near(self.descent.residuals, self.model, self.data)
        if self.near and self._white:
            self._to_coloured()

    def _to_coloured(self) -> None:
        """Weigh by the measure at the levels of here; as long as no noise is known, every frequency alike."""
        if self.measure.noise is not None:
            self._white, self._promised = False, None
            self.descent.weigh_by(self.measure.spectra(self.descent.residuals))


def _nearer(
    problem: OutputError, here: tuple[State, tuple[np.ndarray, ...]], other: State
) -> tuple[State, tuple[np.ndarray, ...]]:
    """Of two points with the same parameters the initial state of each segment that leaves less of it; what it leaves.

    Args:
        problem: what is fitted.
        here: one of them, with its residuals.
        other: the other.
    """
    state, residuals = here
    trial = problem.residuals(other)
    with np.errstate(over="ignore"):  # a motion that ran away
        better = [
            not np.sum(before**2) <= np.sum(after**2) and bool(np.all(np.isfinite(after)))
            for before, after in zip(residuals, trial, strict=True)
        ]
    kept = tuple(after if taken else before for taken, before, after in zip(better, residuals, trial, strict=True))
    return replace(state, initial=np.where(np.array(better)[:, None], other.initial, state.initial)), kept


def started(entry: Entry, data: Data, measure: Measure, *, beside_noise: bool = False) -> Start | None:
    """A start; None where the model cannot be simulated from there.

    One that has lost the motion of a segment, as a rig that friction holds where the recorded one moves, is brought
    back to it over predictions; no step of a simulation would. Beside one that leaves nothing but noise it is not
    (``beside_noise``): what loses the motion where that begins does not act like it.
    """
    start = _put(entry, data, measure)
    if start is None or beside_noise or data.memory != FREE or not any_lost(data.segments, start.descent.residuals):
        return start
    there = replace(entry, model=continued(entry.model, data, entry.fixed), initial=None)
    return max(start, _put(there, data, measure) or start, key=lambda one: one.value)


def continued(model: Oscillator, data: Data, fixed: Sequence[str]) -> Oscillator:
    """A model some steps further at each memory, from a cycle to the length of the recordings.

    Args:
        model: structure and start values.
        data: what it is fitted to, whatever its memory.
        fixed: names of parameters that keep their values.
    """
    for memory in memories(data.segments):
        with suppress(DashpotError, np.linalg.LinAlgError):  # nothing is predicted as long as that
            model = Structure(model, replace(data, memory=memory), fixed).fit(most=EARLY_STEPS).model
    return model


def any_lost(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> bool:
    """Whether a simulation has lost the motion of one of the segments, apart from noise.

    A rig that friction holds where the recorded one moves shows so: what it leaves depends on nothing, and no step
    leads from there.
    """
    return any(_lost(segments, residuals))


def _lost(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> list[bool]:
    """Of which segments it has."""
    return [
        not follows(float(np.sqrt(np.mean(residual**2))), segment.response, segment.noise)
        for segment, residual in zip(segments, residuals, strict=True)
    ]


def _put(entry: Entry, data: Data, measure: Measure) -> Start | None:
    try:
        start = Start(entry, data, measure)
    except (DashpotError, np.linalg.LinAlgError):
        return None
    return start if np.isfinite(start.value) else None


def _go_on(onwards: Callable[[], None], start: Start) -> None:
    """At rest where the model does not simulate from there on."""
    try:
        onwards()
    except (DashpotError, np.linalg.LinAlgError):
        start.resting = True


def race(
    starts: Sequence[Start],
    measure: Measure,
    standing: Fitted | None,
    points: int,
    progress: Callable[[str, float], None] = lambda _what, _part: None,
    over: Callable[[], bool] = lambda: False,
    needed: float = 0.0,
) -> Measure:
    """Let starts go on, the most promising first, until each is at rest or cannot reach the best of all.

    What is compared is the log-likelihood less half of log(points) for each parameter (Schwarz 1978), which the
    evidence of those that arrive then does better. The first that comes to the noise gives the measure by which all
    are compared from there on.

    Args:
        starts: on their way; they are moved.
        measure: in which they are compared.
        standing: the best structure outside, None where there is none.
        points: number of samples.
        progress: called with what is being done and the part that is.
        over: asked before each step whether no time is left.
        needed: by how much what adds to the standing structure must be better to be of any use.

    Returns:
        The measure in which they are compared at the end.
    """

    def paid(value: float, count: int) -> float:
        return value - 0.5 * count * math.log(points)

    whole = max(len(starts), 1)
    # that the noise can be reached is news once: where it was known, whoever starts was given its patience for that
    news_is_old = (
        standing is not None and bool(starts) and measure.near(standing.residuals, standing.model, starts[0].data)
    )
    while True:
        bar = -np.inf if standing is None else paid(measure.value(standing.residuals), len(standing.free))
        best = max([bar, *(paid(start.value, start.count) for start in starts)])

        def hopeless(start: Start, bar: float = bar, best: float = best) -> bool:
            reach = max(best - DECISIVE, bar + needed if start.adds else -np.inf)
            if start.steps < start.patience:
                return start.adds and paid(start.hopes, start.count) < reach
            return paid(start.ceiling, start.count) < reach

        at_noise = any(start.near for start in starts)
        for start in starts:
            if start.steps and start.locked and not at_noise and (start.resting or hopeless(start)):
                start.unlock(PATIENCE)  # before it leaves, or rests with more than noise
        running = [start for start in starts if not start.resting and not hopeless(start)]
        if not running or over():
            return measure
        # the patient ones catch up with each other first, so that none runs far ahead into a side valley
        front = max(running, key=lambda start: (start.steps < start.patience, paid(start.ceiling, start.count)))
        progress(" + ".join(front.laws) or "the given family", 1.0 - len(running) / whole)
        # its own promise may be far from its proposer's hope
        _go_on(front.step if front.looked else front.look, front)
        if measure.noise is None and (front.near or front.resting):
            measure = measure_by(front.fitted, front.data)
            if measure.noise is not None:
                for start in starts:
                    start.measured_by(measure)
        elif front.near and front.resting and paid(front.value, front.count) >= best and front.gains_anew(measure):
            # the first noise that was seen held some mismatch still; at that of here the valley may go on
            measure = measure_by(front.fitted, front.data)
            front.begin_anew()
            for start in starts:
                start.measured_by(measure)
        if front.near and not news_is_old:  # nothing can do much better than leave the noise
            news_is_old = True
            for other in starts:
                other.patience = 0

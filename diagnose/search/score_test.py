"""The whole library held against what a model leaves over: a score (Lagrange-multiplier) test with finite steps.

Each law is asked for its derivative at no strength, or put in at a probe where it has an onset. What of that change
the model's own parameters and the initial states cannot imitate is compared with the residual: the gain of
log-likelihood that it promises (Rao 1948). A promise is then kept or broken by one simulation of the whole step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from ...errors import DashpotError
from ...files.computed_once import computed_once
from ...identify.problem.adjoint import pushed
from ...identify.problem.data import Data, likelihood, noise_spectra
from ...identify.problem.equivalent import along_of
from ...identify.problem.limits import KEPT_PROMISE
from ...identify.problem.linearised import Linearised, Sums, off, orthonormal
from ...identify.problem.normal_equations import pseudo_inverse
from ...identify.problem.prediction import FREE
from ...identify.problem.search_point import SHOWN
from ...identify.problem.structure import Fitted, Structure, parameter_bounds
from ...identify.problem.unknowns import Unknowns
from ...identify.signals.noise_spectrum import estimate
from ...identify.signals.registry import budget, numerics
from ...identify.start.limits import HALF
from ...identify.start.measured_motion import probes
from ...model import Oscillator
from ...model.law import Law, LawParameter
from ...model.library import KNOWN
from ...model.terms import with_term, with_values
from ..limits import LEAST_STEP

_PARTS = numerics(
    4, "parts of a sample interval", why="at which a law is evaluated: the instant of a sign change counts"
)
_TRIED = budget(2, "probes of a law", why="those that promise most are simulated")


@dataclass(frozen=True, eq=False)
class Start:
    """A law at a place worth fitting from.

    Attributes:
        effect: name of the law.
        model: with the law in it, all values moved by the step that promised most.
        initial: (segments, states).
        offsets: what the sensors show at zero, in the order of the data's.
        promise: gain of log-likelihood that the linearised model expects.
        gain: what the simulation of that step gained.
    """

    effect: str
    model: Oscillator
    initial: np.ndarray
    offsets: np.ndarray
    promise: float
    gain: float


@dataclass(frozen=True, eq=False)
class _Step:
    """What the linearised model would do with a law.

    Attributes:
        values: of the law's parameters.
        shift: (k,) of the base parameters, and of what the sensors show at zero.
        promise: gain of log-likelihood.
        begun: (segments, states) shift of the initial states.
        initial: (segments, states) from which; None those of the fitted model.
        left: what of the residuals would be left, whitened.
    """

    law: Law
    values: dict[str, float]
    shift: np.ndarray
    promise: float
    begun: np.ndarray
    initial: np.ndarray | None = None
    left: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True, eq=False)
class _Linear:
    """One segment's motion, and how forces push it.

    Attributes:
        transitions: see ``Core.transitions``.
        motion: (m, 4) displacement, velocity, time and no force along it, in parts of a sample interval.
        dt: of these, s.
    """

    transitions: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
    motion: np.ndarray
    dt: float


class Screen:
    """Laws against the residual of one fitted model.

    Args:
        fitted: the model that leaves something over.
        data: what it was fitted to.
    """

    def __init__(self, fitted: Fitted, data: Data) -> None:
        self.fitted = fitted
        self.data = data
        self.noise = noise_spectra(fitted.residuals, fitted.model, data)
        structure = Structure(fitted.model, data, fixed=[n for n in fitted.model.parameters() if n not in fitted.free])
        self.places = structure.problem.free
        self.structure, self.state = structure, structure.state(fitted.initial, fitted.offsets)
        white = Linearised.in_time(structure.problem, self.state, fitted.residuals, self.noise)
        k = len(white.unknowns.shared)
        self.white = white
        #: Of each segment what its own unknowns can do, and the model without it.
        self.own = [orthonormal(rows[k:]) for rows in white.columns]
        self.base = Linearised(
            Unknowns(white.unknowns.shared, (), ((),) * len(white.columns)),
            tuple(off(basis, rows[:k]) for basis, rows in zip(self.own, white.columns, strict=True)),
            tuple(off(basis, left) for basis, left in zip(self.own, white.residuals, strict=True)),
        )

    def starts(
        self, laws: Sequence[Law] | None = None, cost: Callable[[Law], float] = lambda _: -np.inf
    ) -> list[Start]:
        """The best start of each law, the largest gain first.

        Args:
            laws: to ask; None the whole library.
            cost: what the gain of a law has to pay for. One that promises less than half of it is not simulated: the
                promise stands for its gain.
        """
        there = {term.law.effect for term in self.fitted.model.terms}
        library = KNOWN.values() if laws is None else laws
        wanted = [law for law in library if law.effect not in there and self.applies(law)]

        def best(law: Law) -> Start | None:
            steps = [step for probe in probes(law, self.data.scales) if (step := self._promised(law, probe))]
            steps = [self._concentrated(step) for step in sorted(steps, key=lambda step: -step.promise)[:_TRIED]]
            far = [step for step in steps if not step.promise < HALF * cost(law)]
            if steps and not far:
                return self._unsimulated(max(steps, key=lambda step: step.promise))
            tried = [start for step in far if (start := self._kept(step)) is not None]
            return max(tried, key=lambda start: start.gain, default=None)

        _ = self._linear  # made once, before both threads ask for it
        with ThreadPoolExecutor(max_workers=2) as pool:
            starts = [start for start in pool.map(best, wanted) if start is not None]
        return sorted(starts, key=lambda start: -start.gain)

    def _concentrated(self, step: _Step) -> _Step:
        """The same with the gain that it promises once the noise is what it leaves, not what was left before."""
        before = sum(estimate(residual).log_determinant() for residual in self.base.residuals)
        return replace(step, promise=0.5 * (before - sum(estimate(left).log_determinant() for left in step.left)))

    def applies(self, law: Law) -> bool:
        """Whether the recordings can show the law at all: an actuator's path needs a force."""
        return law.drive is None or any(segment.force is not None for segment in self.data.segments)

    def _promised(self, law: Law, probe: dict[str, float]) -> _Step | None:
        """The step that the linearised model expects most of, and what it expects."""
        strengths = [p for p in law.parameters if p.strength]
        try:
            if any(state.free for state in _inner(self.fitted.model, law, probe)):
                return self._phases(law, probe)
            directions = self._slopes(law, probe, strengths) if strengths else [self._change(law, probe)]
            return self._step(law, probe, [p.name for p in strengths], directions)
        except (DashpotError, FloatingPointError, np.linalg.LinAlgError):
            return None

    def _slopes(self, law: Law, values: dict[str, float], strengths: Sequence[LawParameter]) -> list[list[np.ndarray]]:
        """Derivatives of each segment's response by a law's strengths.

        Of a force they follow from the linearised motion (``pushed``). Where the response jumps they are taken as those
        by the base parameters are, under the same signs: at a jump what base parameters can do exactly would look like
        news.
        """
        if law.force is not None and self._linear:
            made = [self._pushed_by(law, values, linear) for linear in self._linear]
            return [[own[k] for own in made] for k in range(len(strengths))]
        return self._carried(law, values, strengths, self.fitted.initial)

    def _carried(
        self, law: Law, values: dict[str, float], strengths: Sequence[LawParameter], initial: np.ndarray
    ) -> list[list[np.ndarray]]:
        """The same from one run of each segment."""
        model = with_term(self.fitted.model, law.name, values)
        wanted = [f"{law.name}.{p.name}" for p in strengths]
        structure = Structure(model, self.data, [name for name in model.parameters() if name not in wanted])
        rows = structure.problem.derivatives(structure.state(initial, self.fitted.offsets), self.fitted.residuals)
        return [[own[k] for own in rows] for k in range(len(wanted))]

    def _pushed_by(self, law: Law, values: dict[str, float], linear: _Linear) -> np.ndarray:
        """(strengths, n) derivatives of a segment's response by the strengths of a force."""
        first = next(p.name for p in law.parameters if p.strength)
        present = values | {first: 1.0}  # a contact is there: its derivatives are those of one that pushes
        fine = along_of(law)(present, linear.motion, linear.dt)
        mass = 1.0 if self.fitted.model.mass is None else self.fitted.model.mass.value
        between = (0.5 * (fine[:, :-1] + fine[:, 1:])).reshape(len(fine), -1, _PARTS).mean(axis=2)
        return pushed(linear.transitions, -mass * between, -mass * fine[:, ::_PARTS])

    @computed_once
    def _linear(self) -> list[_Linear]:
        """The fitted motion of each segment and how it is pushed; none where it is predicted, or jumps."""
        jumps = any(segment.quantity == "acceleration" for segment in self.data.segments)
        if jumps or self.data.memory != FREE or any(term.law.drive for term in self.fitted.model.terms):
            return []
        problem = self.structure.problem
        made = problem.map(lambda i: self._linearised(i), range(len(problem.segments)))
        return made if all(np.all(np.isfinite(part)) for linear in made for part in linear.transitions) else []

    def _linearised(self, i: int) -> _Linear:
        """Of one segment."""
        from scipy.interpolate import CubicHermiteSpline

        problem, segment = self.structure.problem, self.structure.problem.segments[i]
        x, v = problem.states(i, self.state)[:, :SHOWN].T
        place = np.arange((x.size - 1) * _PARTS + 1) / _PARTS
        motion = CubicHermiteSpline(np.arange(x.size), x, v * segment.dt)
        dt = segment.dt / _PARTS
        columns = [motion(place), motion(place, 1) / segment.dt, segment.time + segment.dt * place, 0.0 * place]
        return _Linear(problem.transitions(i, self.state), np.column_stack(columns), dt)

    def _change(self, law: Law, values: dict[str, float]) -> list[np.ndarray]:
        """Change of each segment's response when the law is put in."""
        model = with_term(self.fitted.model, law.name, values)
        structure = Structure(model, self.data)
        residuals = structure.problem.residuals(structure.state(self.fitted.initial, self.fitted.offsets))
        return [old - new for old, new in zip(self.fitted.residuals, residuals, strict=True)]

    def _weigh(self, change: Sequence[np.ndarray]) -> list[np.ndarray]:
        """A change (n,) of each segment, whitened."""
        return [spectrum.whiten(difference) for spectrum, difference in zip(self.noise, change, strict=True)]

    def _beyond_own(self, whitened: Sequence[np.ndarray]) -> list[np.ndarray]:
        """What of a whitened change (n,) of each segment its own unknowns cannot imitate."""
        return [off(basis, difference) for basis, difference in zip(self.own, whitened, strict=True)]

    def _begun(self, left: Sequence[np.ndarray]) -> np.ndarray:
        """(segments, states) by which initial states take up what they can of whitened residuals (n,)."""
        own = self.white.initial_rows
        each = zip(self.white.columns, self.white.sums, left, strict=True)
        return np.array([pseudo_inverse(sums.normal[own, own]) @ (rows[own] @ r) for rows, sums, r in each])

    def _step(
        self, law: Law, values: dict[str, float], names: list[str], directions: list[list[np.ndarray]]
    ) -> _Step | None:
        """The least-squares step in the base parameters and the strengths.

        A law at a probe is either there or not: of its change the base parameters take up what they can. Where it has
        but one parameter the change may also be scaled, as if it were a strength.
        """
        whole = [self._weigh(direction) for direction in directions]
        if not all(np.all(np.isfinite(change)) for direction in whole for change in direction):
            return None
        columns = [np.stack(both) for both in zip(*(self._beyond_own(direction) for direction in whole), strict=True)]
        beside = self.base.beside(dict(enumerate(columns)))
        asked = beside.without(self.base.shared_rows)
        strength = asked.step()
        alone, follows = self.base.shared.step(), beside.reduction(self.base.shared_rows)[:, self.base.shared_rows]

        def step(numbers: dict[str, float], size: np.ndarray, promise: float) -> _Step:
            """The base parameters alone might gain something too: that is no merit of the law."""
            shift = alone + size @ follows
            each = zip(self.base.residuals, self.base.columns, columns, strict=True)
            left = tuple(residual - shift @ rows - size @ more for residual, rows, more in each)
            each = zip(self.white.residuals, self.white.columns, *whole, strict=True)
            begun = self._begun([r - shift @ rows[: shift.size] - size @ np.stack(more) for r, rows, *more in each])
            return _Step(law, numbers, shift, promise, begun, left=left)

        if names:
            moved = dict(zip(names, (float(s) for s in strength), strict=True))
            return step(values | moved, strength, asked.gain())
        part = float(strength[0])
        if len(law.parameters) == 1 and LEAST_STEP < part < 1 / LEAST_STEP:
            (parameter,) = law.parameters
            moved = {parameter.name: part * values[parameter.name]}
            return step(moved, strength, asked.gain())
        return step(values, np.ones(1), float(asked.gradient[0]) - 0.5 * float(asked.normal[0, 0]))

    def _kept(self, step: _Step) -> Start | None:
        """The better of the whole step and of a shorter one, simulated."""
        here = np.array(list(self.fitted.model.values().values()))
        best: Start | None = None
        for part in (1.0, 0.3, 0.0):
            numbers = dict(step.values)
            for p in step.law.parameters:
                if p.strength:
                    numbers[p.name] *= part or LEAST_STEP
                numbers[p.name] = float(np.clip(numbers[p.name], p.lower, p.upper))
            moved, k = here.copy(), len(self.places)
            moved[list(self.places)] += part * step.shift[:k]
            moved = np.clip(moved, *parameter_bounds(self.fitted.model, self.data.scales))
            begun = np.array(self.fitted.initial if step.initial is None else step.initial)
            begun[:, : step.begun.shape[1]] += part * step.begun
            offsets = self.fitted.offsets + part * step.shift[k:]
            start = self._simulated(step.law, numbers, moved, step.promise, begun, offsets)
            if start is not None and (best is None or start.gain > best.gain):
                best = start
            if best is not None and best.gain > KEPT_PROMISE * step.promise:
                break
        return best

    def _unsimulated(self, step: _Step) -> Start:
        """A law where its step puts it, with the promise for its gain."""
        model = with_term(self.fitted.model, step.law.name, step.values)
        return Start(step.law.name, model, self.fitted.initial, self.fitted.offsets, step.promise, step.promise)

    def _simulated(
        self,
        law: Law,
        numbers: dict[str, float],
        moved: np.ndarray,
        promise: float,
        initial: np.ndarray,
        offsets: np.ndarray,
    ) -> Start | None:
        model = with_term(with_values(self.fitted.model, moved), law.name, numbers)
        structure = Structure(model, self.data)
        state = structure.state(initial, offsets)
        residuals = structure.problem.residuals(state)
        value = likelihood(residuals, model, self.data)
        if not np.isfinite(value):
            return None
        return Start(law.name, model, state.initial, state.offsets, promise, value - self.fitted.likelihood)

    def _phases(self, law: Law, values: dict[str, float]) -> _Step | None:
        """A periodic force with a phase of its own in each segment: sine and cosine in each, by themselves."""
        (strength,) = [p for p in law.parameters if p.strength]
        values = values | {strength.name: 0.0}
        states = len(self.fitted.initial[0])
        changes = []
        for phase in (0.0, -0.5 * np.pi):
            initial = np.hstack([self.fitted.initial, np.full((len(self.data.segments), 1), phase)])
            (slopes,) = self._carried(law, values, [strength], initial)
            changes.append(self._weigh(slopes))
        promise, parts, left = 0.0, [], []
        beyond = [self._beyond_own(change) for change in changes]
        for i, residual in enumerate(self.base.residuals):
            columns = np.stack([beyond[0][i], beyond[1][i]])
            sums = Sums.of(columns, residual)
            part = sums.step()
            promise += sums.gain()
            parts.append((part, sums.normal))
            left.append(residual - part @ columns)
        weight = sum(float(np.trace(normal)) for _, normal in parts)
        if not weight > 0:
            return None
        amplitude = np.sqrt(sum(float(part @ part) * float(np.trace(normal)) for part, normal in parts) / weight)
        # cos(phase + w t) = cos(phase) cos(w t) - sin(phase) sin(w t); a phase of -pi/2 made sin(w t)
        phases = np.array([[np.arctan2(-part[1], part[0])] for part, _ in parts])
        initial = np.hstack([self.fitted.initial[:, :states], phases])
        numbers = values | {strength.name: float(amplitude)}
        each = zip(self.white.residuals, *changes, parts, strict=True)
        begun = self._begun([r - part @ np.stack(both) for r, *both, (part, _) in each])
        return _Step(law, numbers, np.zeros(len(self.base.unknowns.shared)), promise, begun, initial, tuple(left))


def _inner(model: Oscillator, law: Law, values: dict[str, float]) -> tuple:
    from ...model.equations import equations

    before = len(equations(model).inner)
    return equations(with_term(model, law.name, values)).inner[before:]

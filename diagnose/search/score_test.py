"""The whole library held against what a model leaves over: a score (Lagrange-multiplier) test with finite steps.

Each law is asked for its derivative at no strength, or put in at a probe where it has an onset. What of that change
the model's own parameters and the initial states cannot imitate is compared with the residual: the gain of
log-likelihood that it promises (Rao 1948). A promise is then kept or broken by one simulation of the whole step.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from ...errors import DashpotError
from ...identify.problem.data import Data, likelihood, noise_spectra
from ...identify.problem.limits import KEPT_PROMISE
from ...identify.problem.linearised import Linearised, Sums, off, orthonormal
from ...identify.problem.settle import settled
from ...identify.problem.structure import Fitted, Structure, parameter_bounds
from ...identify.problem.unknowns import Unknowns
from ...identify.signals.noise_spectrum import estimate
from ...identify.signals.registry import budget, numerics
from ...identify.start.measured_motion import probes
from ...model import Oscillator
from ...model.law import Law, LawParameter
from ...model.library import KNOWN
from ...model.terms import with_term, with_values
from ..limits import LEAST_STEP

_FEELER = numerics(
    1e-5,
    "natural sizes",
    why="the strength at which a plain difference is taken: small beside the least friction that matters",
)
_TRIED = budget(2, "probes of a law", why="those that promise most are simulated")


@dataclass(frozen=True, eq=False)
class Start:
    """A law at a place worth fitting from.

    Attributes:
        effect: name of the law.
        model: with the law in it, all values moved by the step that promised most.
        initial: (segments, states).
        promise: gain of log-likelihood that the linearised model expects.
        gain: what the simulation of that step gained.
    """

    effect: str
    model: Oscillator
    initial: np.ndarray
    promise: float
    gain: float


@dataclass(frozen=True, eq=False)
class _Step:
    """What the linearised model would do with a law: its values, the base parameters' shift, the gain it promises."""

    law: Law
    values: dict[str, float]
    shift: np.ndarray
    promise: float
    initial: np.ndarray | None = None
    left: tuple[np.ndarray, ...] = ()


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
        white = Linearised.in_time(structure.problem, structure.state(fitted.initial), fitted.residuals, self.noise)
        k = len(self.places)
        #: Of each segment what its own unknowns can do, and the model without it.
        self.own = [orthonormal(rows[k:]) for rows in white.columns]
        self.base = Linearised(
            Unknowns(white.unknowns.parameters, (), ((),) * len(white.columns)),
            tuple(off(basis, rows[:k]) for basis, rows in zip(self.own, white.columns, strict=True)),
            tuple(off(basis, left) for basis, left in zip(self.own, white.residuals, strict=True)),
        )

    def starts(self, laws: Sequence[Law] | None = None) -> list[Start]:
        """The best start of each law, the largest gain first; of the whole library where no laws are given (None)."""
        there = {term.law.effect for term in self.fitted.model.terms}
        library = KNOWN.values() if laws is None else laws
        wanted = [law for law in library if law.effect not in there and self.applies(law)]

        def best(law: Law) -> Start | None:
            steps = [step for probe in probes(law, self.data.scales) if (step := self._promised(law, probe))]
            steps.sort(key=lambda step: -step.promise)
            tried = [start for step in steps[:_TRIED] if (start := self._kept(self._concentrated(step))) is not None]
            return max(tried, key=lambda start: start.gain, default=None)

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
            directions = (
                self._slopes(law, probe, strengths) if strengths else [self._change(law, probe, self.fitted.initial)]
            )
            return self._step(law, probe, [p.name for p in strengths], directions)
        except (DashpotError, FloatingPointError, np.linalg.LinAlgError):
            return None

    def _slopes(
        self, law: Law, values: dict[str, float], strengths: Sequence[LawParameter], initial: np.ndarray | None = None
    ) -> list[list[np.ndarray]]:
        """Derivatives of each segment's response by a law's strengths.

        Where the response jumps they are taken as those by the base parameters are, under the same signs: between two
        plain simulations a jump moves by a sample, and what base parameters can do exactly would look like news.
        """
        begun = self.fitted.initial if initial is None else initial
        if not any(segment.quantity == "acceleration" for segment in self.data.segments):
            sizes = {p.name: p.natural(self.data.scales) * _FEELER for p in strengths}
            changes = [(self._change(law, values | {name: size}, begun), size) for name, size in sizes.items()]
            return [[d / size for d in change] for change, size in changes]
        model = with_term(self.fitted.model, law.name, values)
        wanted = [f"{law.name}.{p.name}" for p in strengths]
        structure = Structure(model, self.data, [name for name in model.parameters() if name not in wanted])
        state = structure.state(begun)
        problem, residuals = structure.problem, self.fitted.residuals
        rows = problem.derivatives(state, residuals)
        return [[own[k] for own in rows] for k in range(len(wanted))]

    def _change(self, law: Law, values: dict[str, float], initial: np.ndarray) -> list[np.ndarray]:
        """Change of each segment's response when the law is put in."""
        model = with_term(self.fitted.model, law.name, values)
        structure = Structure(model, self.data)
        state = structure.state(initial)
        residuals = structure.problem.residuals(state)
        return [old - new for old, new in zip(self.fitted.residuals, residuals, strict=True)]

    def _weigh(self, change: list[np.ndarray]) -> list[np.ndarray]:
        """What of a change (n,) of each segment its own unknowns cannot imitate, whitened."""
        whitened = [spectrum.whiten(difference) for spectrum, difference in zip(self.noise, change, strict=True)]
        return [off(basis, difference) for basis, difference in zip(self.own, whitened, strict=True)]

    def _step(
        self, law: Law, values: dict[str, float], names: list[str], directions: list[list[np.ndarray]]
    ) -> _Step | None:
        """The least-squares step in the base parameters and the strengths.

        A law at a probe is either there or not: of its change the base parameters take up what they can. Where it has
        but one parameter the change may also be scaled, as if it were a strength.
        """
        weighed = [self._weigh(direction) for direction in directions]
        if not all(np.all(np.isfinite(change)) for direction in weighed for change in direction):
            return None
        columns = [np.stack(both) for both in zip(*weighed, strict=True)]
        beside = self.base.beside(dict(enumerate(columns)))
        asked = beside.without(self.base.shared_rows)
        strength = asked.step()
        alone, follows = self.base.shared.step(), beside.reduction(self.base.shared_rows)[:, self.base.shared_rows]

        def step(numbers: dict[str, float], size: np.ndarray, promise: float) -> _Step:
            """The base parameters alone might gain something too: that is no merit of the law."""
            shift = alone + size @ follows
            each = zip(self.base.residuals, self.base.columns, columns, strict=True)
            left = tuple(residual - shift @ rows - size @ more for residual, rows, more in each)
            return _Step(law, numbers, shift, promise, left=left)

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
            moved = here.copy()
            moved[list(self.places)] += part * step.shift
            moved = np.clip(moved, *parameter_bounds(self.fitted.model, self.data.scales))
            start = self._simulated(step.law, numbers, moved, step.promise, step.initial)
            if start is not None and (best is None or start.gain > best.gain):
                best = start
            if best is not None and best.gain > KEPT_PROMISE * step.promise:
                break
        return best

    def _simulated(
        self,
        law: Law,
        numbers: dict[str, float],
        moved: np.ndarray,
        promise: float,
        initial: np.ndarray | None = None,
    ) -> Start | None:
        model = with_term(with_values(self.fitted.model, moved), law.name, numbers)
        structure = Structure(model, self.data)
        state = structure.state(self.fitted.initial if initial is None else initial)
        state = settled(structure.problem, state)
        residuals = structure.problem.residuals(state)
        value = likelihood(residuals, model, self.data)
        if not np.isfinite(value):
            return None
        return Start(law.name, model, state.initial, promise, value - self.fitted.likelihood)

    def _phases(self, law: Law, values: dict[str, float]) -> _Step | None:
        """A periodic force with a phase of its own in each segment: sine and cosine in each, by themselves."""
        (strength,) = [p for p in law.parameters if p.strength]
        values = values | {strength.name: 0.0}
        states = len(self.fitted.initial[0])
        changes = []
        for phase in (0.0, -0.5 * np.pi):
            initial = np.hstack([self.fitted.initial, np.full((len(self.data.segments), 1), phase)])
            (slopes,) = self._slopes(law, values, [strength], initial)
            changes.append(self._weigh(slopes))
        promise, parts, left = 0.0, [], []
        for i, residual in enumerate(self.base.residuals):
            columns = np.stack([changes[0][i], changes[1][i]])
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
        return _Step(law, numbers, np.zeros(len(self.places)), promise, initial, tuple(left))


def _inner(model: Oscillator, law: Law, values: dict[str, float]) -> tuple:
    from ...model.equations import equations

    before = len(equations(model).inner)
    return equations(with_term(model, law.name, values)).inner[before:]

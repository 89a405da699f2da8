"""The whole library held against what a model leaves over: a score (Lagrange-multiplier) test with finite steps.

Each law is put in with a small strength, or at a probe where it has an onset, and simulated once. What of that change
the model's own parameters and the initial states cannot imitate is compared with the residual: the gain of
log-likelihood that it promises (Rao 1948). A promise is then kept or broken by one simulation of the whole step.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from ..errors import DashpotError
from ..identify.output_error import State, pseudo_inverse
from ..model import Oscillator
from ..model.law import Law, Scales
from ..model.laws import LIBRARY
from .fitting import Data, Fitted, Structure, likelihood, noise_spectra, with_term, with_values

#: Strength at which the derivative of a law is taken, in natural sizes: small beside the least friction that matters.
_FEELER = 1e-5


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
class _Weighed:
    """Residuals and derivatives of the base model, whitened, the segments' own states projected out."""

    residuals: list[np.ndarray]
    jacobians: list[np.ndarray]
    own: list[np.ndarray]
    normal: np.ndarray


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
        state = structure.state(fitted.initial)
        derivatives = structure.problem.derivatives(state, fitted.residuals)
        k = len(self.places)
        weighed = _Weighed([], [], [], np.zeros((k, k)))
        normal = np.zeros((k, k))
        for spectrum, residual, rows in zip(self.noise, fitted.residuals, derivatives, strict=True):
            white = spectrum.whiten(np.vstack([rows, residual]))
            own = white[k:-1]
            basis = _orthonormal(own)
            jacobian = _off(basis, white[:k])
            weighed.residuals.append(_off(basis, white[-1:])[0])
            weighed.jacobians.append(jacobian)
            weighed.own.append(basis)
            normal += jacobian @ jacobian.T
        self.weighed = weighed
        self.inverse = pseudo_inverse(normal)

    def starts(
        self, laws: Sequence[Law] | None = None, progress: Callable[[], None] = lambda: None
    ) -> list[Start]:
        """The best start of each law, the largest gain first; laws that do not simulate are left out."""
        there = {term.law.effect for term in self.fitted.model.terms}
        wanted = [law for law in (laws or LIBRARY.values()) if law.effect not in there and self.applies(law)]

        def best(law: Law) -> Start | None:
            found = [start for probe in probes(law, self.data.scales) if (start := self._try(law, probe))]
            progress()
            return max(found, key=lambda start: start.gain, default=None)

        with ThreadPoolExecutor(max_workers=2) as pool:
            found = [start for start in pool.map(best, wanted) if start is not None]
        return sorted(found, key=lambda start: -start.gain)

    def applies(self, law: Law) -> bool:
        """Whether the recordings can show the law at all: an actuator's path needs a force."""
        return law.drive is None or any(segment.force is not None for segment in self.data.segments)

    def _try(self, law: Law, probe: dict[str, float]) -> Start | None:
        scales = self.data.scales
        strengths = [p for p in law.parameters if p.strength]
        base = dict(probe)
        try:
            if any(state.free for state in _inner(self.fitted.model, law, base)):
                return self._try_phases(law, base)
            directions = []
            for p in strengths:
                size = p.natural(scales) * _FEELER
                directions.append([d / size for d in self._change(law, base | {p.name: size})])
            if not strengths:
                directions.append(self._change(law, base))
            return self._step(law, base, [p.name for p in strengths], directions)
        except (DashpotError, FloatingPointError, np.linalg.LinAlgError):
            return None

    def _change(self, law: Law, values: dict[str, float], initial: np.ndarray | None = None) -> list[np.ndarray]:
        """Change of each segment's response when the law is put in."""
        model = with_term(self.fitted.model, law.name, values)
        structure = Structure(model, self.data)
        state = structure.state(self.fitted.initial if initial is None else initial)
        residuals = structure.problem.residuals(state)
        return [old - new for old, new in zip(self.fitted.residuals, residuals, strict=True)]

    def _weigh(self, change: list[np.ndarray]) -> list[np.ndarray]:
        found = []
        for spectrum, basis, one in zip(self.noise, self.weighed.own, change, strict=True):
            found.append(_off(basis, spectrum.whiten(one[None]))[0])
        return found

    def _step(
        self, law: Law, values: dict[str, float], names: list[str], directions: list[list[np.ndarray]]
    ) -> Start | None:
        """The least-squares step in the base parameters and the strengths, and what it really gains."""
        weighed = [self._weigh(direction) for direction in directions]
        if not all(np.all(np.isfinite(one)) for direction in weighed for one in direction):
            return None
        k, q = len(self.places), len(names)
        residuals = self.weighed.residuals
        if not names:  # at a probe: the change is made, the base parameters answer
            residuals = [r - d for r, d in zip(residuals, weighed[0], strict=True)]
        gradient = sum(j @ r for j, r in zip(self.weighed.jacobians, residuals, strict=True))
        before = sum(float(r @ r) for r in self.weighed.residuals)
        if not names:
            shift, strength = self.inverse @ gradient, np.zeros(0)
            after = sum(float(r @ r) for r in residuals) - float(gradient @ shift)
        else:
            columns = [np.stack([direction[i] for direction in weighed]) for i in range(len(residuals))]
            cross = sum(j @ c.T for j, c in zip(self.weighed.jacobians, columns, strict=True))
            own = sum(c @ c.T for c in columns)
            right = sum(c @ r for c, r in zip(columns, residuals, strict=True))
            schur = own - cross.T @ self.inverse @ cross
            strength = pseudo_inverse(schur) @ (right - cross.T @ self.inverse @ gradient)
            shift = self.inverse @ (gradient - cross @ strength)
            after = before - float(gradient @ shift) - float(right @ strength)
        promise = 0.5 * (before - after)
        best: Start | None = None
        for part in (1.0, 0.3):
            numbers = dict(values) | {name: part * float(s) for name, s in zip(names, strength[:q], strict=True)}
            numbers = {p.name: float(np.clip(numbers[p.name], p.lower, p.upper)) for p in law.parameters}
            moved = np.array(list(self.fitted.model.values().values()))
            moved[list(self.places)] += (part if names else 1.0) * shift[:k]
            start = self._simulated(law, numbers, moved, promise)
            if start is not None and (best is None or start.gain > best.gain):
                best = start
            if not names or (start is not None and start.gain > 0.3 * promise):
                break
        if not names:  # the base values as they are may be the better place
            start = self._simulated(law, values, np.array(list(self.fitted.model.values().values())), promise)
            if start is not None and (best is None or start.gain > best.gain):
                best = start
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
        state = structure.problem.settle(State(state.values, state.initial))
        residuals = structure.problem.residuals(state)
        value = likelihood(residuals, model, self.data)
        if not np.isfinite(value):
            return None
        return Start(law.name, model, state.initial, promise, value - self.fitted.likelihood)

    def _try_phases(self, law: Law, values: dict[str, float]) -> Start | None:
        """A periodic force with a phase of its own in each segment: sine and cosine in each, by themselves."""
        (strength,) = [p for p in law.parameters if p.strength]
        size = strength.natural(self.data.scales) * _FEELER
        values = values | {strength.name: size}
        states = len(self.fitted.initial[0])
        changes = []
        for phase in (0.0, -0.5 * np.pi):
            initial = np.hstack([self.fitted.initial, np.full((len(self.data.segments), 1), phase)])
            changes.append(self._weigh([d / size for d in self._change(law, values, initial)]))
        promise, parts = 0.0, []
        for i, residual in enumerate(self.weighed.residuals):
            columns = np.stack([changes[0][i], changes[1][i]])
            normal, right = columns @ columns.T, columns @ residual
            part = pseudo_inverse(normal) @ right
            promise += 0.5 * float(right @ part)
            parts.append((part, normal))
        weight = sum(float(np.trace(normal)) for _, normal in parts)
        amplitude = np.sqrt(sum(float(part @ part) * float(np.trace(normal)) for part, normal in parts) / weight)
        # cos(phase0 + w t) = cos phase0 cos w t - sin phase0 sin w t; phase -pi/2 gives sin w t
        phases = np.array([[np.arctan2(-part[1], part[0])] for part, _ in parts])
        initial = np.hstack([self.fitted.initial[:, :states], phases])
        numbers = values | {strength.name: float(amplitude)}
        return self._simulated(law, numbers, np.array(list(self.fitted.model.values().values())), promise, initial)


def probes(law: Law, scales: Scales) -> list[dict[str, float]]:
    """Where to look for a law: every combination of its parameters' probes, strengths at zero."""
    axes = []
    for p in law.parameters:
        if p.strength:
            axes.append([(p.name, 0.0)])
        elif p.probes == "lines":
            axes.append([(p.name, line) for line in scales.lines])
        else:
            axes.append([(p.name, float(probe) * p.natural(scales)) for probe in p.probes])
    return [dict(combination) for combination in itertools.product(*axes)]


def _inner(model: Oscillator, law: Law, values: dict[str, float]) -> tuple:
    from ..model.equations import equations

    before = len(equations(model).inner)
    return equations(with_term(model, law.name, values)).inner[before:]


def _orthonormal(rows: np.ndarray) -> np.ndarray:
    """Orthonormal basis (m, n) of the rows' span; rows of zeros add nothing."""
    size = np.linalg.norm(rows, axis=1)
    rows = rows[size > 0] / size[size > 0, None]
    if not rows.size:
        return rows
    _, values, basis = np.linalg.svd(rows, full_matrices=False)
    return basis[values > 1e-8 * values[0]]


def _off(basis: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """(m, n) rows less what lies in the basis."""
    return rows - (rows @ basis.T) @ basis if basis.size else rows

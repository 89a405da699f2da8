"""Fits of one model structure after another to the same recordings.

All of them simulate the same segments and are judged alike, so that what one law explains and another does not can
be stated in units of log-likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...model.equations import equations
from ...model.law import Law, Scales
from ...model.terms import with_term, with_values, without_term
from ...model.units import factors
from ...recording.recording import WHOLE
from ...simulate.core import Core, core_of, internal_step
from ..motion.first_motion import starts_at_rest
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.registry import budget, numerics
from .data import Data, likelihood
from .descent import search
from .initial_motion import initial_states
from .limits import FENCE, SLACK
from .offset import Offset
from .output_error import OutputError, State
from .segments import Segment
from .settle import settled
from .state_from_previous_segment import goes_on

_SMALL = numerics(1e-2, "part of its natural size", why="the first step of a law's parameter")
_COARSER = numerics(
    3.75,
    "times the delivered step",
    why="for what only compares laws: twenty a period, in each of which the solver errs by 3e-7 of the amplitude",
)
_FINEST = budget(40.0, "steps a sample", why="a motion that takes more is nothing that the recordings could show")
_MASS_SPAN = numerics(1e3, "times its start", why="to which a mass may come, or to as small a part of it")


@dataclass(frozen=True, eq=False)
class Fitted:
    """A model fitted to data.

    Attributes:
        model: structure and values.
        initial: (segments, states) initial states.
        residuals: measured minus simulated, one (n,) array a segment.
        likelihood: log-likelihood, concentrated over a noise spectrum of each segment.
        free: names of the parameters that were fitted.
        offsets: what the sensors show at zero, in the order of the data's.
    """

    model: Oscillator
    initial: np.ndarray
    residuals: tuple[np.ndarray, ...]
    likelihood: float
    free: tuple[str, ...]
    offsets: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @property
    def finite(self) -> bool:
        """Whether the model simulates."""
        return all(bool(np.all(np.isfinite(residual))) for residual in self.residuals)


def renamed(fitted: Fitted, effect: str, law: Law) -> Fitted:
    """The same fit with one effect under the name of a law of the same equation, or of one of which either is a case.

    Their parameters correspond in order; those that only one of the two has are zero.
    """
    (old,) = [term for term in fitted.model.terms if term.effect == effect]
    names = [p.name for p in law.parameters]
    given = [parameter.value for parameter in old.parameters.values()]
    values = dict.fromkeys(names, 0.0) | dict(zip(names, given, strict=False))
    model = with_term(without_term(fitted.model, effect), law.name, values)
    free = dict(zip((f"{effect}.{n}" for n in old.parameters), (f"{law.name}.{n}" for n in names), strict=False))
    kept = {free.get(name, name) for name in fitted.free}
    return replace(fitted, model=model, free=tuple(name for name in model.parameters() if name in kept))


def typical_sizes(names: Sequence[str], values: np.ndarray, amplitude: float, pace: float) -> np.ndarray:
    """Sizes at which a parameter matters: one hundredth of the force of inertia at full amplitude."""
    length, rate = amplitude, amplitude * pace
    acceleration = 0.01 * pace**2 * amplitude
    sizes = {"mass": abs(values[0]), "omega0": 0.01 * pace, "cubic": acceleration / length**3}
    sizes |= {"preload": acceleration, "dry": acceleration, "viscous": acceleration / rate}
    typical = []
    for i, name in enumerate(names):
        typical.append(sizes.get(name, max(abs(values[i]), 1e-12)))
    return np.array(typical)


def parameter_sizes(model: Oscillator, scales: Scales) -> np.ndarray:
    """(parameters,) typical sizes for finite differences."""
    names = tuple(model.parameters())
    values = np.array(list(model.values().values()))
    sizes = typical_sizes(names, values, scales.length, scales.omega)
    for term in model.terms:
        for p in term.law.parameters:
            sizes[names.index(f"{term.effect}.{p.name}")] = _SMALL * p.natural(scales)
    return sizes


def parameter_bounds(model: Oscillator, scales: Scales) -> np.ndarray:
    """(2, parameters) lowest and highest values: a law's own; for its onsets and speeds ten times beyond its probes.

    What is looked for at zero, the middle between two stops, lies within the motion: beyond it the law is another one.
    On the side on which a search begins beyond that, the law's own bound holds: from a place from which each step threw
    it back it would lead nowhere.
    """
    mass = 1.0 if model.mass is None else model.mass.value
    known = {"mass": (mass / _MASS_SPAN, mass * _MASS_SPAN), "omega0": (SLACK / scales.duration, np.inf)}
    for term in model.terms:
        for p in term.law.parameters:
            low, high, here = p.lower, p.upper, term.parameters[p.name].value
            if not p.strength and not p.shape and p.probes and p.probes != "lines":
                size = p.natural(scales)
                reach = [float(probe) * size for probe in p.probes]
                inner = min(abs(r) for r in reach) / FENCE
                low = max(low, inner if min(reach) > 0 else min(reach) * FENCE)
                high = min(high, max(reach) * FENCE)
            elif p.probes == (0.0,):
                low, high = max(low, -p.natural(scales)), min(high, p.natural(scales))
            known[f"{term.effect}.{p.name}"] = (low if here >= low else p.lower, high if here <= high else p.upper)
    return np.array([known.get(name, (-np.inf, np.inf)) for name in model.parameters()]).T


def shapes_of(model: Oscillator) -> tuple[str, ...]:
    """Names of the parameters that are kept until the data ask for them."""
    return tuple(f"{t.effect}.{p.name}" for t in model.terms for p in t.law.parameters if p.shape)


class Structure:
    """One model structure over the segments of some data: simulation, derivatives, search.

    Args:
        model: structure and present values.
        data: what it is fitted to.
        fixed: names of parameters to keep.
        offsets: of sensors, to be found with the parameters; those of the data where None.
    """

    def __init__(
        self, model: Oscillator, data: Data, fixed: Sequence[str] = (), offsets: Sequence[Offset] | None = None
    ) -> None:
        self.model = model
        self.data = data
        names = tuple(model.parameters())
        # nor does a base that moves one mass: what drives that is per unit mass
        driven = any(
            segment.force is not None and data.recordings[segment.recording].base != WHOLE for segment in data.segments
        )
        laws = [(f"{term.effect}.{p.name}", p) for term in model.terms for p in term.law.parameters]
        kept = {*fixed, *(name for name, p in laws if p.scale)}
        if not driven:  # free motion says nothing of the mass, nor of what else is measured by the force
            kept |= {"mass", *(name for name, p in laws if "Q" in factors(p.unit))}
        self.free = tuple(name for name in names if name not in kept)
        core = core_of(model, carried=True)
        scales = data.scales
        inner = [_SMALL * scales.of(state.unit) for state in core.equations.inner]
        length = scales.length
        self.values = np.array(list(model.values().values()))
        self.segments = self._at_rest(core)
        steps = self._internal_steps(length)
        self.problem = OutputError(
            core,
            self.segments,
            tuple(names.index(name) for name in self.free),
            parameter_sizes(model, scales),
            np.array([_SMALL * length, _SMALL * length * scales.omega, *inner]),
            steps[0],
            self._bounds(names, scales),
            offsets=data.offsets if offsets is None else offsets,
            memory=data.memory,
            coarse_step=steps[1],
        )

    def _bounds(self, names: Sequence[str], scales: Scales) -> np.ndarray:
        """(2, parameters) of those that are looked for; one that keeps its value keeps it wherever it lies."""
        bounds = parameter_bounds(self.model, scales)
        bounds[:, [name not in self.free for name in names]] = [[-np.inf], [np.inf]]
        return bounds

    def _internal_steps(self, length: float) -> tuple[float, float]:
        """Longest internal step of a simulation, and of one that only leads to where a fit begins; s."""
        step = internal_step(self.model, self.model.values(), length)
        coarse = max(step * _COARSER, min(s.dt for s in self.data.segments) / _FINEST)
        return (coarse if self.data.coarse else step), coarse

    def _at_rest(self, core: Core) -> tuple[Segment, ...]:
        """The segments; where the sensor shows a mass at rest to be elsewhere than at zero, which begin at rest."""
        rest = float(core.record(self.values, np.zeros(core.states), None, 1, 1.0, 1.0)[0])
        if rest == 0.0 or not np.isfinite(rest):
            return self.data.segments
        return tuple(
            replace(s, rests=s.force is not None and starts_at_rest(s.response - rest, s.dt, s.pace, noise))
            for s, noise in zip(self.data.segments, self.data.sensor, strict=True)
        )

    def state(self, initial: np.ndarray | None, offsets: np.ndarray | None = None) -> State:
        """A point of the search: initial states of a smaller model are completed with zeros."""
        states = self.problem.core.states
        own = np.zeros((len(self.data.segments), states))
        if initial is None:
            shown = {o.recording: o.guess for o in self.problem.offsets if o.channel == "response"}
            shifts = [shown.get(segment.recording, 0.0) for segment in self.segments]
            initial = initial_states(self.segments, shifts)
        own[:, : initial.shape[1]] = initial[:, :states]
        for segment, begin in zip(self.segments, own, strict=True):
            if segment.rests and not goes_on(segment):
                begin[[i for i in range(states) if i not in self.problem.free_states(segment)]] = 0.0
        if offsets is None or offsets.size != len(self.problem.offsets):
            offsets = np.array([offset.guess for offset in self.problem.offsets])
        return State(self.values, own, offsets)

    def fit(
        self,
        initial: np.ndarray | None = None,
        *,
        noise: Sequence[NoiseSpectrum] | None = None,
        tolerance: float = 0.5,
        most: int = 25,
        settle: bool = False,
    ) -> Fitted:
        """Search from the present values.

        Args:
            initial: (segments, states) where the initial states start; found from the first motion where None.
            noise: as in ``descent.search``; with None the noise is white with a level of its own per segment.
            tolerance: gain of log-likelihood at which the search is over.
            most: steps it may take.
            settle: whether to improve the initial states first.
        """
        state = self.state(initial)
        if settle or initial is None:
            state = settled(self.problem, state)
        residuals = self.problem.residuals(state)
        if not all(np.all(np.isfinite(residual)) for residual in residuals):
            raise BadInput("the model does not simulate with its start values; check the units of force and response")
        how = {"tolerance": tolerance, "most": most, "informed": False, "tempered": False}
        outcome = search(self.problem, state, noise, **how, residuals=residuals)
        model = with_values(self.model, outcome.state.values)
        return Fitted(
            model,
            outcome.state.initial,
            outcome.residuals,
            likelihood(outcome.residuals, model, self.data),
            self.free,
            outcome.state.offsets,
        )


def without_states(fitted: Fitted, effect: str) -> np.ndarray:
    """Initial states of a model once the states of one of its laws are gone."""
    names = equations(fitted.model).state_names
    return fitted.initial[:, [i for i, name in enumerate(names) if not name.startswith(f"{effect}.")]]

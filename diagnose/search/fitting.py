"""Fits of one model structure after another to the same recordings.

All of them simulate the same segments and are judged alike, so that what one law explains and another does not can
be told in units of log-likelihood.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...identify.hilbert import noise_level
from ...identify.likelihood import SLACK, displacement_amplitude, equivalent_resonance, initial_states, typical_sizes
from ...identify.noise_spectrum import NoiseSpectrum, estimate
from ...identify.output_error import OutputError, State
from ...identify.segments import Segment, cut, starts_at_rest
from ...model import Oscillator
from ...model.law import Law, Scales
from ...model.laws import find
from ...model.oscillator import QUANTITIES, Term
from ...model.parameter import Parameter
from ...recording.recording import Recording
from ...simulate.core import Core, core_of, internal_step

#: Finite differences and first steps of a law's parameter, as a part of its natural size.
_SMALL = 1e-2
#: An onset or a speed this many times beyond where the law is looked for has left the recordings.
_FENCE = 10.0
#: The search simulates with longer steps than the model that is delivered: its error stays far below any noise.
_COARSER = 3.0
#: A motion so fast that a sample interval takes more steps than this is nothing that the recordings could show.
_FINEST = 40.0
#: The force is interpolated more coarsely there too: to 1e-5 up to the resonance, to 1e-4 at twice that.
_FORCE_BAND = 1.0
#: Finite differences of a likelihood with many side valleys reach over these.
_WIDE = 3e-3


@dataclass(frozen=True, eq=False)
class Data:
    """Recordings of one rig, cut into the segments that every model is fitted to.

    Attributes:
        recordings: as read.
        segments: free decays and driven stretches.
        sensor: (segments,) standard deviation of the response's noise, from its highest frequencies.
        force: (segments,) the same of the force.
        scales: sizes of the motion.
    """

    recordings: tuple[Recording, ...]
    segments: tuple[Segment, ...]
    sensor: tuple[float, ...]
    force: tuple[float, ...]
    scales: Scales

    @property
    def points(self) -> int:
        """Number of samples in all segments."""
        return sum(segment.n for segment in self.segments)


@dataclass(frozen=True, eq=False)
class Fitted:
    """A model fitted to data.

    Attributes:
        model: structure and values.
        initial: (segments, states) initial states.
        residuals: measured minus simulated, one (n,) array a segment.
        likelihood: log-likelihood, concentrated over a noise spectrum of each segment.
        free: names of the parameters that were fitted.
    """

    model: Oscillator
    initial: np.ndarray
    residuals: tuple[np.ndarray, ...]
    likelihood: float
    free: tuple[str, ...]

    @property
    def finite(self) -> bool:
        """Whether the model simulates."""
        return all(bool(np.all(np.isfinite(residual))) for residual in self.residuals)


def data_of(recordings: Sequence[Recording], model: Oscillator, lines: Sequence[float] = ()) -> Data:
    """Cut recordings and measure their noise and the sizes of the motion.

    Raises:
        BadInput: where nothing in them can be fitted.
    """
    segments = cut(recordings, model.omega0.value, _FORCE_BAND)
    if model.mass is None:
        segments = tuple(segment for segment in segments if segment.force is None)
    if not segments:
        names = ", ".join(recording.name for recording in recordings)
        raise BadInput(
            f"{names}: neither a free decay nor a stretch driven by a force that is long and loud enough to fit; "
            "record a decay of at least ten cycles or a sweep through the resonance"
        )
    responses = [np.asarray(r.response, float) for r in recordings]
    sensor = [noise_level(response, r.fs) for response, r in zip(responses, recordings, strict=True)]
    force = [0.0 if r.force is None else noise_level(np.asarray(r.force, float), r.fs) for r in recordings]
    order = QUANTITIES.index(model.response.quantity)
    peak = max(float(np.max(np.abs(segment.response))) for segment in segments)
    scales = Scales(
        length=displacement_amplitude(segments, model),
        omega=segments[0].pace,
        force=max((float(np.max(np.abs(r.force))) for r in recordings if r.force is not None), default=0.0),
        response=peak if order else displacement_amplitude(segments, model),
        duration=max(r.n * r.dt for r in recordings),
        mass=None if model.mass is None else model.mass.value,
        lines=tuple(lines),
    )
    return Data(
        tuple(recordings),
        segments,
        tuple(sensor[segment.recording] for segment in segments),
        tuple(force[segment.recording] for segment in segments),
        scales,
    )


def with_term(model: Oscillator, effect: str, values: Mapping[str, float]) -> Oscillator:
    """The model with one further effect, its parameters given by name."""
    effects = (*(term.effect for term in model.terms), effect)
    numbers = model.values() | {f"{effect}.{name}": value for name, value in values.items()}
    grown = Oscillator.from_values(
        numbers, name=model.name, response=model.response, force_unit=model.force_unit, effects=effects
    )
    return replace(grown, amplitude=model.amplitude, frequency=model.frequency)


def without_term(model: Oscillator, effect: str) -> Oscillator:
    """The model without one of its effects."""
    return replace(model, terms=tuple(term for term in model.terms if term.effect != effect))


def renamed(fitted: Fitted, effect: str, law: Law) -> Fitted:
    """The same fit with one effect under the name of a law of the same equation, its parameters in the same order."""
    names = [p.name for p in law.parameters]
    (old,) = [term for term in fitted.model.terms if term.effect == effect]
    new = Term(law.name, dict(zip(names, old.parameters.values(), strict=True)))
    terms = tuple(new if term is old else term for term in fitted.model.terms)
    free = dict(zip((f"{effect}.{n}" for n in old.parameters), (f"{law.name}.{n}" for n in names), strict=True))
    return replace(
        fitted, model=replace(fitted.model, terms=terms), free=tuple(free.get(name, name) for name in fitted.free)
    )


def generalised(model: Oscillator, effect: str) -> Oscillator:
    """The model with one effect as its more general twin, whose further parameters are zero."""
    law = find(effect)
    assert law.twin is not None
    values = model.values()
    own = [values[f"{effect}.{p.name}"] for p in law.parameters]
    names = [p.name for p in find(law.twin).parameters]
    return with_term(
        without_term(model, effect), law.twin, dict.fromkeys(names, 0.0) | dict(zip(names, own, strict=False))
    )


def with_values(model: Oscillator, values: np.ndarray) -> Oscillator:
    """The model with other values, in the order of ``parameters()``, and no errors."""
    old = model.parameters()
    return model.with_parameters(
        {name: Parameter(float(value), None, old[name].unit) for name, value in zip(old, values, strict=True)}
    )


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
    """(2, parameters) lowest and highest values: a law's own; for its onsets and speeds ten times beyond its probes."""
    known = {"mass": (1e-300, np.inf), "omega0": (SLACK / scales.duration, np.inf)}
    for term in model.terms:
        for p in term.law.parameters:
            low, high = p.lower, p.upper
            if not p.strength and not p.shape and p.probes and p.probes != "lines":
                size = p.natural(scales)
                reach = [float(probe) * size for probe in p.probes]
                inner = min(abs(r) for r in reach) / _FENCE
                low = max(low, inner if min(reach) > 0 else min(reach) * _FENCE)
                high = min(high, max(reach) * _FENCE)
            known[f"{term.effect}.{p.name}"] = (low, high)
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
    """

    def __init__(self, model: Oscillator, data: Data, fixed: Sequence[str] = ()) -> None:
        self.model = model
        self.data = data
        names = tuple(model.parameters())
        # free motion says nothing of the mass
        driven = any(segment.force is not None for segment in data.segments)
        self.free = tuple(name for name in names if name not in fixed and (driven or name != "mass"))
        core = core_of(model)
        scales = data.scales
        inner = [_SMALL * scales.of(state.unit) for state in core.equations.inner]
        length = scales.length
        self.values = np.array(list(model.values().values()))
        self.segments = self._at_rest(core)
        self.problem = OutputError(
            core,
            self.segments,
            tuple(names.index(name) for name in self.free),
            parameter_sizes(model, scales),
            np.array([_SMALL * length, _SMALL * length * scales.omega, *inner]),
            max(internal_step(model, model.values(), length) * _COARSER, min(s.dt for s in data.segments) / _FINEST),
            parameter_bounds(model, scales),
            **({"step": _WIDE} if any(term.law.rugged for term in model.terms) else {}),
        )

    def _at_rest(self, core: Core) -> tuple[Segment, ...]:
        """The segments; where the sensor shows a mass at rest to be elsewhere than at zero, which begin at rest."""
        rest = float(core.record(self.values, np.zeros(core.states), None, 1, 1.0, 1.0)[0])
        if rest == 0.0 or not np.isfinite(rest):
            return self.data.segments
        return tuple(
            replace(s, rests=s.force is not None and starts_at_rest(s.response - rest, s.dt, s.pace, noise))
            for s, noise in zip(self.data.segments, self.data.sensor, strict=True)
        )

    def state(self, initial: np.ndarray | None) -> State:
        """A point of the search: initial states of a smaller model are completed with zeros."""
        states = self.problem.core.states
        own = np.zeros((len(self.data.segments), states))
        if initial is None:
            initial = initial_states(self.segments, self.model)
        own[:, : initial.shape[1]] = initial[:, :states]
        for segment, begin in zip(self.segments, own, strict=True):
            if segment.rests:
                begin[[i for i in range(states) if i not in self.problem.own(segment)]] = 0.0
        return State(self.values, own)

    def here(self, initial: np.ndarray | None = None) -> tuple[State, tuple[np.ndarray, ...]]:
        """The present point and its residuals."""
        state = self.state(initial)
        return state, self.problem.residuals(state)

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
            noise: as in ``OutputError.search``; with None the noise is white with a level of its own per segment.
            tolerance: gain of log-likelihood at which the search is over.
            most: steps it may take.
            settle: whether to improve the initial states first.
        """
        state = self.state(initial)
        if settle or initial is None:
            state = self.problem.settle(state)
        if not all(np.all(np.isfinite(residual)) for residual in self.problem.residuals(state)):
            raise BadInput("the model does not simulate with its start values; check the units of force and response")
        outcome = self.problem.search(state, noise, tolerance=tolerance, most=most, informed=False)
        model = with_values(self.model, outcome.state.values)
        return Fitted(
            model,
            outcome.state.initial,
            outcome.residuals,
            likelihood(outcome.residuals, model, self.data),
            self.free,
        )


def noise_spectra(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> list[NoiseSpectrum]:
    """Spectrum of what is left over in each segment, force noise through the resonance among it."""
    values = model.values()
    found = []
    for segment, residual in zip(data.segments, residuals, strict=True):
        shape = None
        if segment.force is not None:
            shape = equivalent_resonance(segment, values, model.response.quantity)
        found.append(estimate(residual, shape))
    return found


def likelihood(residuals: Sequence[np.ndarray], model: Oscillator, data: Data) -> float:
    """Log-likelihood concentrated over the noise spectra (Whittle 1953); -inf where the model does not simulate."""
    if not all(np.all(np.isfinite(residual)) for residual in residuals):
        return -np.inf
    return -0.5 * sum(spectrum.log_determinant() for spectrum in noise_spectra(residuals, model, data))


def natural_values(effect: str, scales: Scales, probe: Mapping[str, float]) -> dict[str, float]:
    """Parameters of a law from probes in natural sizes."""
    law = find(effect)
    return {p.name: probe.get(p.name, 0.0) * p.natural(scales) for p in law.parameters}

"""What speaks for a fitted structure: evidence of the training recordings, and how well it tells those held out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from ...identify.fit.evidence import Marginal, Prior, cross_validated, evidence, marginalised, predictive
from ...identify.problem.data import Data, likelihood
from ...identify.problem.linearised import Linearised, Sums
from ...identify.problem.offset import FEELER
from ...identify.problem.output_error import State
from ...identify.problem.segments import Segment
from ...identify.problem.settle import settled
from ...identify.problem.structure import Fitted, Structure
from ...identify.signals.registry import budget
from ...model import Oscillator
from ...model.law import Scales
from ..limits import STRETCH_CYCLES, THIRDS
from .measure import Measure

#: A sensor may show as much at zero as the motion is large.
_SIZES = 1.0 / FEELER
_REMEMBERED = budget(
    32,
    "fits",
    why="whose derivatives are kept, some megabytes each: whenever the measure changes all are weighed again",
)


def judged(model: Oscillator, data: Data) -> Fitted:
    """Recordings under a model as it is; only initial states and offsets are found anew.

    A recording through which the model does not simulate is left whole as its residual.
    """
    structure = Structure(model, data, tuple(model.parameters()))
    state = settled(structure.problem, structure.state(None))
    residuals = structure.problem.residuals(state)
    if all(np.all(np.isfinite(residual)) for residual in residuals):
        return structure.fit(state.initial, tolerance=0.1)
    untold = tuple(
        residual if np.all(np.isfinite(residual)) else segment.response
        for segment, residual in zip(data.segments, residuals, strict=True)
    )
    return Fitted(model, state.initial, untold, likelihood(untold, model, data), (), state.offsets)


def evidence_of(fitted: Fitted, data: Data, measure: Measure) -> tuple[float, Marginal]:
    """Log-evidence of the training recordings, and what they tell of the parameters.

    Args:
        fitted: to the training recordings.
        data: training recordings.
        measure: in which structures are compared on these.
    """
    training = _marginal(fitted, data, fitted.free, measure)
    values = np.array([fitted.model.values()[name] for name in fitted.free])
    return evidence(training, values, shared_prior(fitted.model, fitted.free, data.scales)), training


def foreseen_loss(fitted: Fitted, data: Data, law: str, measure: Measure) -> float:
    """What the linearised response loses of log-likelihood where a law has no strength or lag, all else fitted along.

    Zero for one that neither takes away, of which nothing is foreseen.

    Args:
        fitted: to the training recordings, with the law.
        data: training recordings.
        law: its name.
        measure: in which structures are compared on these.
    """
    own = next(term.law for term in fitted.model.terms if term.effect == law)
    sizes = [f"{law}.{parameter.name}" for parameter in own.parameters if parameter.strength or own.lags]
    if not sizes or not set(sizes) <= set(fitted.free):
        return 0.0
    places = np.array([fitted.free.index(name) for name in sizes])
    told = _marginal(fitted, data, fitted.free, measure)
    others = np.setdiff1d(np.arange(len(fitted.free)), places)
    sums = Sums(told.information, told.gradient, 0.0, data.points).without(others)
    values = np.array([fitted.model.values()[name] for name in sizes])
    return 0.5 * float(values @ sums.normal @ values)


def foretold(
    fitted: Fitted, training: Marginal, data: Data, held_out: Fitted, holdout: Data, measure: Measure
) -> float:
    """Log-probability of held-out recordings, given those of the training.

    Args:
        fitted: to the training recordings.
        training: what these tell of the parameters.
        data: training recordings.
        held_out: the same parameters on recordings that they were not fitted to; see ``judged``.
        holdout: these recordings.
        measure: in which structures are compared on these.
    """
    prior = shared_prior(fitted.model, fitted.free, data.scales)
    return predictive(_marginal(held_out, holdout, fitted.free, measure), training, prior)


def stretches_of(data: Data) -> Data:
    """The same recordings, each segment cut in stretches that are simulated from initial states of their own."""

    def count(segment: Segment) -> int:
        return THIRDS if segment.n * segment.dt * segment.pace / (2 * np.pi) >= THIRDS * STRETCH_CYCLES else 1

    return in_stretches(data, count)


def in_stretches(data: Data, count: Callable[[Segment], int]) -> Data:
    """The same, each segment cut in as many."""
    stretches, places = [], []
    for place, segment in enumerate(data.segments):
        edges = np.linspace(0, segment.n, count(segment) + 1).round().astype(int).tolist()
        stretches += [segment.part(a, b) for a, b in pairwise(edges)]
        places += [place] * (len(edges) - 1)
    sensor, force = (tuple(levels[place] for place in places) for levels in (data.sensor, data.force))
    return replace(data, segments=tuple(stretches), sensor=sensor, force=force)


def foretold_by_the_others(fitted: Fitted, stretches: Data, measure: Measure) -> float:
    """Log-probability of each stretch of the training recordings given the others: for where nothing is held out.

    Args:
        fitted: to the whole recordings.
        stretches: of these; see ``stretches_of``.
        measure: in which structures are compared on these.
    """
    own = judged(fitted.model, stretches)
    parts = _marginal_by_segment(own, stretches, fitted.free, measure)
    return cross_validated(parts, shared_prior(fitted.model, fitted.free, stretches.scales))


def _marginal(fitted: Fitted, data: Data, free: tuple[str, ...], measure: Measure) -> Marginal:
    """What recordings tell of the parameters, their initial states and offsets averaged over."""
    parts = _marginal_by_segment(fitted, data, free, measure)
    return Marginal(
        sum(part.log_likelihood for part in parts),
        np.sum([part.information for part in parts], axis=0),
        np.sum([part.gradient for part in parts], axis=0),
    )


def _marginal_by_segment(fitted: Fitted, data: Data, free: tuple[str, ...], measure: Measure) -> list[Marginal]:
    """The same of each segment."""
    structure, state, slopes = linearised_at(fitted, data, free)
    problem = structure.problem
    linearised = Linearised.of(problem, state, fitted.residuals, measure.spectra(fitted.residuals), slopes)
    k, whole = len(structure.free), initial_prior(fitted.model, data)
    shared = [free.index(name) for name in structure.free]  # free motion says nothing of the mass
    by_segment = []
    for segment, begin, sums, value in zip(
        problem.segments, state.initial, linearised.sums, measure.values(fitted.residuals), strict=True
    ):
        places = np.array(problem.free_states(segment), int)
        # an offset belongs to its recording; it is averaged over with the states, in each of its segments
        own = [i for i, offset in enumerate(problem.offsets) if offset.recording == segment.recording]
        where = np.concatenate([own, len(problem.offsets) + places]).astype(int)
        middle = np.concatenate([[-problem.offsets[i].taken for i in own], whole[0, places]])
        width = np.concatenate([[_SIZES * problem.offsets[i].scale for i in own], whole[1, places]])
        values = np.concatenate([state.offsets[own], begin[places]])
        part = marginalised(value, sums, k + where, values, np.array([middle, width]), k)
        information, gradient = np.zeros((len(free), len(free))), np.zeros(len(free))
        information[np.ix_(shared, shared)], gradient[shared] = part.information, part.gradient
        by_segment.append(Marginal(part.log_likelihood, information, gradient))
    return by_segment


@lru_cache(maxsize=_REMEMBERED)
def linearised_at(fitted: Fitted, data: Data, free: tuple[str, ...]) -> tuple[Structure, State, list[np.ndarray]]:
    """A fit as a point of its structure's search, with its derivatives: the same in every measure."""
    fixed = [name for name in fitted.model.parameters() if name not in free]
    structure = Structure(fitted.model, data, fixed)
    state = structure.state(fitted.initial, fitted.offsets)
    return structure, state, structure.problem.derivatives(state, fitted.residuals)


def forget() -> None:
    """Give back the derivatives that were kept; a search that has ended needs them no more."""
    linearised_at.cache_clear()


def shared_prior(model: Oscillator, free: tuple[str, ...], scales: Scales) -> Prior:
    """Middle and width of what each parameter could be: its natural size; a frequency and a mass, themselves."""
    values = model.values()
    natural = {"mass": abs(values.get("mass", 1.0)), "omega0": scales.omega, "cubic": scales.of("1/(X2.s2)")}
    natural |= {"viscous": scales.omega, "dry": scales.of("X/s2"), "preload": scales.of("X/s2")}
    for term in model.terms:
        natural |= {f"{term.effect}.{p.name}": p.natural(scales) for p in term.law.parameters}
    return np.array([np.zeros(len(free)), [natural[name] for name in free]])


def initial_prior(model: Oscillator, data: Data) -> Prior:
    """The same of displacement, velocity and inner states at the start of a segment."""
    from ...model.equations import equations

    scales = data.scales
    sizes = [scales.length, scales.length * scales.omega]
    sizes += [scales.of(state.unit) for state in equations(model).inner]
    return np.array([np.zeros(len(sizes)), sizes])

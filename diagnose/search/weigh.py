"""What speaks for a fitted structure: evidence of the training recordings, and how well it tells those held out."""

from __future__ import annotations

import numpy as np

from ...identify.data import Data, likelihood
from ...identify.evidence import Prior, Told, evidence, predictive, told
from ...identify.output_error import State
from ...identify.settle import settled
from ...identify.structure import Fitted, Structure
from ...model import Oscillator
from ...model.law import Scales
from .measure import Measure


def judged(model: Oscillator, data: Data) -> Fitted:
    """Recordings under a model as it is; only initial states and offsets are found anew.

    A recording through which the model does not simulate is not told at all.
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
    return Fitted(model, state.initial, untold, likelihood(untold, model, data), ())


def weighed(fitted: Fitted, data: Data, measure: Measure) -> tuple[float, Told]:
    """Log-evidence of the training recordings, and what they tell of the parameters.

    Args:
        fitted: to the training recordings.
        data: training recordings.
        measure: in which structures are compared on these.
    """
    training = _told(fitted, data, fitted.free, measure)
    values = np.array([fitted.model.values()[name] for name in fitted.free])
    return evidence(training, values, shared_prior(fitted.model, fitted.free, data.scales)), training


def foretold(
    fitted: Fitted, training: Told, data: Data, held_out: Fitted, holdout: Data, measure: Measure
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
    return predictive(_told(held_out, holdout, fitted.free, measure), training, prior)


def _told(fitted: Fitted, data: Data, free: tuple[str, ...], measure: Measure) -> Told:
    """What recordings tell of the parameters, their initial states and offsets averaged over."""
    fixed = [name for name in fitted.model.parameters() if name not in free]
    structure = Structure(fitted.model, data, fixed)
    problem = structure.problem
    state: State = structure.state(fitted.initial, fitted.offsets)
    blocks = problem.blocks(state, fitted.residuals, measure.spectra(fitted.residuals))
    k = len(structure.free)
    whole = initial_prior(fitted.model, data)
    initial = []
    for segment, begin in zip(problem.segments, state.initial, strict=True):
        places = np.array(problem.own(segment), int)
        offsets = len(problem.offsets)
        # an offset belongs to its recording; it is averaged over with the states, in each of its segments
        where = np.concatenate([np.arange(offsets), offsets + places]).astype(int)
        width = np.concatenate([[100.0 * offset.scale for offset in problem.offsets], whole[1, places]])
        middle = np.zeros(len(where))
        initial.append((where, np.concatenate([state.offsets, begin[places]]), np.array([middle, width])))
    return told(measure.value(fitted.residuals), blocks, initial, k)


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

"""The element that a fit stands for, with standard errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..identify.problem.normal_equations import pseudo_inverse
from ..identify.signals.noise_spectrum import estimate
from ..identify.signals.registry import numerics
from ..model.element import Element
from ..model.oscillator import Provenance
from .channels import dependence_of, size_of
from .fit import Fitted, Problem

_STEP = numerics(1e-4, "of a value", why="of a difference quotient of the force by a place")


def element_of(fitted: Fitted, problem: Problem, name: str, units: tuple[str, str]) -> Element:
    """The element of a fit.

    Its standard errors are those of what is left, of whatever colour that is (Huber 1967): noise that comes with the
    motion, as any mismatch does, counts where the motion is. What another smoothing of the motion would find is in them
    too. The load is the mean of the recordings' constants.

    Args:
        fitted: members and laws.
        problem: to which it was fitted.
        name: of the specimen.
        units: of displacement and force.
    """
    laws = fitted.shape.laws
    ways, spans = fitted.shape.ways, problem.spans
    sizes = {way.name: size_of(way, spans[way.channel]) for way in ways}
    own = {*fitted.shape.members, *(f"{law.name}.{p.name}" for law in laws for p in law.parameters)}
    values = {name: value for name, value in fitted.values.items() if name in own}
    made = [dependence_of(way, spans[way.channel]) for way in ways]
    values |= {one.name: sizes[one.name] * fitted.values[one.name] for one in made if one.name}
    values["load"] = float(np.mean(fitted.constants))
    element = Element.from_values(
        values, name=name, unit=units[0], force_unit=units[1], origin=problem.origin, laws=laws, dependences=made
    )
    names, covariance = _covariance(fitted, problem)
    scale = np.array([sizes.get(name, 1.0) for name in names])
    covariance = covariance * np.outer(scale, scale)
    errors = dict(zip(names, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
    known = element.parameters()
    told = {n: replace(p, std=float(errors[n])) for n, p in known.items() if n in errors}
    ordered = [name for name in known if name in errors]
    places = [names.index(name) for name in ordered]
    rows = covariance[np.ix_(places, places)]
    provenance = Provenance(parameters=tuple(ordered), covariance=tuple(map(tuple, rows.tolist())))
    return replace(element.with_parameters(told), identified=provenance)


def _covariance(fitted: Fitted, problem: Problem) -> tuple[list[str], np.ndarray]:
    """Names of what was fitted, the load last, and their covariance."""
    shape, count = fitted.shape, len(problem.motions)
    placed = [name for name, _ in shape.placed()]
    names = [*shape.linear(), *placed]
    k = len(names)
    normal, scattered = np.zeros((k + count, k + count)), np.zeros((k + count, k + count))
    doubted, numbers = np.zeros(k + count), problem.strengths(fitted)
    for i, (motion, residual) in enumerate(zip(problem.motions, fitted.residuals, strict=True)):
        rows = np.zeros((k + count, motion.n))
        linear = problem.columns(shape, fitted.values, motion)
        rows[: len(linear)] = linear
        for place, name in enumerate(placed, start=len(linear)):
            rows[place] = _slope(fitted, problem, name, i)
        rows[k + i] = 1.0
        rows[:, ~motion.told] = 0.0
        level = max(float(np.mean(residual[motion.told] ** 2)), motion.noise**2)
        spectrum = estimate(residual, None, float(np.mean(motion.told)))
        coloured = spectrum.colour(rows) / level
        otherwise = numbers @ (problem.columns(shape, fitted.values, problem.doubted(i)) - linear)
        doubted += rows @ np.where(motion.told & np.isfinite(otherwise), otherwise, 0.0) / level
        normal += rows @ rows.T / level
        scattered += coloured @ coloured.T
    inverse = pseudo_inverse(normal)
    whole = inverse @ (scattered + np.outer(doubted, doubted)) @ inverse
    turn = np.zeros((k + 1, k + count))
    turn[:k, :k] = np.eye(k)
    turn[k, k:] = 1.0 / count
    return [*names, "load"], turn @ whole @ turn.T


def _slope(fitted: Fitted, problem: Problem, name: str, i: int) -> np.ndarray:
    """(n,) derivative of the force along a motion by a place."""
    value = fitted.values[name]
    natural = next(p.natural(problem.scales) for own, p in fitted.shape.placed() if own == name)
    step = _STEP * (abs(value) or natural)
    strengths = problem.strengths(fitted)
    ahead, back = (
        strengths @ problem.columns(fitted.shape, {**fitted.values, name: value + way * step}, problem.motions[i])
        for way in (1.0, -1.0)
    )
    return (ahead - back) / (2.0 * step)

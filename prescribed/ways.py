"""Which strengths of an element depend on channels, and how: fitted as laws are, beside whatever is there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..identify.signals.odds import DECISIVE
from ..identify.signals.registry import budget, numerics
from ..model.law import Law
from .channels import Way, ways_of
from .fit import Fitted, Problem, Shape
from .judge import Judge

_LINEAR = budget(4, "strengths", why="of those that gain most where they may bend with a channel, that are fitted")
_BENT = budget(2, "strengths", why="of those that are fitted, the likeliest, of which each other form is")
_ALIKE = numerics(0.01, "of log-odds", why="by which forms differ that the same two values of a channel show")

Fit = Callable[[Shape, Mapping[str, float]], Fitted | None]


def without_law(shape: Shape, law: Law) -> Shape:
    """The same without a law, and without what of it depends on channels."""
    laws = tuple(other for other in shape.laws if other is not law)
    return replace(shape, laws=laws, ways=tuple(way for way in shape.ways if way.of.rpartition(".")[0] != law.name))


def without_way(shape: Shape, way: Way) -> Shape:
    """The same with a strength that is the same throughout."""
    return replace(shape, ways=tuple(other for other in shape.ways if other != way))


def fitted_ways(problem: Problem, shape: Shape, values: Mapping[str, float], fit: Fit) -> list[Fitted]:
    """A structure with one dependence more: each form of those strengths that gain most, all else free.

    Args:
        problem: motions and channels.
        shape: what is there.
        values: of its places.
        fit: fits a structure from its places.
    """
    taken = {(way.of, way.channel) for way in shape.ways}
    every = [(of, channel) for of in (*shape.strengths(), "load") for channel in problem.spans]
    asked = [pair for pair in every if pair not in taken]
    first = [pair for _, pair in problem.apart(shape, values, asked)[:_LINEAR]]
    made: dict[tuple[str, str], list[Fitted]] = {}
    for of, channel in first:
        way = Way(channel, of, "linear")
        one = fit(replace(shape, ways=(*shape.ways, way)), values)
        if one is not None:
            made[of, channel] = [one]
    likeliest = sorted(made, key=lambda pair: -made[pair][0].likelihood)
    for of, channel in likeliest[:_BENT]:
        for way in ways_of(problem.spans[channel], of):
            if way.how == "linear":
                continue
            at = {**values, way.name: way.begun}
            one = fit(replace(shape, ways=(*shape.ways, way)), at)
            made[of, channel] += [] if one is None else [one]
    return [one for pair in likeliest for one in made[pair]]


def best_of(made: Sequence[Fitted], odds: Callable[[Fitted], float]) -> Fitted | None:
    """The most probable, and of what is alike but for rounding the first; None of none.

    Of the forms of one dependence that the fitted recordings do not decisively tell apart the one is taken that leaves
    the least of those that were held out.
    """
    best: tuple[float, Fitted] | None = None
    for one in made:
        value = odds(one)
        if best is None or value > best[0] + _ALIKE:
            best = value, one
    if best is None or not best[1].held:
        return None if best is None else best[1]
    alike = [one for one in made if _apart(one, best[1]) and best[0] - odds(one) < DECISIVE]
    return min([best[1], *alike], key=lambda one: _told(_left(one)))


def _odds_against(judge: Judge, fitted: Fitted) -> Callable[[Fitted], float]:
    return lambda one: float(judge.odds(one, fitted)[0])


def _apart(one: Fitted, other: Fitted) -> bool:
    """Whether two structures differ in the form of their last dependence alone."""
    ways, others = one.shape.ways, other.shape.ways
    if len(ways) != len(others) or not ways or ways[:-1] != others[:-1] or one.shape.laws != other.shape.laws:
        return False
    return (ways[-1].of, ways[-1].channel) == (others[-1].of, others[-1].channel) and ways[-1] != others[-1]


def _left(fitted: Fitted) -> float:
    """Sum of the squares that are left of what was held out."""
    return sum(float(np.sum(left**2)) for left in fitted.held)


def _told(value: float) -> float:
    """A sum to so many digits that rounding does not decide."""
    return float(f"{value:.4g}")


def forms_told(
    problem: Problem, judge: Judge, fitted: Fitted, fit: Fit
) -> tuple[Fitted, dict[Way, tuple[Way, list[str]]]]:
    """The likeliest form of each dependence on all recordings, and those that these do not decisively tell from it.

    Args:
        problem: all recordings.
        judge: of the same.
        fitted: to all of them.
        fit: fits a structure from its places.

    Returns:
        The structure, and for each dependence that it had the one that it has now, and names of forms not told.
    """
    told: dict[Way, tuple[Way, list[str]]] = {}
    for way in fitted.shape.ways:
        rest = without_way(fitted.shape, way)
        made = []
        for other in ways_of(problem.spans[way.channel], way.of):
            at = {**fitted.values, other.name: fitted.values.get(other.name, other.begun)}
            one = fitted if other == way else fit(replace(rest, ways=(*rest.ways, other)), at)
            if one is not None:
                made.append((other, one))
        likeliest = best_of([one for _, one in made], _odds_against(judge, fitted)) or fitted
        chosen = next((other for other, one in made if one is likeliest), way)
        near = [other for other, one in made if float(judge.odds(likeliest, one)[0]) < DECISIVE and other != chosen]
        told[way] = chosen, [str(other) for other in near]
        fitted = likeliest
    return fitted, told

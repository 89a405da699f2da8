"""Which strengths of an element depend on channels, and how: fitted as laws are, beside whatever is there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from ..identify.signals.registry import budget, numerics
from ..model.law import Law
from .channels import Way, ways_of
from .fit import Fitted, Problem, Shape

_LINEAR = budget(6, "strengths", why="of those that gain most where they may bend with a channel, that are fitted")
_BENT = budget(3, "strengths", why="of those that are fitted, the likeliest, of which each other form is")
_BEGIN = {"power": 1.0, "inverse": 0.0}
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
            at = {**values, way.name: _BEGIN.get(way.how, 0.0)}
            one = fit(replace(shape, ways=(*shape.ways, way)), at)
            made[of, channel] += [] if one is None else [one]
    return [one for pair in likeliest for one in made[pair]]


def best_of(made: Sequence[Fitted], odds: Callable[[Fitted], float]) -> Fitted | None:
    """The most probable, and of what is alike but for rounding the first; None of none."""
    best: tuple[float, Fitted] | None = None
    for one in made:
        value = odds(one)
        if best is None or value > best[0] + _ALIKE:
            best = value, one
    return None if best is None else best[1]

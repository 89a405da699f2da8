"""The life of a rig: models in order, which parameters moved, and at which point."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..errors import BadInput
from ..identify.odds import BY_CHANCE
from ..model import Oscillator
from .comparison import remarks, trusted
from .estimates import Estimates, laws_of, side_by_side
from .moved import Moved, joined, what_moved
from .repeatability import Repeatability, learnt_from, stated_errors
from .steps import Step, drift_of, steps_of

#: From so many states on, neighbours stand for repeats where there are none: with fewer a step looks like scatter.
ENOUGH = 6


@dataclass(frozen=True)
class Point:
    """One model in the life of a rig.

    Attributes:
        name: of the test.
        model: what was identified.
        state: points of the same state are repeats; None: a state of its own.
        when: a number, or a time as ISO 8601; None: its place counts.
    """

    name: str
    model: Oscillator
    state: str | None = None
    when: float | str | None = None


@dataclass(frozen=True, eq=False)
class Life:
    """What became of a rig.

    Attributes:
        name: of the rig.
        points: in order.
        groups: places of the points of each state, the states in order of their first point.
        estimates: of the points.
        moved: which parameters moved over all states; None where there is one state.
        repeatability: that it was judged by.
        steps: of each parameter that moved, from which state to which.
        drifts: change per state of each of them that moves in a straight line rather than in steps, with its error.
        laws: (state, appeared, vanished) where the laws differ from those of the state before.
        notes: what a user should know.
    """

    name: str
    points: tuple[Point, ...]
    groups: tuple[tuple[int, ...], ...]
    estimates: Estimates
    moved: Moved | None
    repeatability: Repeatability
    steps: tuple[Step, ...]
    drifts: dict[str, tuple[float, float]]
    laws: tuple[tuple[int, tuple[str, ...], tuple[str, ...]], ...]
    notes: tuple[str, ...]

    @property
    def changed(self) -> bool:
        """Whether anything did."""
        return bool(self.laws) or (self.moved is not None and (bool(self.moved.best.moved) or self.differs))

    @property
    def differs(self) -> bool:
        """Whether the states differ by more than chance, whatever moved."""
        return self.moved is not None and self.moved.nothing.chance <= BY_CHANCE

    def label(self, state: int) -> str:
        """What a state is called: its own name, or that of its point."""
        point = self.points[self.groups[state][0]]
        return point.state if point.state is not None else point.name

    def values(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """(m,) value of a parameter in each state and its error, given that what did not move did not."""
        j = self.estimates.names.index(name)
        if self.moved is None:
            first = self.estimates.values[:1, j], np.sqrt(self.estimates.covariance[:1, j, j])
            return first[0] * self.estimates.scale[j], first[1] * self.estimates.scale[j]
        return self.moved.values[:, j] * self.estimates.scale[j], self.moved.errors[:, j] * self.estimates.scale[j]

    def as_json(self) -> dict[str, Any]:
        """``dashpot-watch/1``."""
        from .life_wording import sentences

        scale = self.estimates.scale
        return {
            "format": "dashpot-watch/1",
            "rig": self.name,
            "sentences": sentences(self),
            "moved": [] if self.moved is None else list(self.moved.best.moved),
            "or_else": [] if self.moved is None else [list(rival.moved) for rival in self.moved.rivals],
            "judged_by": self.repeatability.source,
            "degrees_of_freedom": self.repeatability.learnt,
            "repeatability": {
                name: float(self.repeatability.spread[j] * scale[j]) for j, name in enumerate(self.estimates.names)
            },
            "errors_inflated_by": math.sqrt(
                self.repeatability.inflation * (1.0 if self.moved is None else self.moved.inflation)
            ),
            "changes": [
                {
                    **{"parameter": step.parameter, "after": self.label(step.state - 1), "at": self.label(step.state)},
                    **{"from": step.before, "to": step.after, "std": step.error},
                }
                for step in self.steps
            ],
            "drifts": {name: {"per_state": slope, "std": error} for name, (slope, error) in self.drifts.items()},
            "laws": [
                {"at": self.label(state), "appeared": list(new), "vanished": list(gone)}
                for state, new, gone in self.laws
            ],
            "points": [
                {
                    **{"name": point.name, "state": point.state, "when": point.when},
                    "parameters": {n: {"value": p.value, "std": p.std} for n, p in point.model.parameters().items()},
                }
                for point in self.points
            ],
            "notes": list(self.notes),
        }


def watch(points: Sequence[Point], name: str = "rig", *, level: float = BY_CHANCE) -> Life:
    """Which parameters moved over a rig's life, and when.

    Args:
        points: two or more, in any order where all bear a time, else in order.
        name: of the rig.
        level: how often chance alone may be taken for a change.

    Raises:
        BadInput: there are fewer than two, or the models cannot be compared.
    """
    points = in_order(points)
    if len(points) < 2:
        raise BadInput(f"{name}: one model has no life to watch; name two or more")
    models = [point.model for point in points]
    estimates, groups = side_by_side(models), _states(points)
    known = _known(estimates, groups, [], trusted(models))
    moved, steps, drifts = _judged(estimates, groups, known, level)
    if known.source == "neighbours" and steps:  # what lies across a step is no repeat
        known = _known(estimates, groups, [step.state for step in steps], trusted(models))
        moved, steps, drifts = _judged(estimates, groups, known, level)
    return Life(
        name=name,
        points=tuple(points),
        groups=tuple(tuple(group) for group in groups),
        estimates=estimates,
        moved=moved,
        repeatability=known,
        steps=steps,
        drifts=drifts,
        laws=tuple(_laws(points, groups)),
        notes=(*estimates.given, *remarks(models, known)),
    )


def in_order(points: Sequence[Point]) -> list[Point]:
    """By their times where all bear one, else as they are."""
    if any(point.when is None for point in points) or len({isinstance(p.when, str) for p in points}) > 1:
        return list(points)
    return sorted(points, key=lambda point: point.when)  # pyright: ignore[reportArgumentType, reportCallIssue]


def _states(points: Sequence[Point]) -> list[list[int]]:
    groups: dict[tuple[bool, str], list[int]] = {}
    for i, point in enumerate(points):
        key = (False, str(i)) if point.state is None else (True, point.state)
        groups.setdefault(key, []).append(i)
    return list(groups.values())


def _known(
    estimates: Estimates, groups: Sequence[Sequence[int]], steps: Sequence[int], believed: bool
) -> Repeatability:
    """By repeats where there are any; by neighbours between the steps where there are enough; else as stated."""
    if any(len(group) > 1 for group in groups):
        return learnt_from(estimates, groups, trusted=believed)
    if len(groups) < ENOUGH:
        return stated_errors(estimates.k, trusted=believed)
    edges = [0, *sorted(set(steps)), len(groups)]
    pairs = [[groups[i][0], groups[i + 1][0]] for low, high in pairwise(edges) for i in range(low, high - 1, 2)]
    return learnt_from(estimates, pairs, trusted=believed, source="neighbours")


def _judged(
    estimates: Estimates, groups: Sequence[Sequence[int]], known: Repeatability, level: float
) -> tuple[Moved | None, tuple[Step, ...], dict[str, tuple[float, float]]]:
    if len(groups) < 2:
        return None, (), {}
    states = joined(estimates.names, estimates.values, estimates.covariance, groups, known)
    moved = what_moved(states, level)
    steps: list[Step] = []
    drifts = {}
    for name in moved.best.moved:
        j = estimates.names.index(name)
        values, errors = moved.values[:, j] * estimates.scale[j], moved.errors[:, j] * estimates.scale[j]
        freedom = min(float(known.freedom[j]), moved.best.freedom if moved.inflation > 1 else math.inf)
        found = steps_of(name, values, errors, freedom, level)
        slope = drift_of(values, errors, level) if len(found) > 1 else None
        if slope is not None:
            drifts[name] = slope
        steps += found
    return moved, tuple(sorted(steps, key=lambda step: step.state)), drifts


def _laws(
    points: Sequence[Point], groups: Sequence[Sequence[int]]
) -> list[tuple[int, tuple[str, ...], tuple[str, ...]]]:
    found = []
    for i in range(1, len(groups)):
        before, after = (laws_of(points[groups[k][0]].model) for k in (i - 1, i))
        if set(before) != set(after):
            new = tuple(law for law in after if law not in before)
            found.append((i, new, tuple(law for law in before if law not in after)))
    return found

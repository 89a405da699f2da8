"""The life of a rig: models in order, which parameters moved, and at which point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..errors import BadInput
from ..files.computed_once import computed_once
from ..identify.signals.odds import BY_CHANCE
from ..model.identified import Identified
from .comparison import remarks, trusted
from .estimates import Estimates, laws_of, of_first, side_by_side
from .moved import Moved
from .quantities import Quantity, quantities
from .repeatability import Repeatability, learnt_from
from .steps import Step
from .stretches import Found, judged, leaps, neighbours

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
    model: Identified
    state: str | None = None
    when: float | str | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Life:
    """What became of a rig.

    Attributes:
        name: of the rig.
        points: in order.
        groups: places of the points of each state, the states in order of their first point.
        estimates: of the points.
        found: which parameters moved, and where; None where there is one state.
        repeatability: that it was judged by.
        laws: (state, appeared, vanished) where the laws differ from those of the state before.
        notes: what a user should know.
    """

    name: str
    points: tuple[Point, ...]
    groups: tuple[tuple[int, ...], ...]
    estimates: Estimates
    found: Found | None
    repeatability: Repeatability
    laws: tuple[tuple[int, tuple[str, ...], tuple[str, ...]], ...]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        moved = () if self.moved is None else self.moved.best.moved
        tests = f"{len(self.points)} tests, {len(self.groups)} states"
        return f"<Life of {self.name}: {tests}, {', '.join(moved) or 'nothing'} moved>"

    @property
    def moved(self) -> Moved | None:
        """Which parameters moved."""
        return None if self.found is None else self.found.moved

    @property
    def steps(self) -> tuple[Step, ...]:
        """Where they stepped."""
        return () if self.found is None else self.found.steps

    @property
    def drifts(self) -> dict[str, tuple[float, float]]:
        """Change per state of what moves in a straight line, with its error."""
        return {} if self.found is None else self.found.drifts

    @property
    def changed(self) -> bool:
        """Whether anything did."""
        return bool(self.laws) or (self.moved is not None and (bool(self.moved.best.moved) or self.differs))

    @property
    def differs(self) -> bool:
        """Whether the states differ by more than chance, whatever moved."""
        return self.moved is not None and self.moved.nothing.chance <= BY_CHANCE

    @computed_once
    def machine(self) -> dict[str, Quantity]:
        """What each parameter is to the machine, in each state."""
        masses = [float(m) for m in self.values("mass")[0]] if "mass" in self.estimates.names else None
        return quantities([self.points[group[0]].model for group in self.groups], masses)

    def label(self, state: int) -> str:
        """What a state is called: its own name, or that of its point."""
        point = self.points[self.groups[state][0]]
        return point.state if point.state is not None else point.name

    def values(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """(m,) value of a parameter in each state and its error, given that what did not move did not."""
        j = self.estimates.names.index(name)
        scale = self.estimates.scale[j]
        if self.found is None:
            place = list(self.groups[0])
            return self.estimates.values[place, j] * scale, np.sqrt(self.estimates.covariance[place, j, j]) * scale
        return self.found.values[:, j] * scale, self.found.errors[:, j] * scale


def watch(
    points: Sequence[Point],
    name: str = "rig",
    repeats: Sequence[Sequence[Identified]] = (),
    *,
    level: float = BY_CHANCE,
) -> Life:
    """Which parameters moved over a rig's life, and when.

    Args:
        points: two or more, in any order where all bear a time, else in order.
        name: of the rig.
        repeats: further groups of models, each of one rig in one state, to learn repeatability from.
        level: how often chance alone may be taken for a change.

    Raises:
        BadInput: there are fewer than two, or the models cannot be compared.
    """
    points = in_order(points)
    if len(points) < 2:
        raise BadInput(f"{name}: one model has no life to watch; name two or more")
    models = [point.model for point in points]
    further = [model for group in repeats for model in group]
    every, groups = side_by_side([*models, *further]), _states(points)
    estimates, believed = of_first(every, len(points)), trusted([*models, *further])
    teachers = [*groups, *_places(repeats, len(points))]
    if any(len(group) > 1 for group in teachers) or len(groups) < ENOUGH:
        known = learnt_from(every, teachers, trusted=believed)
        found = judged(estimates, groups, known, level)
    else:  # neighbours stand for repeats, but for those that a step parts
        cuts = leaps(estimates, groups)
        known = learnt_from(estimates, neighbours(groups, cuts), trusted=believed, source="neighbours")
        found = judged(estimates, groups, known, level)
        if found is not None and (parted := {*cuts, *found.cuts}) != set(cuts):
            known = learnt_from(estimates, neighbours(groups, parted), trusted=believed, source="neighbours")
            found = judged(estimates, groups, known, level)
    return Life(
        name=name,
        points=tuple(points),
        groups=tuple(tuple(group) for group in groups),
        estimates=estimates,
        found=found,
        repeatability=known,
        laws=tuple(_laws(points, groups)),
        notes=(*estimates.given, *remarks(models, known)),
    )


def _places(repeats: Sequence[Sequence[Identified]], first: int) -> list[list[int]]:
    """Where the models of each group stand behind ``first`` others."""
    ends = np.cumsum([first, *map(len, repeats)])
    return [list(range(low, high)) for low, high in pairwise(ends)]


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

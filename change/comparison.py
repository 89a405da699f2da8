"""Two models of one rig, or of two: what moved between them, and which law appeared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..identify.signals.odds import BY_CHANCE
from ..model.fit_state import left_of, left_over
from ..model.identified import Identified
from .estimates import Estimates, laws_of, side_by_side
from .moved import Moved, joined, what_moved
from .quantities import Quantity, quantities
from .repeatability import KNOWN, Repeatability, learnt_from, stated_errors


@dataclass(frozen=True)
class Shift:
    """One parameter of two models.

    Attributes:
        name, unit: of the parameter.
        first, second: values, with ``first_error`` and ``second_error`` as stated.
        errors: the difference in standard errors of the difference, as stated.
        repeats: the same with what repeats, or what did not move, add to it.
        chance: how often chance alone makes such a difference in one of all parameters (Holm 1979).
        moved: whether its change is needed to explain the difference of the models.
        seen_from: the smallest change that would have been seen, were it the only one.
    """

    name: str
    unit: str
    first: float
    second: float
    first_error: float
    second_error: float
    errors: float
    repeats: float
    chance: float
    moved: bool
    seen_from: float

    @property
    def change(self) -> float:
        """Second less first."""
        return self.second - self.first


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """What changed from one model to another.

    Attributes:
        first, second: their names.
        shifts: each parameter that both estimate.
        moved: the fewest parameters that explain the difference; see there.
        explained: value and error of each of them in both, given that nothing else moved.
        change_errors: the standard error of each of these changes.
        machine: what each parameter is to the machine, in the first and in the second.
        repeatability: that it was judged by.
        appeared, vanished: laws.
        notes: what a user should know.
    """

    first: str
    second: str
    shifts: tuple[Shift, ...]
    moved: Moved
    explained: dict[str, tuple[tuple[float, float], tuple[float, float]]]
    change_errors: dict[str, float]
    machine: dict[str, Quantity]
    repeatability: Repeatability
    appeared: tuple[str, ...]
    vanished: tuple[str, ...]
    notes: tuple[str, ...]

    def __repr__(self) -> str:
        moved = f"{', '.join(self.moved.best.moved) or 'nothing'} moved"
        laws = [*(f"{law} appeared" for law in self.appeared), *(f"{law} vanished" for law in self.vanished)]
        return f"<Comparison of {self.first} with {self.second}: {', '.join([moved, *laws])}>"

    @property
    def changed(self) -> bool:
        """Whether anything did."""
        return bool(self.moved.best.moved or self.appeared or self.vanished or self.differs)

    @property
    def differs(self) -> bool:
        """Whether the models differ by more than chance, whatever moved."""
        return self.moved.nothing.chance <= BY_CHANCE


def compare(
    first: Identified, second: Identified, repeats: Sequence[Sequence[Identified]] = (), *, level: float = BY_CHANCE
) -> Comparison:
    """What changed from one model to another.

    Args:
        first, second: identified, with the covariance of their parameters.
        repeats: groups of models, each of one rig in one state, to learn repeatability from.
        level: how often chance alone may be taken for a change.

    Raises:
        BadInput: the models have other units, no errors, or no parameter in common.
    """
    models = [first, second, *(model for group in repeats for model in group)]
    estimates = side_by_side(models)
    places, groups = 2, []
    for group in repeats:
        groups.append(list(range(places, places + len(group))))
        places += len(group)
    learnt = learnt_from(estimates, groups, trusted=trusted(models)) if groups else None
    known = learnt or stated_errors(estimates.k, trusted=trusted(models))
    states = joined(estimates.names, estimates.values, estimates.covariance, [[0], [1]], known)
    moved = what_moved(states, level)
    scale = estimates.scale
    explained = {
        name: tuple((float(moved.values[c, j] * scale[j]), float(moved.errors[c, j] * scale[j])) for c in (0, 1))
        for j, name in enumerate(estimates.names)
        if name in moved.best.moved
    }
    masses = None
    if "mass" in estimates.names:
        j = estimates.names.index("mass")
        masses = [float(moved.values[c, j] * scale[j]) for c in (0, 1)]
    one, other = laws_of(first), laws_of(second)
    return Comparison(
        first=first.name,
        second=second.name,
        shifts=_shifts(estimates, states.covariance * moved.inflation, known, moved, level),
        moved=moved,
        change_errors={
            name: float(np.hypot(*moved.apart[:, j]) * scale[j])
            for j, name in enumerate(estimates.names)
            if name in moved.best.moved
        },
        machine=quantities([first, second], masses),
        explained=explained,  # pyright: ignore[reportArgumentType]
        repeatability=known,
        appeared=tuple(law for law in other if law not in one),
        vanished=tuple(law for law in one if law not in other),
        notes=(*estimates.given, *remarks(models[:2], known)),
    )


def trusted(models: Sequence[Identified]) -> bool:
    """Whether no model leaves more than noise of any recording, so that its errors are what they say."""
    return not any(left_over(model) for model in models)


def remarks(models: Sequence[Identified], known: Repeatability) -> list[str]:
    """What a user should know of the models that are compared, one sentence each."""
    notes = []
    worst = max((left for model in models for left in left_of(model)), key=lambda left: left.times, default=None)
    if not known.trusted and worst is not None:
        notes.append(
            f"the models leave up to {worst.of_noise}, so their parameters are off by more than their "
            "errors; how far was judged by what did not move"
        )
    if known.source == "errors":
        notes.append("no repeats were given: what differs from one test to the next of an unchanged rig is not known")
    spans = [(m.name, m.amplitude) for m in models if m.amplitude is not None and m.amplitude.max > 0]
    if spans:
        least, most = min(spans, key=lambda s: s[1].max), max(spans, key=lambda s: s[1].max)
        if most[1].max > 2 * least[1].max:
            notes.append(
                f"{most[0]} moved up to {most[1].max:.3g} {most[1].unit}, {least[0]} up to {least[1].max:.3g}: what "
                "depends on the amplitude in a way that the model lacks may look like a change"
            )
    return notes


def _shifts(
    estimates: Estimates, covariance: np.ndarray, known: Repeatability, moved: Moved, level: float
) -> tuple[Shift, ...]:
    """Each parameter of the first two models by itself."""
    from scipy.special import stdtr, stdtrit

    scale = estimates.scale
    difference = estimates.values[1] - estimates.values[0]
    stated = estimates.covariance[0] + estimates.covariance[1]
    whole = covariance[0] + covariance[1]
    in_errors, in_repeats = difference / np.sqrt(np.diag(stated)), difference / np.sqrt(np.diag(whole))
    freedom = known.freedom
    if moved.inflation > 1.0:
        freedom = np.minimum(freedom, moved.best.freedom)
    freedom = np.minimum(freedom, KNOWN)
    chance = holm(2 * stdtr(freedom, -np.abs(in_repeats)))
    alone = 1.0 / np.sqrt(np.diag(np.linalg.inv(whole)))  # its error were it the only one to move
    seen = -stdtrit(freedom, level / 2 / estimates.k) * alone
    return tuple(
        Shift(
            name=name,
            unit=estimates.units[j],
            first=float(estimates.values[0, j] * scale[j]),
            second=float(estimates.values[1, j] * scale[j]),
            first_error=float(np.sqrt(estimates.covariance[0, j, j]) * scale[j]),
            second_error=float(np.sqrt(estimates.covariance[1, j, j]) * scale[j]),
            errors=float(in_errors[j]),
            repeats=float(in_repeats[j]),
            chance=float(chance[j]),
            moved=name in moved.best.moved,
            seen_from=float(seen[j] * scale[j]),
        )
        for j, name in enumerate(estimates.names)
    )


def holm(chances: np.ndarray) -> np.ndarray:
    """(k,) chances of k tests, each in the light of all (Holm 1979)."""
    order = np.argsort(chances)
    k = len(chances)
    raised = np.maximum.accumulate(np.minimum(1.0, chances[order] * (k - np.arange(k))))
    made = np.empty(k)
    made[order] = raised
    return made

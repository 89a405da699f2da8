"""What a search ended with: the best structure, all others that were entered, and how a further one is evaluated."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...identify.problem.data import Data
from ...identify.problem.prediction import FREE
from ...identify.problem.structure import Fitted
from ...model.law import Law
from .candidate import Candidate, key
from .measure import Measure
from .weigh import evidence_of, foretold, foretold_by_the_others, judged, stretches_of


@dataclass(frozen=True, eq=False)
class Weighing:
    """By what structures are evaluated against each other.

    Attributes:
        data: training recordings.
        holdout: recordings that no parameter is fitted to; None where nothing could be held out.
        laws: the library, with the user's laws.
        measures: how the frequencies of the training recordings, and of those foretold, count.
    """

    data: Data
    holdout: Data | None
    laws: Sequence[Law]
    measures: tuple[Measure, Measure] = (Measure(), Measure())

    @property
    def parts(self) -> tuple[Data, ...]:
        """Training recordings, and those held out where there are any."""
        return (self.data,) if self.holdout is None else (self.data, self.holdout)

    @property
    def apart(self) -> Data:
        """What is foretold: the recordings held out or, where there are none, stretches of the others."""
        return stretches_of(self.data) if self.holdout is None else self.holdout

    def weigh(self, laws: tuple[str, ...], fitted: Fitted, held_out: Fitted | None = None) -> Candidate:
        """A fitted structure with what speaks for it; it is judged on what was held out where that is not given."""
        evidence, training = evidence_of(fitted, self.data, self.measures[0])
        # before anything was measured each law with a cause was as likely as any other, and one of them in all
        value = evidence - len(laws) * math.log(sum(not law.learnt for law in self.laws))
        if self.holdout is None:
            foreseen = foretold_by_the_others(fitted, self.apart, self.measures[1])
            return Candidate(laws, fitted, None, value, 0.0, foreseen, "judged")
        held_out = held_out or judged(fitted.model, self.holdout)
        foreseen = foretold(fitted, training, self.data, held_out, self.holdout, self.measures[1])
        return Candidate(laws, fitted, held_out, value, foreseen, foreseen, "judged")


@dataclass(frozen=True, eq=False)
class Found:
    """What a search ended with; the steps after it make others of it.

    Attributes:
        selected: the best structure.
        candidates: every structure that was entered, by the laws it adds; those never put in say why.
        weighing: by what they were evaluated.
        asked_rugged: whether laws with side valleys were asked for.
        family_memory: how far the family predicted when the search began, in cycles.
        untried: what was not asked for want of time, in words.
    """

    selected: Candidate
    candidates: Mapping[tuple[str, ...], Candidate]
    weighing: Weighing
    asked_rugged: bool = False
    family_memory: float = FREE
    untried: tuple[str, ...] = ()

    @property
    def family(self) -> Fitted:
        """The given family, evaluated as all others are."""
        fit = self.candidates[()].fit
        assert fit is not None
        return fit

    @property
    def fitted(self) -> Fitted:
        """The best structure's parameters."""
        assert self.selected.fit is not None
        return self.selected.fit

    def is_reached_by(self, fitted: Fitted) -> bool:
        """Whether a fit of the best structure, to almost the same samples, leaves no more, rms, than the best did."""
        now, then = (float(np.mean(np.concatenate(one.residuals) ** 2)) for one in (fitted, self.fitted))
        return now <= then

    def instead(self, other: Candidate, why: str = "") -> Found:
        """The same with another structure as the best; ``why`` is said of the one that was."""
        known = dict(self.candidates)
        if why:
            known[self.selected.laws] = replace(self.selected, why=why)
        return replace(self, selected=other, candidates=known | {other.laws: other})

    def share_of(self, law: str) -> float | None:
        """Part of the power that is left without one of the best's laws which that takes away; None where it never ran.

        Free runs of all recordings together, those held out too.
        """
        best, less = self.selected, self.candidates.get(key([name for name in self.selected.laws if name != law]))
        if less is None or less.fit is None:
            return None
        number = len(less.residuals)  # one that was left is known on the training recordings alone
        with_it, without = (sum(float(np.sum(r**2)) for r in one.residuals[:number]) for one in (best, less))
        return 1.0 - with_it / without if 0.0 < without < math.inf else None

"""What came of trying laws on a model: which of them the recordings ask for, and which they cannot tell apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...identify.structure import Fitted
from ...model.law import Law
from ...model.laws import find

#: A law is accepted where, its parameters paid for, it gains at least this much on the training recordings
ACCEPT_TRAIN = 5.0
#: ... and this much on the held-out ones.
ACCEPT_HOLDOUT = 3.0
#: ... and where it takes away this part of the power of what is left.
MATTERS = 0.01
#: Laws whose log-likelihoods over all recordings differ by less than this cannot be told apart.
INDISTINGUISHABLE = 5.0


@dataclass(frozen=True, eq=False)
class Trial:
    """One law put in, fitted and judged.

    Attributes:
        effect: the law's name.
        fitted: on the training recordings.
        holdout: the same parameters on the held-out ones.
        gain: of log-likelihood on the training recordings, over the model without it, its parameters paid for (half
            the difference of the Bayesian information criterion).
        holdout_gain: on the held-out ones.
        finished: whether it was fitted to the end or dropped on the way.
    """

    effect: str
    fitted: Fitted
    holdout: Fitted | None
    gain: float
    holdout_gain: float
    finished: bool

    @property
    def supported(self) -> bool:
        """Whether both kinds of recordings ask for it."""
        return self.gain > ACCEPT_TRAIN and self.holdout_gain > ACCEPT_HOLDOUT

    @property
    def score(self) -> float:
        """What it gains on all recordings together."""
        return self.gain + self.holdout_gain

    @property
    def proper(self) -> bool:
        """Whether the law, as it was fitted, is what its name stands for."""
        law = find(self.effect)
        if law.proper is None:
            return True
        values = self.fitted.model.values()
        return law.proper({p.name: values[f"{law.name}.{p.name}"] for p in law.parameters}, values)

    def matters(self, before: Fitted, before_holdout: Fitted) -> bool:
        """Whether it takes away at least a hundredth of the noise's power in some segment: a tenth of its size."""
        pairs = [*zip(before.residuals, self.fitted.residuals, strict=True)]
        if self.holdout is not None:
            pairs += zip(before_holdout.residuals, self.holdout.residuals, strict=True)
        return any(np.mean(old**2) > (1.0 + MATTERS) * np.mean(new**2) for old, new in pairs)

    def why_not(self, best: Trial | None) -> str:
        """Why this law was not taken, beside the best of its round."""
        if not self.finished:
            return f"after a few steps it gains {self.gain:.4g} in log-likelihood, too little beside the best to go on"
        if not self.supported:
            if self.gain <= ACCEPT_TRAIN:
                return "what it gains on the training recordings does not pay for its parameters"
            return (
                f"it gains {self.gain:.4g} on the training recordings and {self.holdout_gain:.4g} on the held-out ones"
            )
        if not self.proper:
            return "it fits, with values that are not what its name stands for"
        if best is None:
            return "it gains something, but less than a tenth of the noise in every recording"
        return f"{best.effect} gains {best.score - self.score:.4g} more in log-likelihood"


@dataclass(frozen=True, eq=False)
class Round:
    """The library tried on one model: trials, the best first."""

    before: Fitted
    before_holdout: Fitted
    trials: tuple[Trial, ...]

    @property
    def best(self) -> Trial | None:
        """The law to take: asked for by all recordings, and large enough to matter."""
        good = [trial for trial in self.trials if trial.supported and trial.matters(self.before, self.before_holdout)]
        good = [trial for trial in good if not self._better_called(trial, good)]
        if not good:
            return None
        top = max(trial.score for trial in good)
        return max(
            (trial for trial in good if trial.score > top - INDISTINGUISHABLE),
            key=lambda trial: (
                trial.proper,
                -len(trial.fitted.free),
                find(trial.effect).twin is not None,  # of two names for one thing the one that says more
                round(trial.score, 1),
            ),
        )

    def _better_called(self, trial: Trial, good: Sequence[Trial]) -> bool:
        """Whether a more general law, of which this is a case, suits its values better and fits as well.

        Since it can do all that the special one does, a difference on held-out recordings is chance.
        """
        general = find(trial.effect).twin
        near = trial.gain - 2 * INDISTINGUISHABLE  # a further parameter or two have been paid for
        return not trial.proper and any(t.effect == general and t.gain > near for t in good)

    def rivals(self, chosen: Trial) -> tuple[str, ...]:
        """Other effects that the recordings cannot tell from the chosen one."""
        own = find(chosen.effect).effect
        near = [t for t in self.trials if t.supported and t.proper and t.score > chosen.score - INDISTINGUISHABLE]
        return tuple(dict.fromkeys(e for t in near if (e := find(t.effect).effect) != own))


def ordered(trials: Sequence[Trial]) -> tuple[Trial, ...]:
    """Those fitted to the end first, the largest gain first."""
    return tuple(sorted(trials, key=lambda t: (-t.finished, -t.score)))


def only_a_name(law: Law) -> bool:
    """Whether a law has the parameters of its twin, all of them."""
    return law.twin is not None and len(find(law.twin).parameters) == len(law.parameters)

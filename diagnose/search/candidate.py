"""One candidate: a set of laws beside the given family, how far it was taken, and what speaks for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...identify.problem.structure import Fitted

#: How far a candidate came: never put in, simulated, on its way when it was left, fitted and judged.
Stage = Literal["not started", "simulated", "left", "judged"]

STAGES: tuple[Stage, ...] = ("not started", "simulated", "left", "judged")


@dataclass(frozen=True, eq=False)
class Candidate:
    """A structure: the given family with some laws more.

    Attributes:
        laws: names of what is added to the given family, in the order of the alphabet.
        fit: its parameters on the training recordings; None where it was never put in.
        held_out: the same parameters on the recordings held out; None where it was not judged.
        evidence: of the training recordings, log.
        predictive: log-probability of the held-out recordings, given the training ones; 0 where there are none.
        foretold: the same, and where there are none that of each stretch of the training ones, given the others.
        stage: how far it was taken.
        why: why it was taken no further; empty where it was judged.
    """

    laws: tuple[str, ...]
    fit: Fitted | None = None
    held_out: Fitted | None = None
    evidence: float = -np.inf
    predictive: float = -np.inf
    foretold: float = -np.inf
    stage: Stage = "not started"
    why: str = ""

    @property
    def value(self) -> float:
        """Log-evidence of all recordings together."""
        return self.evidence + self.predictive

    @property
    def name(self) -> str:
        """The laws in words."""
        return " + ".join(self.laws) or "the given family"

    @property
    def residuals(self) -> tuple[np.ndarray, ...]:
        """What it leaves in every stretch, training and held out."""
        return tuple(r for fitted in (self.fit, self.held_out) if fitted is not None for r in fitted.residuals)


def key(laws: Sequence[str]) -> tuple[str, ...]:
    """The structure's name: the same whatever the order in which its laws came."""
    return tuple(sorted(laws))

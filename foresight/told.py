"""What recordings tell of one parameter."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Told:
    """What recordings tell of one parameter.

    Attributes:
        name: of the parameter.
        value: near which it lies; an estimate without a fit.
        std: standard error that a fit is expected to state; None where it is given or cannot be found.
        unit: of both.
        state: "told", "poorly" (an error of more than a tenth), "not told" (indistinguishable from none), "given",
            or "rough" (Eq. 17 does not follow the recordings, and the error is no more than a guess).
        words: a sentence for what is not told.
    """

    name: str
    value: float
    std: float | None
    unit: str
    state: str
    words: str = ""

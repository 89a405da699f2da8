"""Where a search is, and where it ended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..signals.registry import numerics

SHOWN = numerics(2, "states", why="the mass's displacement and velocity, which a sensor shows; the others are inner")


@dataclass(frozen=True, eq=False)
class State:
    """A point of the search.

    Attributes:
        values: (parameters,), shared by all segments.
        initial: (segments, states) initial states as ``Core.begin`` takes them.
        offsets: (offsets,) of the sensors, in the order of ``OutputError.offsets``.
    """

    values: np.ndarray
    initial: np.ndarray
    offsets: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def stepped(self, free: Sequence[int], shared: np.ndarray, own: np.ndarray, squared: int | None = None) -> State:
        """The point after a step of the free parameters and the offsets, ``shared``, and of the initial states.

        Args:
            free: places of the parameters that are free.
            shared, own: the step.
            squared: place of the natural frequency, where its part of the step is one of its square. As that, a
                stiffness, it stands in the equation: where another law takes over the spring the response is straight
                in it, and a step of the frequency itself has the stiffness off by its own square, so that the motion
                loses its phase.
        """
        values = self.values.copy()
        values[list(free)] += shared[: len(free)]
        if squared in free:
            before, after = self.values[squared], values[squared]
            square = before * (2.0 * after - before)
            values[squared] = np.sqrt(square) if square > 0 else after
        return State(values, self.initial + own, self.offsets + shared[len(free) :])


@dataclass(frozen=True, eq=False)
class Outcome:
    """Where the search ended.

    Attributes:
        state: best point.
        cost: negative log-likelihood, but for what does not depend on the parameters.
        information: (k, k) information matrix of the free parameters, all else eliminated.
        residuals: measured minus response, one (n,) array a segment.
        iterations: steps taken.
        converged: whether the search came to rest rather than to its limit of steps.
    """

    state: State
    cost: float
    information: np.ndarray
    residuals: tuple[np.ndarray, ...]
    iterations: int
    converged: bool

"""What chance makes of a perfect model: other recordings of the same, drawn and simulated.

Each draw has sensor noise and force noise of the recording's own levels, and parameters from the model's own covariance
(the parametric bootstrap: Efron and Tibshirani 1993, section 6.5). How much they leave, and how far their backbones lie
apart, is what a recording may do without any fault of the model.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..identify.problem.replay import Replay
from ..identify.signals.odds import BY_CHANCE
from .model_inside import Twin
from .noise_floor import Piece


@dataclass(frozen=True, eq=False)
class Run:
    """A piece, the FMU along it, and what answers in its place to other forces and parameters."""

    piece: Piece
    replay: Replay
    twin: Twin

    def draws(self, count: int, place: int, *, own: bool) -> Iterator[np.ndarray]:
        """(n,) what each of ``count`` other recordings would show; ``place`` of the piece seeds its noise.

        ``own`` says whether the parameters are drawn too: the same in all pieces of a draw.
        """
        twin, piece = self.twin, self.piece
        moved = self.replay.response - self.replay.shown(piece.recording.dt)
        root = root_of(twin.covariance)
        for draw in range(count):
            values = twin.values
            if own:
                values = values + root @ np.random.default_rng([1, draw]).standard_normal(len(root))
            random = np.random.default_rng([2, place, draw])
            response = self.replay.response
            if np.any(piece.force) or (own and not twin.exact):
                force = piece.disturbed(random)
                force = force if force is None else force.shifted(-self.replay.load)
                response = response + twin.respond(force, values) - moved
            yield response + piece.sensor * random.standard_normal(response.size)


def root_of(covariance: np.ndarray) -> np.ndarray:
    """(k, k) whose product with its own transpose is the covariance, in the scale of each parameter."""
    size = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))


def powers(runs: Sequence[Run], count: int, *, own: bool) -> np.ndarray:
    """(draws,) mean square that each draw leaves in all pieces together; those that do not simulate are left out."""
    total = sum(run.piece.recording.n for run in runs)
    left = np.zeros(count)
    for place, run in enumerate(runs):
        drawn = run.draws(count, place, own=own)
        left += [float(np.sum((response - run.replay.response) ** 2)) / total for response in drawn]
    return left[np.isfinite(left)]


def usual(drawn: np.ndarray) -> float:
    """Rms that chance leaves mostly, from mean squares (draws,).

    The middle and not the mean: a draw may end in another motion, as where friction pushes.
    """
    return float(np.sqrt(np.median(drawn)))


def by_chance(drawn: np.ndarray) -> float:
    """Mean square that chance exceeds once in a thousand, from those (draws,) of some draws.

    A sum of squares of which few are independent: chi² with the degrees of freedom that their scatter
    shows (Satterthwaite 1946).
    """
    from scipy.special import chdtri

    mean, variance = float(np.mean(drawn)), float(np.var(drawn, ddof=1))
    if not variance > 0:
        return mean
    freedom = 2.0 * mean**2 / variance
    return mean * float(chdtri(freedom, BY_CHANCE)) / freedom

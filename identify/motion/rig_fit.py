"""Eq. 17 fitted to one piece of a recording: its rig, an initial state, and what the sensor shows at rest.

A search by Levenberg and Marquardt with the derivatives that the engine carries along. What is known beforehand of the
rig, from other pieces of the same recording, is a normal distribution beside the likelihood.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from ...model import Oscillator
from ...simulate.core import Core, core_of
from ...simulate.sides import Sides
from ..signals.odds import ABOVE_NOISE, BEYOND_ERRORS, BY_CHANCE, SIGNIFICANT
from ..signals.registry import budget, numerics
from .hand import hand_leaves, to_state

NAMES: tuple[str, ...] = ("omega0", "cubic", "preload", "viscous", "dry")
OWN, ALL = numerics((4, 9), "unknowns", why="displacement, velocity, constant and drift; with the rig's")
_STEPS, _LESS = budget((12, 1e-3), "steps, of the sum of squares", why="of a search, and below which it has converged")
_DAMPED, _STUCK = numerics((1e-3, 1e6), "of the diagonal", why="Marquardt's damping at first, and at most")
_LARGEST = numerics(1.0, "of the spring's force", why="standard deviation of each member before anything is known")
_DRIFTS = numerics(0.1, "of the motion", why="over the recording; standard deviation of what a sensor drifts by")
_FREE = numerics(100.0, "of the motion", why="standard deviation of an initial state, which nothing limits")
_STEP = numerics(0.2, "rad", why="longest internal step; the engine's error is far below any noise then")
LEAST_SAMPLES = numerics(12, "samples", why="of a piece; a rig and its state are nine unknowns")
LEAST_NOISE = numerics(1e-9, "of the motion", why="rounding")
_WITHIN = numerics((0.05, 20.0), "times what a window shows", why="what is beyond is another motion")
_LOW = np.full(ALL, -_WITHIN[1])
_LOW[[0, 2, 3, 4]] = _WITHIN[0], 0.0, 0.0, 0.0  # a rig gives no energy
_HIGH = np.full(ALL, _WITHIN[1])


@dataclass(frozen=True, eq=False)
class Rig:
    """Parameters (5,) in units of the motion's size and pace, with their covariance (5, 5)."""

    values: np.ndarray
    covariance: np.ndarray


@dataclass(frozen=True, eq=False)
class Piece:
    """From sample a to b: the rig and own unknowns (4,) at a, the covariance of all, what is left over the noise.

    ``turns``: sum of squares of what neighbours of what is left differ by, over its own; about two where it is white.
    ``told``: how many of the unknowns the piece tells, the others being as before it was looked at.
    """

    a: int
    b: int
    values: np.ndarray
    covariance: np.ndarray
    left: float
    spread: float
    turns: float
    told: float

    @property
    def rig(self) -> Rig:
        """What the piece says of the rig."""
        return Rig(self.values[:5], self.covariance[:5, :5])


@cache
def _core() -> Core:
    return core_of(Oscillator.from_values(dict.fromkeys(NAMES, 0.0) | {"omega0": 1.0}), carried=True)


@dataclass(frozen=True, eq=False)
class Record:
    """Samples (n,) in units of their size, radians a sample, noise in the same unit, samples of the recording each."""

    x: np.ndarray
    pace: float
    noise: float
    thin: int
    quantity: str
    backwards: bool = False

    @property
    def reversed(self) -> Record:
        """The same with time reversed."""
        sign = -1.0 if self.quantity == "velocity" else 1.0
        return replace(self, x=sign * self.x[::-1], backwards=not self.backwards)

    def spread(self, a: int, b: int, share: float) -> float:
        """Standard deviation of what a fit may leave of the samples from a to b, that part of the motion among it."""
        return float(np.hypot(self.noise, share * np.std(self.x[a:b])))

    def made(self, values: np.ndarray, n: int, shown: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m,) residuals of the samples ``shown`` from a piece's first on, and (9, n) derivatives of its response."""
        core, sides = _core(), Sides()
        sign = -1.0 if self.backwards else 1.0
        p = dict(zip(NAMES, values[:5] * [1, 1, 1, sign, sign], strict=True))
        order = np.array([p[name] for name in core.parameter_names])
        count = len(core.parameter_names)
        by = [core.unknowns.index(name) for name in NAMES] + [count, count + 1]
        y, rows = core.record_with_derivatives(
            order,
            values[5:7],
            None,
            n,
            self.pace,
            _STEP,
            by=by,
            quantity=self.quantity,
            sides=sides if self.quantity == "acceleration" else None,
        )
        rows[3:5] *= sign
        rows[:, audible(y, self.noise) :] = 0.0  # what stops a mass within its noise moves nothing that is seen
        time = np.arange(n) / self.x.size
        rows = np.vstack([rows, np.ones(n), time])
        zero = values[7] + values[8] * time
        left = shown - y[: shown.size] - zero[: shown.size]
        for at, other in zip(sides.at.tolist(), sides.shown.tolist(), strict=True):
            if at < shown.size and abs(shown[at] - other - zero[at]) < abs(left[at]) > BEYOND_ERRORS * self.noise:
                left[at] = shown[at] - other - zero[at]
        return left, rows


def audible(response: np.ndarray, noise: float) -> int:
    """The sample from which on a response (n,) stays within its noise."""
    loud = np.flatnonzero(~(np.abs(response) < noise))
    return int(loud[-1]) + 1 if loud.size else 0


def prior(start: np.ndarray, rig: Rig | None) -> tuple[np.ndarray, np.ndarray]:
    """Middle (9,) and information (9, 9) before a piece is looked at."""
    middle, known = np.zeros(ALL), np.zeros((ALL, ALL))
    known[np.arange(5, ALL), np.arange(5, ALL)] = [_FREE**-2, _FREE**-2, 1.0, 1.0 / _DRIFTS**2]
    if rig is None:
        middle[0] = start[0]
        known[np.arange(5), np.arange(5)] = 1.0 / _LARGEST**2
    else:
        middle[:5] = rig.values
        known[:5, :5] = np.linalg.pinv(rig.covariance, hermitian=True)
    return middle, known


def fit_piece(record: Record, a: int, b: int, start: np.ndarray, share: float, rig: Rig | None = None) -> Piece | None:
    """Eq. 17 fitted to the samples from a to b from (9,) values, its rig known or not; None where it fails."""
    if b - a < LEAST_SAMPLES:
        return None
    shown, spread = record.x[a:b], record.spread(a, b, share)
    n = b - a
    middle, known = prior(start, rig)

    def cost(at: np.ndarray, left: np.ndarray) -> float:
        off = at - middle
        value = float(left @ left) / spread**2 + float(off @ known @ off)
        return value if np.isfinite(value) else np.inf

    at = np.clip(start, _LOW, _HIGH)
    left, rows = record.made(at, n, shown)
    now, damping = cost(at, left), _DAMPED
    if not np.isfinite(now) or not np.all(np.isfinite(rows)):
        return None
    for _ in range(_STEPS):
        normal = rows @ rows.T / spread**2 + known
        gradient = rows @ left / spread**2 + known @ (middle - at)
        held = ((at <= _LOW) & (gradient < 0)) | ((at >= _HIGH) & (gradient > 0))
        free = np.flatnonzero(~held)
        scale = np.sqrt(np.diag(normal))[free]
        raised = normal[np.ix_(free, free)] / np.outer(scale, scale)
        done = False
        while damping < _STUCK:
            step = np.zeros(ALL)
            step[free] = np.linalg.solve(raised + damping * np.eye(free.size), gradient[free] / scale) / scale
            tried = np.clip(at + step, _LOW, _HIGH)
            new = record.made(tried, n, shown)
            then = cost(tried, new[0])
            if then < now and np.all(np.isfinite(new[1])):
                done = now - then < _LESS * now
                at, now, damping = tried, then, damping / 10
                left, rows = new
                break
            damping *= 10
        else:
            break
        if done:
            break
    normal = rows @ rows.T / spread**2 + known
    scale = np.sqrt(np.diag(normal))
    covariance = np.linalg.pinv(normal / np.outer(scale, scale), hermitian=True) / np.outer(scale, scale)
    rest = float(left @ left) / spread**2
    turns = float(np.sum(np.diff(left) ** 2) / max(float(left @ left), np.finfo(float).tiny))
    return Piece(a, b, at, covariance, rest, spread, turns, ALL - float(np.sum(known * covariance)))


def is_white(piece: Piece) -> bool:
    """Whether what a piece leaves may be white, as a clock's jitter and a converter's steps are and a mode is not.

    By the ratio of von Neumann (1941), which is 2 ± 2/sqrt(n).
    """
    return piece.turns > 2.0 / ABOVE_NOISE**2 - SIGNIFICANT * 2.0 / np.sqrt(piece.b - piece.a)


def odds_of(record: Record, piece: Piece) -> float:
    """Logarithm of the odds that a rig made a piece and not a hand: what the piece tells of either has its price."""
    shown = record.x[piece.a : piece.b] / piece.spread
    return 0.5 * (hand_leaves(shown) - piece.left - piece.told * to_state(shown))


def holds(piece: Piece | None) -> bool:
    """Whether a fit leaves no more than it may."""
    from scipy.special import chdtri

    if piece is None:
        return False
    n = piece.b - piece.a
    return piece.left < float(chdtri(max(n - OWN, 1), BY_CHANCE / n)) * ABOVE_NOISE**2


def measured(record: Record, piece: Piece, share: float) -> tuple[Record, float]:
    """The record with the noise that a piece leaves, where that is less, and the part of the motion beside it.

    Of few samples a cycle the highest frequencies tell the noise too large.
    """
    free = piece.b - piece.a - ALL
    if free < 1:
        return record, share
    level = float(np.sqrt(piece.left / free)) * piece.spread * (1 + SIGNIFICANT / np.sqrt(2 * free))
    share = min(share, level / float(np.std(record.x[piece.a : piece.b])))
    return replace(record, noise=max(min(record.noise, level), LEAST_NOISE)), share


def state_after(record: Record, values: np.ndarray, n: int) -> np.ndarray | None:
    """Displacement and velocity (2,) n samples later."""
    core = _core()
    sign = -1.0 if record.backwards else 1.0
    p = dict(zip(NAMES, values[:5] * [1, 1, 1, sign, sign], strict=True))
    order = np.array([p[name] for name in core.parameter_names])
    z = core.record(order, values[5:7], None, n + 1, record.pace, _STEP, states=True)[-1]
    return z if np.all(np.isfinite(z)) else None

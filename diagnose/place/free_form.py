"""Which coordinate the missing force follows: displacement, velocity, the recorded force, time, or none.

The family's own terms are taken off the missing force first, because a fit bends them around what is missing. What
each kind of coordinate then explains, in terms as free as the recordings allow, is a symptom and no law.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...identify.signals.registry import numerics
from ...simulate.recursion import recursion
from .equation_error import Stretch

TURNING = numerics(
    0.1,
    "of the usual rate",
    why="over which a force turns from one direction to the other, so that noise does not turn it",
)
_SIGN = numerics(0.05, "of the size", why="over which a sign goes from -1 to 1, so that it has a slope")

_PIECES = numerics(
    20,
    "pieces over the range of a coordinate",
    why="finer than any law of the library bends; a penalty on roughness decides how many are used",
)
_FORCE_PIECES = numerics(
    10,
    "pieces over the range of the force",
    why="as the pieces of a coordinate; a characteristic of an actuator is smoother",
)
_REACHES = numerics(
    (0.02, 0.06, 0.18, 0.5),
    "parts of the largest displacement",
    why="where sliders give way: a grid that is even in the logarithm",
)
_PACES = numerics(
    (0.2, 1.0, 5.0), "times the rate of the motion", why="at which dampers relax: a grid that is even in the logarithm"
)


@dataclass(frozen=True, eq=False)
class Rows:
    """All stretches in one regression, each weighted by its noise.

    Attributes:
        stretches: what the rows come from.
        weight: (n,).
        target, noise: (n,) weighted missing force and its noise.
        base: (n, k) weighted columns of the family itself.
        block: (n,) number of the block.
        left: (n,) target less what the family's own terms tell of it.
        silent: (n,) the same of the noise.
    """

    stretches: tuple[Stretch, ...]
    weight: np.ndarray
    target: np.ndarray
    noise: np.ndarray
    base: np.ndarray
    block: np.ndarray
    left: np.ndarray
    silent: np.ndarray

    def part(self, values: np.ndarray, index: int) -> np.ndarray:
        """The rows of one stretch."""
        edges = np.cumsum([0, *(s.n for s in self.stretches)])
        return values[edges[index] : edges[index + 1]]

    def joined(self, take: Callable[[Stretch], np.ndarray]) -> np.ndarray:
        """(n,) or (n, m) values of all stretches."""
        return np.concatenate([take(s) for s in self.stretches])


def rows_of(stretches: Sequence[Stretch]) -> Rows:
    """The regression's rows, the family's own terms solved for."""
    weight = np.concatenate([np.full(s.n, 1.0 / max(float(np.std(s.noise)), 1e-300)) for s in stretches])
    base = np.concatenate([family(s) for s in stretches]) * weight[:, None]
    target = np.concatenate([s.missing for s in stretches]) * weight
    noise = np.concatenate([s.noise for s in stretches]) * weight
    blocks, first = [], 0
    for s in stretches:
        _, number = np.unique(s.block, return_inverse=True)
        blocks.append(number + first)
        first += int(number.max()) + 1
    left = target - base @ solve(base, target)
    silent = noise - base @ solve(base, noise)
    return Rows(tuple(stretches), weight, target, noise, base, np.concatenate(blocks), left, silent)


def family(s: Stretch) -> np.ndarray:
    """(n, 6) what the family can bend: Eq. 17 per unit mass, and the mass."""
    return np.column_stack([s.x, s.x**3, _soft_sign(s.x), s.v, _soft_sign(s.v), s.drive])


def _soft_sign(y: np.ndarray) -> np.ndarray:
    """(n,) sign of y, linear within ``_SIGN`` of its standard deviation."""
    return np.clip(y / (_SIGN * max(float(np.std(y)), 1e-300)), -1.0, 1.0)


def hats(values: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """(n, nodes) piecewise linear functions, one at each node, that sum to one."""
    place = np.clip(np.searchsorted(nodes, values) - 1, 0, nodes.size - 2)
    part = np.clip((values - nodes[place]) / (nodes[place + 1] - nodes[place]), 0.0, 1.0)
    basis = np.zeros((values.size, nodes.size))
    basis[np.arange(values.size), place] = 1.0 - part
    basis[np.arange(values.size), place + 1] = part
    return basis


def nodes_of(values: np.ndarray, pieces: int = _PIECES) -> np.ndarray:
    """(pieces + 1,) equally far apart over all values."""
    low, high = float(np.min(values)), float(np.max(values))
    return np.linspace(low, high if high > low else low + 1.0, pieces + 1)


def solve(columns: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Least squares by the normal equations in the columns' own scale; what the rows do not carry is zero."""
    size = np.linalg.norm(columns, axis=0)
    size = np.where(size > 0, size, 1.0)
    normal = (columns.T @ columns) / np.outer(size, size)
    return np.linalg.lstsq(normal, (columns.T @ target) / size, rcond=1e-9)[0] / size


#: What the missing force may follow: free functions of one coordinate, or one column for each bend of a path.
KINDS: dict[str, Callable[[Rows], np.ndarray]] = {}


def _kind(name: str) -> Callable[[Callable[[Rows], np.ndarray]], Callable[[Rows], np.ndarray]]:
    def put(function: Callable[[Rows], np.ndarray]) -> Callable[[Rows], np.ndarray]:
        KINDS[name] = function
        return function

    return put


@_kind("displacement")
def _displacement(rows: Rows) -> np.ndarray:
    x = rows.joined(lambda s: s.x)
    return hats(x, nodes_of(x))


@_kind("velocity")
def _velocity(rows: Rows) -> np.ndarray:
    v = rows.joined(lambda s: s.v)
    return hats(v, nodes_of(v))


@_kind("damping by position")
def _damping(rows: Rows) -> np.ndarray:
    x, v = rows.joined(lambda s: s.x), rows.joined(lambda s: s.v)
    return hats(x, nodes_of(x, _FORCE_PIECES)) * v[:, None]


@_kind("displacement and velocity")
def _both(rows: Rows) -> np.ndarray:
    return np.hstack([_displacement(rows), _velocity(rows), _damping(rows)])


@_kind("force")
def _force(rows: Rows) -> np.ndarray:
    """The force through an actuator that bends, lags, has mass, or holds on when it turns."""
    driven = rows.joined(lambda s: np.full(s.n, s.driven))
    force = rows.joined(lambda s: s.drive)
    if not np.any(driven):
        return _nothing(rows)
    rate = rows.joined(lambda s: s.drive_rate)
    bend = rows.joined(lambda s: s.drive_bend)
    turning = np.clip(rate / max(TURNING * float(np.std(rate)), 1e-300), -1.0, 1.0)
    columns = [hats(force, nodes_of(force, _FORCE_PIECES)), rate, bend, turning]
    return np.column_stack(columns) * driven[:, None]


@_kind("delay")
def _delay(rows: Rows) -> np.ndarray:
    return rows.joined(lambda s: s.drive_rate)[:, None] if any(s.driven for s in rows.stretches) else _nothing(rows)


@_kind("constant")
def _constant(rows: Rows) -> np.ndarray:
    return np.ones((rows.target.size, 1))


@_kind("memory")
def _memory(rows: Rows) -> np.ndarray:
    """Springs behind a slider (Iwan 1966) and behind a damper (Maxwell), of several reaches and times."""
    size = 0.5 * float(np.ptp(rows.joined(lambda s: s.x)))
    columns = []
    for s in rows.stretches:
        own = [_slider(s.x, size * reach) for reach in _REACHES]
        turn = float(np.sqrt(np.mean(s.v**2) / max(float(np.mean(s.x**2)), 1e-300)))  # rad/s
        step = float(np.median(np.diff(s.time)))
        for pace in _PACES:  # the part of x that is faster than the relaxation
            pole = np.exp(-step * turn * pace)
            own.append(recursion(np.array([[pole]]), np.diff(s.x, prepend=s.x[0])[:, None]))
        columns.append(np.column_stack(own))
    return np.concatenate(columns)


def _slider(x: np.ndarray, reach: float) -> np.ndarray:
    """(n,) stretch of a spring whose far end slides when it is stretched beyond ``reach``."""
    extension = np.empty_like(x)
    stretch, last = 0.0, float(x[0])
    for i, here in enumerate(x.tolist()):
        stretch = min(max(stretch + here - last, -reach), reach)
        extension[i], last = stretch, here
    return extension


@_kind("sensor")
def _sensor(rows: Rows) -> np.ndarray:
    """What a sensor that bends, y = x + e(x), leaves in the equation of a linear oscillator: e'' + omega0² e."""
    columns = []
    for s in rows.stretches:
        omega2 = -float(s.x @ s.a) / max(float(s.x @ s.x), 1e-300)
        columns.append(
            np.column_stack(
                [
                    2 * s.v**2 + 2 * s.x * s.a + omega2 * s.x**2,
                    6 * s.x * s.v**2 + 3 * s.x**2 * s.a + omega2 * s.x**3,
                ]
            )
        )
    return np.concatenate(columns)


@_kind("time")
def _time(rows: Rows) -> np.ndarray:
    longest = max(float(np.ptp(s.time)) for s in rows.stretches)
    columns = []
    for s in rows.stretches:
        t = s.time / max(longest, 1e-300)
        columns.append(np.column_stack([s.x * t, s.x * t**2, s.v * t]))
    return np.concatenate(columns)


def _nothing(rows: Rows) -> np.ndarray:
    return np.zeros((rows.target.size, 0))


def shares(rows: Rows) -> dict[str, float]:
    """For each kind the share (at most 1) of the excess that it explains, less what as many idle columns would.

    Idle columns explain one part in the number of independent samples each; a block counts as one for each column.
    """
    total = float(rows.left @ rows.left)
    excess = max(total - float(rows.silent @ rows.silent), 1e-300)
    fractions = {}
    for name, make in KINDS.items():
        columns = make(rows) * rows.weight[:, None]
        if not columns.shape[1]:
            continue
        gain = explained(rows, columns)
        fractions[name] = min((gain - idle(rows, columns.shape[1])) / excess, 1.0)
    return fractions


def explained(rows: Rows, columns: np.ndarray) -> float:
    """Power that weighted columns explain beyond the family's own terms."""
    whole = np.hstack([rows.base, columns])
    left = rows.target - whole @ solve(whole, rows.target)
    return float(rows.left @ rows.left - left @ left)


def idle(rows: Rows, columns: int) -> float:
    """Power that so many columns would explain by chance: as independent samples count two in each cycle of a block."""
    independent = 8.0 * (float(rows.block.max()) + 1.0)
    return columns * float(rows.left @ rows.left) / max(independent, 1.0)

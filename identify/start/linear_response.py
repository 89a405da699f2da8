"""What linear modes of given frequencies and dampings leave of segments, and how that changes with these.

    x'' + viscous x' + omega0² x = F / m of each mode, and what the sensor shows at zero

The motion from rest and the free motion are known in closed form for a force in straight lines between its samples. So
the answers to the force, and each segment's beginning, zero and drift, follow from linear least squares at each
frequency and damping (variable projection: Golub and Pereyra 1973, with the Jacobian of Kaufman 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...simulate.recursion import powers, recursion
from ..problem.segments import Segment
from ..signals.registry import numerics
from .limits import MOST_DAMPING

SAMPLES_A_CYCLE = numerics(32.0, "samples a cycle", why="by which a sine is told")
_MOVED = numerics(1e-4, "of a pole", why="of a difference quotient, whose error is the square of it")


class Signal:
    """One segment: its response in units of its standard deviation, its force as finely as a sine needs."""

    def __init__(self, segment: Segment, samples_a_cycle: float = SAMPLES_A_CYCLE, *, by_means: bool = False) -> None:
        self.order, self.dt = segment.order, segment.dt
        cycle = 2 * np.pi / (segment.pace * segment.dt)
        self.skipped = max(1, int(cycle / SAMPLES_A_CYCLE))
        self.stride = self.skipped * max(1, int(cycle / (self.skipped * samples_a_cycle)))
        self.scale = float(np.std(segment.response)) or 1.0
        shown = segment.response[:: self.stride] / self.scale
        if by_means and segment.force is None:  # of damped sines means are damped sines, with less noise
            whole = segment.response[: segment.n // self.stride * self.stride]
            shown = np.mean(whole.reshape(-1, self.stride), axis=1) / self.scale
        self.size = shown.size
        self.unit = self.scale * np.sqrt(self.size)
        self.measured = shown / np.sqrt(self.size)  # every segment counts alike
        self.time = segment.dt * self.stride * np.arange(self.size)
        self.force: np.ndarray | None = None
        if segment.force is not None:
            pieces, fine = segment.force.pieces, segment.force.fine
            end = pieces[-1] @ (segment.dt / fine) ** np.arange(4)
            force, self.held = np.append(pieces[:, 0], end), segment.force.hold == "zero"
            enough = SAMPLES_A_CYCLE / cycle  # points a sample
            points = next(k for k in range(1, fine + 1) if fine % k == 0 and (k >= enough or k == fine))
            force = force[: segment.n * fine][:: fine // points]
            if self.skipped > 1 and self.held:  # held for the mean of what was skipped
                force = np.append(force, np.full(-force.size % self.skipped, force[-1]))
                force = np.mean(force.reshape(-1, self.skipped), axis=1)
            elif self.skipped > 1:
                force = force[:: self.skipped]
            self.step = segment.dt * self.skipped / points
            self.every = self.stride // self.skipped * points
            self.force = np.append(force, np.zeros(max((self.size - 1) * self.every + 1 - force.size, 0)))

    def waves(self, poles: np.ndarray) -> np.ndarray:
        """(size, K) one as it rings with each pole (K,) in 1/s, in units of the response."""
        return powers(poles * (self.dt * self.stride), self.size) / self.unit

    def driven(self, pole: complex) -> np.ndarray:
        """(size,) response from rest of a mass of one, in the same units."""
        assert self.force is not None
        response = np.imag(pole**self.order * self._moved(pole)) / pole.imag
        if self.order == 2:
            response += self.force[: (self.size - 1) * self.every + 1 : self.every]
        return response / self.unit

    def driven_slopes(self, pole: complex, moves: np.ndarray) -> np.ndarray:
        """(size, 2) derivatives of that where the pole moves by each of these (2,)."""
        moved, h = self._moved(pole), _MOVED * abs(pole)
        pushes = (self._pushes(pole + h) - self._pushes(pole - h)) / (2 * h)
        turned = self.every * self.step * np.exp(pole * self.step * self.every) * moved[:-1]
        change = pole**self.order * self._from_rest(pole, self._pushed(pushes) + turned)
        change += self.order * pole ** (self.order - 1) * moved
        still = np.imag(pole**self.order * moved) / pole.imag
        return (np.imag(change[:, None] * moves) - still[:, None] * np.imag(moves)) / pole.imag / self.unit

    def _moved(self, pole: complex) -> np.ndarray:
        return self._from_rest(pole, self._pushed(self._pushes(pole)))

    def _from_rest(self, pole: complex, pushes: np.ndarray) -> np.ndarray:
        """(size,) one complex state, that what is pushed from sample to sample (size - 1,) moves."""
        turn = np.exp(pole * self.step * self.every)
        return np.append(0.0, recursion(np.array([[turn]]), pushes[:, None]))

    def _pushes(self, pole: complex) -> np.ndarray:
        """(every + 1,) what each point of the force from one sample to the next leaves at the end."""
        turn = np.exp(pole * self.step)
        whole = (turn - 1.0) / pole
        last = 0.0 if self.held else (whole / self.step - 1.0) / pole  # straight lines: the sample at the end's part
        turns = np.append(turn ** np.arange(self.every)[::-1], 0.0)
        return (whole - last) * turns + last * np.append(0.0, turns[:-1])

    def _pushed(self, pushes: np.ndarray) -> np.ndarray:
        """(size - 1,) what the force leaves at the end of each step, all its points in between at once."""
        assert self.force is not None
        end = (self.size - 1) * self.every
        within = self.force[:end].reshape(-1, self.every) @ pushes[:-1].view(float).reshape(-1, 2)
        return within.view(complex)[:, 0] + pushes[-1] * self.force[self.every : end + 1 : self.every]


@dataclass(frozen=True, eq=False)
class LinearResponse:
    """What modes leave of signals.

    Attributes:
        signals: what was measured.
        theta: (2 K,) logarithms of frequency of ringing, rad/s, and of rate of fall, 1/s, mode by mode.
        poles: (K,) of the modes.
        gains: (K,) answers to the force.
        own: of each signal phases of each mode, zero, and drift where it is asked for.
        rests: (size,) what is left of each signal.
    """

    signals: Sequence[Signal]
    theta: np.ndarray
    poles: np.ndarray
    gains: np.ndarray
    own: list[np.ndarray]
    rests: list[np.ndarray]
    _waves: list[np.ndarray] = field(repr=False)
    _bases: list[np.ndarray] = field(repr=False)
    _forced: list[np.ndarray] = field(repr=False)
    _normal: np.ndarray = field(repr=False)

    @property
    def cost(self) -> float:
        """Sum of squares of what is left."""
        return sum(float(rest @ rest) for rest in self.rests)

    def jacobian(self) -> np.ndarray:
        """(samples, 2 K) derivatives of all that is left by ``theta``, the linear unknowns free."""
        count = self.poles.size
        moves = np.zeros((count, 2), complex)  # of each pole by the logarithms
        moves[:, 0], moves[:, 1] = 1j * np.imag(self.poles), np.real(self.poles)
        capped = np.exp(self.theta[1::2]) > -np.real(self.poles)
        moves[capped] = np.column_stack([self.poles, 0.0 * self.poles])[capped]
        changes, seen = [], np.zeros((count, 2 * count))
        for signal, waves, basis, forced, own in zip(
            self.signals, self._waves, self._bases, self._forced, self.own, strict=True
        ):
            weights = own[0 : 2 * count : 2] - 1j * own[1 : 2 * count : 2]
            moving = (signal.time[:, None] * waves * weights)[:, :, None] * moves
            change = np.real(moving).reshape(signal.size, 2 * count)
            if signal.force is not None:
                for k, pole in enumerate(self.poles.tolist()):
                    change[:, 2 * k : 2 * k + 2] += self.gains[k] * signal.driven_slopes(pole, moves[k])
            change -= basis @ (basis.T @ change)
            changes.append(change)
            seen += forced.T @ change
        shared = self._normal @ seen
        return -np.concatenate([c - f @ shared for c, f in zip(changes, self._forced, strict=True)])


def linear_response(signals: Sequence[Signal], theta: np.ndarray, *, drifts: bool = False) -> LinearResponse:
    """What linear modes at ``theta`` (2 K,) leave of signals, the rest by least squares.

    ``drifts``: whether a sensor may drift, which else is taken for a slow mode.
    """
    pairs = np.exp(theta).reshape(-1, 2)
    rates = np.minimum(pairs[:, 1], pairs[:, 0] * MOST_DAMPING / np.sqrt(1.0 - MOST_DAMPING**2))
    poles, count = -rates + 1j * pairs[:, 0], len(pairs)
    normal, right = np.zeros((count, count)), np.zeros(count)
    waves, factors, driven, forced = [], [], [], []
    for signal in signals:
        waves.append(signal.waves(poles))
        columns = np.empty((signal.size, 2 * count + 1 + drifts))
        columns[:, : 2 * count] = waves[-1].view(float)
        columns[:, 2 * count] = 1.0 / signal.unit
        if drifts:
            columns[:, -1] = np.linspace(-1.0, 1.0, signal.size)
        size = sizes_of(columns)
        basis, triangle = np.linalg.qr(columns / size)
        factors.append((columns, basis, triangle, size))
        rest = signal.measured - basis @ (basis.T @ signal.measured)
        made = np.zeros((signal.size, 0))
        if signal.force is not None:
            made = np.column_stack([signal.driven(pole) for pole in poles.tolist()])
        driven.append(made)
        part = made - basis @ (basis.T @ made) if made.size else np.zeros((signal.size, count))
        forced.append(part)
        normal, right = normal + part.T @ part, right + part.T @ rest
    size = np.sqrt(np.maximum(np.diag(normal), np.finfo(float).tiny))
    inverse = np.linalg.pinv(normal / np.outer(size, size), rcond=1e-12, hermitian=True) / np.outer(size, size)
    gains = inverse @ right
    own, rests = [], []
    for signal, made, (columns, basis, triangle, size) in zip(signals, driven, factors, strict=True):
        measured = signal.measured - made @ gains if made.size else signal.measured
        own.append(np.linalg.lstsq(triangle, basis.T @ measured, rcond=1e-12)[0] / size)
        rests.append(measured - columns @ own[-1])  # not by the basis: of what is over at once no column is left
    bases = [basis for _, basis, _, _ in factors]
    return LinearResponse(signals, theta, poles, gains, own, rests, waves, bases, forced, inverse)


def followed(
    signals: Sequence[Signal],
    theta: np.ndarray,
    bounds: tuple[np.ndarray | float, np.ndarray | float],
    steps: int,
    *,
    drifts: bool = False,
) -> LinearResponse:
    """The modes that leave least near ``theta``, which lies within bounds."""
    from scipy.optimize import least_squares

    last = linear_response(signals, theta, drifts=drifts)

    def at(theta: np.ndarray) -> LinearResponse:
        nonlocal last
        if not np.array_equal(last.theta, theta):
            last = linear_response(signals, theta.copy(), drifts=drifts)
        return last

    slopes: Any = lambda theta: at(theta).jacobian()  # noqa: E731 - whose type SciPy guesses from its default
    outcome = least_squares(
        lambda theta: np.concatenate(at(theta).rests),
        theta,
        jac=slopes,
        bounds=bounds,
        max_nfev=steps,
    )
    return at(outcome.x)


def sizes_of(columns: np.ndarray) -> np.ndarray:
    """(k,) norms of columns; above zero also where a fall within one sample leaves nothing of a sine."""
    return np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)

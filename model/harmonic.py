"""The force of laws with a memory in a prescribed harmonic motion: its fundamental, once the memory is periodic.

With ``x = A cos(phi)``, ``phi = omega t`` the inner states follow ``dq/dphi = rate(q, x, v) / omega``. Runge and
Kutta's formula of order four takes them around a cycle, together with the two integrals of the describing function;
Newton's method on the states after a cycle finds the periodic ones, for all amplitudes at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .equations import Equations, equations, signed
from .law import Scales

if TYPE_CHECKING:
    from .oscillator import Oscillator

#: Steps of a cycle: at least so many, so many per radian of the fastest inner motion, and never more than the last.
_STEPS, _STEPS_PER_RATE, _MOST_STEPS = 128, 1.5, 16384
_SETTLING = 2
_NEWTON = 25
#: Change of the inner states over a cycle, relative to their size, that counts as none.
_PERIODIC = 1e-9
_DIFFERENCE = 1e-5


@dataclass(frozen=True, eq=False)
class Fundamental:
    """Equivalent stiffness (n,), rad²/s², and damping (n,), 1/s; NaN where the memory does not become periodic."""

    stiffness: np.ndarray
    damping: np.ndarray


class Memory:
    """The laws with a memory of one oscillator, alone: their forces do not depend on the other laws."""

    def __init__(self, oscillator: Oscillator) -> None:
        """``oscillator`` has further terms with inner states only; of Eq. 17 nothing is taken."""
        import casadi as ca

        eq = equations(oscillator)
        self._eq = eq
        values = oscillator.values()
        base = {name for name in values if "." not in name}
        p = ca.DM([0.0 if name in base else values[name] for name in eq.parameter_names])
        mass = [1.0 if name == "mass" else 0.0 for name in eq.parameter_names]
        known = ca.vertcat(eq.t, eq.u, eq.p)
        given = ca.vertcat(0.0, 0.0, p + ca.DM(mass))
        rates, force = (ca.substitute(signed(eq, part), known, given) for part in (eq.zdot[2:], -eq.zdot[1]))
        self._laws = ca.Function("laws", [eq.z], [ca.densify(rates), force])
        self._slopes = ca.Function("slopes", [eq.z], [ca.densify(ca.jacobian(rates, eq.z[2:]))])
        self._reach = np.abs(np.array(ca.Function("reach", [eq.p], [eq.reaches])(p)).reshape(-1, 1))
        self._cycles: dict[int, Any] = {}

    def fundamental(self, amplitude: np.ndarray, omega: np.ndarray) -> Fundamental:
        """Describing function at amplitudes (n,) and frequencies (n,)."""
        stiffness, damping = np.full(amplitude.shape, np.nan), np.full(amplitude.shape, np.nan)
        steps = self._steps(amplitude, omega)
        for count in np.unique(steps[steps > 0]):
            here = np.flatnonzero(steps == count)
            cosine, sine = self._periodic(int(count), amplitude[here], omega[here])
            stiffness[here] = cosine / (np.pi * amplitude[here])
            damping[here] = -sine / (np.pi * amplitude[here] * omega[here])
        return Fundamental(stiffness, damping)

    def _steps(self, amplitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        """Steps a cycle for each amplitude, a power of two; 0 where it would take too many."""
        fastest = np.zeros(amplitude.shape)
        for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False):
            z = self._at(amplitude, omega, angle)
            for side in (-1.0, 0.0, 1.0):
                z[2:] += side * self._reach
                slopes = np.array(self._slopes(z)).reshape(len(self._reach), amplitude.size, len(self._reach))
                z[2:] -= side * self._reach
                rates = np.abs(np.linalg.eigvals(np.nan_to_num(np.moveaxis(slopes, 1, 0), posinf=0.0, neginf=0.0)))
                fastest = np.fmax(fastest, np.max(rates, axis=1))
        wanted = np.maximum(2 * np.pi * _STEPS_PER_RATE * fastest / omega, _STEPS)
        count = 2.0 ** np.ceil(np.log2(wanted))
        return np.where(np.isfinite(count) & (count <= _MOST_STEPS), count, 0.0).astype(int)

    def _at(self, amplitude: np.ndarray, omega: np.ndarray, angle: float) -> np.ndarray:
        """States (states, n) with every inner one where it would be without an offset."""
        leaders = [amplitude * math.cos(angle), -amplitude * omega * math.sin(angle)]
        return np.array([*leaders, *(_zero(amplitude) if i is None else leaders[i] for i in self._eq.follows[2:])])

    def _periodic(self, count: int, amplitude: np.ndarray, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Integrals (n,) of force times cosine and times sine over a cycle of the periodic motion."""
        q = self._at(amplitude, omega, 0.0)[2:]
        by_unit = np.array([self._size(i, amplitude, omega) for i in range(len(q))])
        size = np.where(self._reach > 0, self._reach, np.maximum(np.abs(q), by_unit))
        for _ in range(_SETTLING):
            q = self._cycle(count, q, amplitude, omega)[:-2]
        integrals = np.full((2, amplitude.size), np.nan)
        open_ = np.arange(amplitude.size)  # the amplitudes that are not periodic yet
        for turn in range(_NEWTON):
            inner, a, w, scale = q[:, open_], amplitude[open_], omega[open_], size[:, open_]
            after = self._cycle(count, inner, a, w)
            drift = after[:-2] - inner
            done: np.ndarray = np.all(np.abs(drift) <= _PERIODIC * np.maximum(scale, np.abs(inner)), axis=0)
            integrals[:, open_[done]] = after[-2:, done]
            lost: np.ndarray = np.any(~np.isfinite(after), axis=0)
            over = np.logical_or(done, lost)
            if np.all(over):
                break
            q[:, open_] = inner + (drift if turn % 4 == 3 else self._newton(count, inner, drift, a, w, scale))
            open_ = open_[~over]
        return integrals[0], integrals[1]

    def _newton(
        self, count: int, q: np.ndarray, drift: np.ndarray, a: np.ndarray, w: np.ndarray, scale: np.ndarray
    ) -> np.ndarray:
        """Newton's step (inner, n) towards states that come back after a cycle, the slopes by differences."""
        inner, n = q.shape
        columns = []
        for i in range(inner):
            moved = q.copy()
            moved[i] += _DIFFERENCE * scale[i]
            columns.append((self._cycle(count, moved, a, w)[:-2] - moved - drift) / (_DIFFERENCE * scale[i]))
        matrix = np.moveaxis(np.array(columns), 2, 0).transpose(0, 2, 1)
        step = drift.copy()  # a plain cycle where the slopes are of no use
        for k in range(n):
            if np.all(np.isfinite(matrix[k])) and np.linalg.cond(matrix[k]) < 1e12:
                step[:, k] = np.linalg.solve(matrix[k], -drift[:, k])
        return step

    def _size(self, i: int, amplitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        """How far an inner state goes, by what it follows or by its unit, (n,)."""
        leader = self._eq.follows[2 + i]
        if leader is not None:
            return amplitude * (1.0 if leader == 0 else omega)
        unit = self._eq.inner[i].unit
        return np.array([Scales(a, w, 0.0, a, 1.0).of(unit) for a, w in zip(amplitude, omega, strict=True)])

    def _cycle(self, count: int, q: np.ndarray, amplitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        """Inner states (inner, n) after a cycle, and below them the two integrals over it."""
        if count not in self._cycles:
            self._cycles[count] = _cycle(self._eq, self._laws, count)
        begin = np.vstack([q, np.zeros((2, amplitude.size)), amplitude, omega, np.zeros(amplitude.size)])
        return np.array(self._cycles[count](begin))[: len(q) + 2]


def _zero(like: np.ndarray) -> np.ndarray:
    return np.zeros(like.shape)


def _cycle(eq: Equations, laws: Any, count: int) -> Any:
    """casadi.Function over one cycle of (inner, two integrals, amplitude, omega, angle), ``count`` steps."""
    import casadi as ca

    inner = len(eq.inner)
    state = ca.SX.sym("state", inner + 5)
    amplitude, omega, start = state[inner + 2], state[inner + 3], state[inner + 4]

    def field(y: Any, angle: Any) -> Any:
        x, v = amplitude * ca.cos(angle), -amplitude * omega * ca.sin(angle)
        rates, force = laws(ca.vertcat(x, v, y[:inner]))
        return ca.vertcat(rates / omega, force * ca.cos(angle), force * ca.sin(angle))

    h = 2 * math.pi / count
    y = state[: inner + 2]
    k1 = field(y, start)
    k2 = field(y + h / 2 * k1, start + h / 2)
    k3 = field(y + h / 2 * k2, start + h / 2)
    k4 = field(y + h * k3, start + h)
    after = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    step = ca.Function("step", [state], [ca.vertcat(after, amplitude, omega, start + h)])
    return step.fold(count)

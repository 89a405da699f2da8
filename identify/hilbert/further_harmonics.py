"""What the motion's own harmonics do to the fundamental of the force: harmonic balance of several harmonics.

Eqs. 6 and 7 of Feldman, Bucher, Rotberg take the motion for a sine. Preload, dry friction and cubic give it harmonics,

    x = Re( A exp(i psi) + sum u_n exp(i n psi) ),    n = 3, 5, ...

which move the instants at which the signs change, and meet the cubic, and so add to the fundamental of the force in
turn. Each harmonic follows the force's own, f_n, under the rig's linear part, while amplitude and frequency run on:

    (omega0² - n² omega² + i n (omega' + viscous omega)) u_n + (2 i n omega + viscous) u_n' + f_n = 0.

Solved by repetition (Krylov and Bogoliubov 1937 stop after the first round): every round is smaller than the one before
by cubic A² / omega², and by preload and friction over the spring's force. Near rest, where friction is much of the
force, and with a strong cubic the second round is more than the error of the curves.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..signals.registry import budget, numerics
from .limits import MOST_SHIFT

if TYPE_CHECKING:
    from .modal_stretch import Stretch

_ORDERS = numerics(np.arange(3, 200, 2), "harmonics", why="of a sign, which fall slowly")
_SIGNS = np.where(_ORDERS // 2 % 2 == 0, 1.0, -1.0)
_PLACE = float(np.sum(_SIGNS / (_ORDERS * (_ORDERS**2 - 1.0))))
_MEET = numerics(
    6, "harmonics", why="that meet the cubic, whose own fall by a factor of 20 or more from one to the next"
)
_ANGLES = numerics(
    64,
    "angles of a cycle",
    why="more than twice three times the highest order that meets the cubic, so that none folds onto another",
)
_ROUNDS = budget(8, "rounds", why="it ends where a round changes less than ``_DONE``")
_DONE = numerics(1e-6, "of the force of the spring", why="what a round changes below that is no error of any curve")
_A_CYCLE = numerics(2, "instants a cycle", why="harmonics change as slowly as the amplitude")


def further_harmonics(stretch: Stretch, values: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Further stiffness (n,), 1/s², and further damping 2 h (n,), 1/s, per unit mass, of Eq. 17 beyond Eqs. 6 and 7.

    Args:
        stretch: of n samples.
        values: of Eq. 17, per unit mass: omega0, cubic, preload, viscous, dry.
    """
    s = stretch.signal
    clear = np.flatnonzero(stretch.clear) + stretch.keep.start
    if not clear.size:
        return np.zeros(s.time.size), np.zeros(s.time.size)
    margin = stretch.low_pass_kernel.size // 2  # what a clear value leans on
    at = np.arange(clear[0] - margin, clear[-1] + margin + 1)[:: max(1, int(s.period / _A_CYCLE))]

    def seen(values: np.ndarray) -> np.ndarray:
        return np.clip(values[at], np.min(values[clear]), np.max(values[clear]))

    omega = seen(s.omega)
    further = fundamental_beyond_a_sine(s.time[at], seen(stretch.amplitude), omega, seen(s.growth), values)
    real, imaginary = (np.interp(s.time, s.time[at], part) for part in (np.real(further), np.imag(further) / omega))
    return real - np.interp(s.time, s.time[at], seen(s.growth)) * imaginary, imaginary


def fundamental_beyond_a_sine(
    time: np.ndarray, amplitude: np.ndarray, omega: np.ndarray, growth: np.ndarray, values: Mapping[str, float]
) -> np.ndarray:
    """Fundamental of Eq. 17's force over A (n,), complex, 1/s², less that which a sine of this amplitude meets.

    Args:
        time: (n,), s, rising.
        amplitude: of the fundamental, (n,).
        omega: rad/s, (n,).
        growth: A'/A, (n,), 1/s.
        values: of Eq. 17.
    """
    cubic, viscous = values["cubic"], values["viscous"]
    p, d = 4 * values["preload"] / np.pi, 4 * values["dry"] / np.pi
    n, turned = _ORDERS[:, None], 1j ** _ORDERS[:, None]
    first = growth + 1j * omega
    speed, way = np.abs(first), first / np.abs(first)  # of the velocity
    turned_back = _odd_powers(1j / way)  # the harmonics where the fundamental's velocity is zero: not at its peak
    chirp = np.gradient(omega, time) if time.size > 1 else np.zeros(time.size)
    stiff = values["omega0"] ** 2 - (n * omega) ** 2 + 1j * n * (chirp + viscous * omega)
    # a driven motion passes where a harmonic meets the rig's own frequency: what it does there is not small
    stiff = stiff * np.maximum(1.0, omega**2 / np.abs(stiff))
    turn = np.exp(1j * np.outer(np.arange(1, 2 * _MEET + 2, 2), 2 * np.pi * np.arange(_ANGLES) / _ANGLES))
    u = change = np.zeros((_ORDERS.size, time.size), complex)
    total = np.zeros(time.size, complex)
    for k in range(_ROUNDS):
        before = total
        x = np.real(np.einsum("ht,ha->at", np.vstack([amplitude[None] + 0j, u[:_MEET]]), turn))
        met = 2 * np.einsum("at,ha->ht", cubic * x**3, turn.conj()) / _ANGLES
        # the spring's sign changes where x does, a quarter turn on; friction's where the velocity does
        seen = turned * u
        slope = amplitude + np.sum(n * np.imag(seen), axis=0)
        crossing = np.sum(np.real(seen), axis=0) / slope
        turning = np.sum(np.real((change + 1j * n * omega * u) * turned_back), axis=0)
        turning = turning / (speed * amplitude + omega * np.sum(n**2 * np.real(u * turned_back), axis=0))
        crossing, turning = (np.clip(shift, -MOST_SHIFT, MOST_SHIFT) for shift in (crossing, turning))
        force = p * _SIGNS[:, None] / n * _odd_powers(np.exp(-1j * crossing))
        force += d / n * _SIGNS[:, None] * _odd_powers(way * np.exp(-1j * turning))
        force[:_MEET] += met[1:]
        u = -(force + (2j * n * omega + viscous) * change) / stiff
        u = u * np.minimum(1.0, amplitude / np.maximum(np.abs(u), 1e-300))  # else it is no fundamental, and no motion
        change = np.gradient(u, time, axis=1) if time.size > 1 else change
        total = met[0] - 0.75 * cubic * amplitude**3
        total = total + p * (np.exp(-1j * crossing) - 1) + d * way * (np.exp(-1j * turning) - 1)
        # the first round has no harmonics yet
        if k and np.max(np.abs(total - before) / amplitude, initial=0.0) < _DONE * values["omega0"] ** 2:
            break
    return total / amplitude


def _odd_powers(base: np.ndarray) -> np.ndarray:
    """``base`` (n,) to each of ``_ORDERS``, (orders, n): by multiplication, many times as fast as by powers."""
    powers = np.empty((_ORDERS.size, base.size), complex)
    square = base * base
    powers[0] = base * square
    for k in range(1, _ORDERS.size):
        np.multiply(powers[k - 1], square, out=powers[k])
    return powers


def peak_of(amplitude: np.ndarray, omega: np.ndarray, preload: float) -> np.ndarray:
    """Peak displacement (n,) of a motion whose fundamental is `amplitude` (n,), which a preload makes pointed."""
    return amplitude + _PLACE * 4 * preload / (np.pi * np.asarray(omega, float) ** 2)

"""From one-step prediction to free simulation: one number, the memory of the model in cycles of the motion.

A real rig is never exactly in the family. Its motion is that of the model under one more force that nobody recorded
(latent force: Alvarez, Luengo, Lawrence 2009); over sixty cycles such a force turns the phase by whole turns, however
small it is, and a free simulation then says nothing. So the state of the model is corrected at each sample by a gain
times what was measured beyond the prediction: the stationary Kalman filter (Kalman 1960; innovations form, Ljung 1999,
section 4.3) of a rig under white latent force, linearised along the motion by the simulation itself. The larger the
force against the sensor's noise, the shorter the memory: simulation is the limit of none, and prediction from sample to
sample that of a force beyond all noise.

For an undamped oscillator with a latent force per unit mass of density q (m²/s³) and sensor noise of density r (m² s)
the filter forgets at the rate sqrt(q / r) / (2 omega), from the spectral factor of (omega² - w²)² + q / r; a memory
of N cycles stands for q / r = (omega² / (pi N))².
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ...model.oscillator import QUANTITIES
from ..signals.registry import numerics

#: No latent force: the model simulates freely.
FREE = np.inf
_FASTEST = numerics(0.99 * np.pi, "radians a sample", why="at half the sampling rate no sample shows the phase")


@cache
def prediction_gain(memory: float, omega: float, dt: float, quantity: str) -> tuple[float, float]:
    """By how much displacement and velocity are moved for each unit that was measured beyond the prediction.

    Args:
        memory: after how many cycles of the motion an error of the state has fallen to 1/e; ``FREE`` for never.
        omega: angular frequency of the motion, rad/s.
        dt: sample interval, s.
        quantity: what is measured.
    """
    if memory == FREE:
        return 0.0, 0.0
    from scipy.linalg import solve_discrete_are

    # in the state (x, v / omega), time in radians of the motion, sensor noise of density one
    turn = min(omega * dt, _FASTEST)
    cosine, sine = np.cos(turn), np.sin(turn)
    along = np.array([[cosine, sine], [-sine, cosine]])
    order = QUANTITIES.index(quantity)
    seen = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])[order][None]
    strength = (1.0 / (np.pi * memory)) ** 2
    double = np.sin(2.0 * turn) / 2.0
    noise = 0.5 * strength * np.array([[turn - double, sine**2], [sine**2, turn + double]])
    spread = solve_discrete_are(along.T, seen.T, noise, np.array([[1.0 / turn]]))
    gain = (spread @ seen.T / (seen @ spread @ seen.T + 1.0 / turn)).ravel() / omega**order
    return float(gain[0]), float(gain[1] * omega)

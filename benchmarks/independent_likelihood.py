"""The likelihood of one record maximised twice: by dashpot, and by scipy's ``solve_ivp`` and ``least_squares``."""

from __future__ import annotations

import time

import numpy as np
from dashpot.examples.truth import TRUTH
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.problem.replay import force_of
from dashpot.identify.problem.segments import first_motion
from dashpot.model import Oscillator
from dashpot.recording import Recording
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

#: Start values off by a few percent, the same for both.
_OFF = {"mass": 1.02, "omega0": 1.002, "cubic": 1.1, "preload": 0.9, "viscous": 1.05, "dry": 1.2}
_NAMES = tuple(_OFF)


def compare(record: Recording) -> tuple[float, float, float]:
    """Seconds of dashpot, seconds of scipy, and by how much scipy's log-likelihood ends above dashpot's.

    scipy integrates the equation with ``sign()`` in the right-hand side, as one would write it down, to rtol 1e-8. Both
    have the same force between samples, the same noise spectrum to weigh by, and free initial values.
    """
    start = Oscillator.from_values({name: TRUTH[name] * factor for name, factor in _OFF.items()})
    maximum_likelihood(start, [record])  # compiles and imports
    began = time.perf_counter()
    fit = maximum_likelihood(start, [record])
    spent = time.perf_counter() - began

    force = force_of(record)
    assert force is not None
    pieces, dt, n = force.pieces, record.dt / force.fine, record.n
    times = np.arange(n) * record.dt

    def simulate(unknowns: np.ndarray) -> np.ndarray:
        mass, omega0, cubic, preload, viscous, dry = unknowns[:6] * scale[:6]

        def field(t: float, z: np.ndarray) -> list[float]:
            i = min(int(t / dt), len(pieces) - 1)
            tau = t - i * dt
            c = pieces[i]
            u = c[0] + tau * (c[1] + tau * (c[2] + tau * c[3]))
            x, v = z
            spring = omega0**2 * x + cubic * x**3 + preload * np.sign(x)
            return [v, u / mass - spring - viscous * v - dry * np.sign(v)]

        initial = unknowns[6:] * scale[6:]
        return solve_ivp(field, (0.0, times[-1]), initial, t_eval=times, rtol=1e-8, atol=1e-12, max_step=1e-3).y[0]

    motion = first_motion(np.asarray(record.response), record.dt, TRUTH["omega0"])[0]
    scale = np.array([*(TRUTH[name] for name in _NAMES), 1e-3, 0.1])
    guess = np.array([*_OFF.values(), *(motion / scale[6:])])
    began = time.perf_counter()
    theirs = least_squares(
        lambda q: fit.noise[0].whiten(simulate(q) - record.response),
        guess,
        diff_step=1e-4,
        x_scale="jac",
        xtol=1e-8,
        max_nfev=40,
    )
    theirs_spent = time.perf_counter() - began
    ours_cost = 0.5 * float(np.sum(fit.noise[0].whiten(fit.segments[0].simulated - record.response) ** 2))
    return spent, theirs_spent, ours_cost - float(theirs.cost)

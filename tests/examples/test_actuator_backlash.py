"""The stand with actuator backlash against conservation laws, its rigid limit, and scipy."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.actuator_backlash import integrate_with_backlash
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import ACTUATOR, TRUTH

DT = 1e-3


def test_energy_is_kept_without_damping():
    law = {**TRUTH, "viscous": 0.0, "dry": 0.0}
    joint = {**ACTUATOR, "contact_damping": 0.0, "guide_friction": 0.0}
    x, v, y, w = integrate_with_backlash(law, joint, np.zeros((3000, 1)), DT, (2e-3, 0.0, 2e-3, 0.05)).T
    springs = 0.5 * law["omega0"] ** 2 * x**2 + 0.25 * law["cubic"] * x**4 + law["preload"] * np.abs(x)
    squeeze = np.maximum(np.abs(y - x) - joint["half_gap"], 0.0)
    coil = joint["moving_mass"]
    energy = law["mass"] * springs + 0.5 * joint["contact_stiffness"] * squeeze**2
    energy += 0.5 * (law["mass"] - coil) * v**2 + 0.5 * coil * w**2
    assert np.ptp(energy) < 1e-11 * energy[0]
    assert np.count_nonzero(np.diff(squeeze > 0)) > 100  # it did rattle


def test_a_tight_and_rigid_joint_is_equation_17():
    joint = {**ACTUATOR, "half_gap": 1e-8, "contact_stiffness": 5e7, "contact_damping": 2000.0}
    pieces = chirp(1.0, 13.0, 0.0, np.arange(700) * DT, DT)
    both = integrate_with_backlash(TRUTH, joint, pieces, DT)[:, 0]
    single, _ = integrate_pieces(TRUTH, pieces, DT)
    assert np.abs(both - single).max() < 1e-4 * np.abs(single).max()


def test_the_gap_shows_in_the_response():
    pieces = chirp(1.0, 13.0, 0.0, np.arange(1500) * DT, DT)
    both = integrate_with_backlash(TRUTH, ACTUATOR, pieces, DT)[:, 0]
    single, _ = integrate_pieces(TRUTH, pieces, DT)
    assert np.std(both - single) > 0.01 * np.std(single)


def test_main_mass_stays_held_while_the_coil_moves_in_the_gap():
    flick = np.array([[1e-5]] * 3 + [[0.0]] * 20)
    x, v, y, w = integrate_with_backlash(TRUTH, ACTUATOR, flick, DT).T
    rate = ACTUATOR["guide_friction"] / ACTUATOR["moving_mass"]
    assert np.all(x == 0.0)
    assert np.all(v == 0.0)
    assert w[-1] == pytest.approx(w[3] * np.exp(-rate * 20 * DT), rel=1e-12)
    assert y[3] == pytest.approx(1e-5 / ACTUATOR["moving_mass"] * (3e-3 / rate - (1 - np.exp(-rate * 3e-3)) / rate**2))


def test_backlash_agrees_with_scipy_between_events():
    pieces = chirp(0.8, 12.0, 0.0, np.arange(300) * DT, DT)
    start = (1e-3, 0.0, 1.02e-3, 0.0)
    states = integrate_with_backlash(TRUTH, ACTUATOR, pieces, DT, start)
    expected = _with_scipy(pieces, start)
    scale = np.abs(states).max(axis=0)
    assert np.all(np.abs(states - expected).max(axis=0) < 2e-9 * scale)


def _with_scipy(pieces, start):
    """DOP853 with a terminal event for each surface; after an event the signs are read off a moment later."""
    from scipy.integrate import solve_ivp

    a, m = ACTUATOR, TRUTH
    coil, main = a["moving_mass"], m["mass"] - a["moving_mass"]

    def contact(z, side):
        return a["contact_stiffness"] * (z[2] - z[0] - side * a["half_gap"]) + a["contact_damping"] * (z[3] - z[1])

    def side_of(z):
        d = z[2] - z[0]
        side = np.sign(d) if abs(d) > a["half_gap"] else 0.0
        return side if side * contact(z, side) > 0 else 0.0

    def rate(s, z, c, mode):
        side_x, side_v, side = mode
        push = contact(z, side) if side else 0.0
        drive = np.polynomial.polynomial.polyval(s / DT, c)
        springs = m["omega0"] ** 2 * z[0] + m["cubic"] * z[0] ** 3 + m["preload"] * side_x + m["dry"] * side_v
        drag = (m["mass"] * m["viscous"] - a["guide_friction"]) * z[1]
        return [
            z[1],
            (push - drag - m["mass"] * springs) / main,
            z[3],
            (drive - push - a["guide_friction"] * z[3]) / coil,
        ]

    surfaces = [
        lambda s, z, *_: z[0],
        lambda s, z, *_: z[1],
        lambda s, z, *_: z[2] - z[0] - a["half_gap"],
        lambda s, z, *_: z[2] - z[0] + a["half_gap"],
        lambda s, z, *_: contact(z, 1),
        lambda s, z, *_: contact(z, -1),
    ]
    for surface in surfaces:
        surface.terminal = True  # type: ignore[attr-defined]
    tight = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-15}
    z, mode = np.array(start), (1.0, -1.0, 0.0)
    out = [z]
    for c in pieces:
        s = 0.0
        while s < DT:
            run = solve_ivp(rate, (s, DT), z, events=surfaces, args=(c, mode), **tight)
            s, z = run.t[-1], run.y[:, -1]
            fired = [i for i, t in enumerate(run.t_events) if t.size]
            if not fired:
                break
            # A step of 1 ns over the surface, in the new mode, so that no surface fires twice.
            ahead = z + 1e-9 * np.array(rate(s, z, c, mode))
            mode = (np.sign(ahead[0]), np.sign(ahead[1]), side_of(ahead))
            over = min(1e-9, DT - s)
            if over > 0:
                z = solve_ivp(rate, (s, s + over), z, args=(c, mode), **tight).y[:, -1]
                s += over
        out.append(z)
    return np.array(out)


def test_parts_that_overlap_at_the_start_are_refused():
    with pytest.raises(ValueError, match="apart"):
        integrate_with_backlash(TRUTH, ACTUATOR, np.zeros((2, 1)), DT, (0.0, 0.0, 1e-3, 0.0))

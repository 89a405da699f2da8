"""Free pieces by Eq. 17 itself: motions from an independent integrator, and closed forms."""

import numpy as np
import pytest
from dashpot.identify.motion.rig_pieces import rig_pieces
from scipy.integrate import solve_ivp

FS, NOISE = 50.0, 1e-3
RIG = {"omega0": 2 * np.pi, "cubic": 12.0, "preload": 0.4, "viscous": 0.6, "dry": 0.15}


def rung(n: int, begin: tuple[float, float], rig: dict[str, float] = RIG) -> np.ndarray:
    """(n, 3) displacement, velocity and acceleration of Eq. 17; its steps at zero are a thousandth wide."""

    def slope(_: float, z: np.ndarray) -> list[float]:
        x, v = z
        spring = rig["omega0"] ** 2 * x + rig["cubic"] * x**3 + rig["preload"] * np.tanh(x / 1e-4)
        return [v, -spring - rig["viscous"] * v - rig["dry"] * np.tanh(v / 1e-4)]

    z = solve_ivp(slope, (0, n / FS), begin, t_eval=np.arange(n) / FS, rtol=1e-8, atol=1e-10, method="LSODA").y
    return np.column_stack([*z, [slope(0.0, one)[1] for one in z.T]])


def way(begin: np.ndarray, n: int) -> np.ndarray:
    """(n,) a hand's way from a displacement and a velocity to rest at zero."""
    s = np.linspace(0, 1, n)
    return (begin[0] + begin[1] * n / FS * s + 3 * begin[0] * s) * (1 - s) ** 3


def shown(*parts: np.ndarray) -> np.ndarray:
    x = np.concatenate(parts)
    return x + 0.3 + NOISE * np.random.default_rng(4).standard_normal(x.size)


@pytest.mark.parametrize("level", [0, 1])
def test_a_nonlinear_release_of_few_cycles_after_a_hold_and_before_a_stop(level):
    free = rung(170, (1.0, 0.0))
    held = np.eye(3)[0][level] * np.ones(90)
    stopped = way(free[-1], 25) if level == 0 else np.linspace(free[-1, 1], 0, 25)
    x = shown(held, free[:, level], stopped, np.zeros(60))
    found = rig_pieces(x, FS, NOISE, FS, ("displacement", "velocity")[level])
    assert found is not None
    ((start, stop),) = found.pieces
    assert 88 <= start <= 93
    assert 254 <= stop <= 265
    assert found.values["omega0"] == pytest.approx(RIG["omega0"], rel=0.01)
    assert found.values["viscous"] == pytest.approx(RIG["viscous"], rel=0.1)
    assert found.values["cubic"] == pytest.approx(RIG["cubic"], rel=0.15)
    assert found.values["preload"] == pytest.approx(RIG["preload"], rel=0.15)


def test_plucks_of_one_rig_are_pieces_of_their_own():
    first = rung(120, (0.0, 6.0))
    second = rung(130, (float(first[-1, 0]), float(first[-1, 1]) + 5.0))
    found = rig_pieces(shown(np.zeros(40), first[:, 0], second[:, 0]), FS, NOISE, FS, "displacement")
    assert found is not None
    (a, b), (c, d) = found.pieces
    assert np.max(np.abs(np.subtract((a, b, c, d), (40, 160, 160, 290)))) <= 3


def test_an_offset_and_a_drift_are_no_motion():
    x = shown(rung(220, (1.0, 0.0))[:, 0]) + 0.05 * np.arange(220) / 220
    found = rig_pieces(x, FS, NOISE, FS, "displacement")
    assert found is not None
    assert found.pieces == ((0, 220),)
    assert found.values["omega0"] == pytest.approx(RIG["omega0"], rel=0.01)


def test_a_linear_rig_has_no_other_member():
    t = np.arange(200) / FS
    x = shown(np.ones(60), np.exp(-0.4 * t) * (np.cos(6 * t) + 0.4 / 6 * np.sin(6 * t)))
    found = rig_pieces(x, FS, NOISE, FS, "displacement")
    assert found is not None
    assert found.values["cubic"] == found.values["preload"] == found.values["dry"] == 0.0
    assert found.values["omega0"] == pytest.approx(np.hypot(6, 0.4), rel=1e-3)
    assert found.rate == pytest.approx(0.4, rel=0.02)


def test_two_modes_are_no_rig_of_one_for_long():
    t = np.arange(500) / FS
    x = shown(np.exp(-0.1 * t) * np.cos(6 * t) + 0.3 * np.exp(-0.1 * t) * np.cos(8.5 * t))
    found = rig_pieces(x, FS, NOISE, FS, "displacement")
    assert found is None or sum(stop - start for start, stop in found.pieces) < x.size / 4


def test_a_hand_is_no_rig():
    x = shown(np.ones(100), way(np.array([1.0, 0.0]), 80), np.zeros(100))
    assert rig_pieces(x, FS, NOISE, FS, "displacement") is None

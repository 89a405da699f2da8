"""Backbones against closed forms and against the free vibration itself, integrated by scipy."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.model.backbone import damping_curve, exact_backbone, polynomial_backbone, preload_backbone
from dashpot.model.describing import equivalent_damping, equivalent_stiffness, natural_motion

A = np.geomspace(1e-7, 5e-2, 30)


def test_the_preload_is_equation_1(rig):
    o = rig(cubic=0.0)
    ratio = o.omega0.value**2 / o.preload.value
    printed = np.pi * o.omega0.value / (2 * np.arccos(1 / (1 + A * ratio)))
    backbone = preload_backbone(o.omega0.value, o.preload.value, A)
    np.testing.assert_allclose(backbone, printed, rtol=1e-8)  # arccos loses digits as its argument nears 1
    np.testing.assert_allclose(exact_backbone(o, A), backbone, rtol=1e-12)


def test_the_frequency_doubles_at_0_414_of_the_preload_deflection():
    doubled, half = np.sqrt(2) - 1, 0.5
    np.testing.assert_allclose(preload_backbone(3.0, 9.0, [doubled, half]), [6.0, 1.868 * 3.0], rtol=3e-4)
    np.testing.assert_allclose(preload_backbone(3.0, 9.0, doubled), 6.0, rtol=1e-13)


def test_without_preload_equation_1_is_the_linear_spring():
    np.testing.assert_allclose(preload_backbone(3.0, 0.0, A), 3.0, rtol=1e-14)


@pytest.mark.parametrize("cubic", [4.6e5, 1e9, -1e6])
def test_the_cubic_is_duffing_s_elliptic_integral(rig, cubic):
    from scipy.special import ellipk

    o = rig(preload=0.0, cubic=cubic)
    a = A[o.omega0.value**2 + cubic * A**2 > 0]
    top = o.omega0.value**2 + cubic * a**2
    # Nayfeh and Mook 1979, section 2.1; m is the parameter (square of the modulus), negative for softening
    expected = np.pi * np.sqrt(top) / (2 * ellipk(cubic * a**2 / (2 * top)))
    np.testing.assert_allclose(exact_backbone(o, a), expected, rtol=1e-10)


def period(force, start: float, reach: float) -> tuple[float, float]:
    """Period and amplitude of x'' = -force(x, side) let go at ``start``: half a turn by scipy."""
    from scipy.integrate import solve_ivp

    z, t, side = np.array([start, 0.0]), 0.0, 1.0
    for hit in (0, 1):  # down to x = 0, then on to the turning point

        def event(t, z, hit=hit):
            return z[hit]

        event.terminal, event.direction = True, (-1 if hit == 0 else 1)
        run = solve_ivp(
            lambda t, z, side=side: [z[1], -force(z[0], side)],
            (t, t + reach),
            z,
            method="DOP853",
            events=event,
            rtol=1e-12,
            atol=1e-15,
        )
        t, z, side = run.t_events[0][0], run.y_events[0][0], -1.0
    return 2 * t, (start - z[0]) / 2


@pytest.mark.parametrize("start", [2e-5, 5e-4, 5e-3, 1.5e-2])
def test_all_springs_together_and_asymmetry_against_an_integrated_vibration(rig, start):
    square = 2e5
    o = rig(effects=("quadratic-stiffness",), **{"quadratic-stiffness.coefficient": square})
    w2, c, p = o.omega0.value**2, o.cubic.value, o.preload.value
    time, amplitude = period(lambda x, side: w2 * x + c * x**3 + square * x**2 + p * side, start, 0.2)
    np.testing.assert_allclose(exact_backbone(o, amplitude), 2 * np.pi / time, rtol=1e-9)


def test_a_contact_is_met_where_it_begins(rig, contact):
    k, gap, start = 3e4, 1e-3, 2e-3
    o = rig(cubic=0.0, preload=0.0, effects=("contact",), **{"contact.stiffness": k, "contact.gap": gap})
    w, stiff = o.omega0.value, np.hypot(o.omega0.value, np.sqrt(k))
    shift = k * gap / stiff**2  # middle of the motion in contact
    speed = stiff * np.sqrt((start - shift) ** 2 - (gap - shift) ** 2)  # on leaving it
    depth = np.hypot(speed / w, gap)  # turning point of the free side
    quarter = np.arccos((gap - shift) / (start - shift)) / stiff
    time = 2 * (quarter + (np.arctan2(w * gap, speed) + np.pi / 2) / w)
    np.testing.assert_allclose(exact_backbone(o, (start + depth) / 2), 2 * np.pi / time, rtol=1e-10)


def test_the_hilbert_average_is_the_describing_function(rig):
    o = rig(preload=0.0, effects=("quintic-stiffness",), **{"quintic-stiffness.coefficient": 1e9})
    backbone = polynomial_backbone(o.omega0.value, o.cubic.value, A, quintic=1e9)
    np.testing.assert_allclose(backbone**2, equivalent_stiffness(o, A, 80.0), rtol=1e-12)
    # near the linear limit both backbones meet; the cubic alone stays 2.2 % apart
    np.testing.assert_allclose(
        exact_backbone(o, 1e-3), polynomial_backbone(o.omega0.value, 4.6e5, 1e-3, 1e9), rtol=1e-5
    )


def test_the_damping_curve_is_half_the_equivalent_damping(rig):
    o = rig()
    omega = np.linspace(70.0, 100.0, A.size)
    damping = damping_curve(o.viscous.value, o.dry.value, A, omega)
    np.testing.assert_allclose(2 * damping, equivalent_damping(o, A, omega), rtol=1e-12)
    assert damping_curve(5.0, 0.0, 1.0, 80.0)[0] == 2.5  # the paper's h


def test_dry_friction_takes_4_d_over_omega_squared_a_cycle(rig):
    # x'' + dry sgn x' + omega0² x = 0 loses 4 dry / omega0² of amplitude a cycle: -A'/A = h, exactly
    dry, omega, amplitude = 0.015, 80.0, 1e-3
    lost = 4 * dry / omega**2 / (2 * np.pi / omega)
    np.testing.assert_allclose(damping_curve(0.0, dry, amplitude, omega)[0], lost / amplitude, rtol=1e-12)


@pytest.mark.parametrize(
    ("changed", "amplitude"),
    [({"cubic": -4e5}, [1e-3, 0.2]), ({"preload": -0.07}, [1e-6]), ({"preload": -0.07}, [2e-5])],
)
def test_where_the_spring_does_not_pull_back_there_is_no_backbone(rig, changed, amplitude):
    with pytest.raises(BadInput, match=f"no free vibration of amplitude {amplitude[-1]:g} m"):
        exact_backbone(rig(**changed), amplitude)


def test_a_negative_preload_vibrates_over_both_wells(rig):
    o = rig(cubic=0.0, preload=-0.07)
    a = np.array([2.01, 3.0, 50.0]) * 0.07 / o.omega0.value**2
    np.testing.assert_allclose(exact_backbone(o, a), preload_backbone(o.omega0.value, -0.07, a), rtol=1e-9)
    with pytest.raises(BadInput, match="or only just"):  # the frequency falls to zero there
        exact_backbone(o, (2 + 1e-7) * 0.07 / o.omega0.value**2)
    with pytest.raises(BadInput, match="stays on one side"):
        preload_backbone(o.omega0.value, -0.07, 0.99 * a)


def test_amplitudes_without_sense_are_said(rig):
    for call in (
        lambda: exact_backbone(rig(), [0.0]),
        lambda: preload_backbone(80.0, 0.07, [-1.0]),
        lambda: polynomial_backbone(80.0, 4.6e5, np.inf),
        lambda: damping_curve(5.0, 0.015, 1e-3, 0.0),
    ):
        with pytest.raises(BadInput, match="above zero"):
            call()
    with pytest.raises(BadInput, match=r"softened to nothing at amplitude 0\.2"):
        polynomial_backbone(80.0, -4.6e5, [1e-3, 0.2])


def test_the_backbone_of_a_mass_over_the_displacement_is_that_of_an_integrated_vibration(rig):
    """m(x) x'' + m'(x) x'^2 / 2 + k x = 0: half a turn by scipy; the mean motion comes near it."""
    from scipy.integrate import solve_ivp

    heights = {f"free/inertia/6.at-{k + 1}": 0.25 * (k - 3) for k in range(7)} | {"free/inertia/6.reach": 8e-3}
    o = rig(cubic=0.0, preload=0.0, viscous=0.0, dry=0.0, effects=("free/inertia/6",), **heights)
    start, w2 = 6e-3, o.omega0.value**2
    # heights that grow in a straight line, 0.25 a third: a mass of 1 + 0.375 u², u the place in parts of the reach
    mass, slope = lambda x: 1 + 0.375 * (x / 8e-3) ** 2, lambda x: 0.75 * x / 8e-3**2

    def turned(t, z):
        return z[1]

    turned.terminal, turned.direction = True, 1
    run = solve_ivp(
        lambda t, z: [z[1], -(w2 * z[0] + 0.5 * slope(z[0]) * z[1] ** 2) / mass(z[0])],
        (0, 1.0),
        [start, -1e-12],
        method="DOP853",
        events=turned,
        rtol=1e-12,
        atol=1e-15,
    )
    true = np.pi / run.t_events[0][0]
    np.testing.assert_allclose(exact_backbone(o, [start]), true, rtol=1e-8)
    omega, _ = natural_motion(o, [start])
    np.testing.assert_allclose(omega, true, rtol=5e-3)
    assert true < 0.96 * o.omega0.value

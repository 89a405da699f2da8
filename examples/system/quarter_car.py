"""A quarter of a car: a wheel on its tyre and a body, between them a strut that was identified in a test machine.

The wheel is an oscillator's FMU, the strut that of a force law by itself (motion in, force out), the body a mass that
the master integrates. The strut is recorded, identified, exported; nothing of it is written here again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..rig_fmu import RigFmu
from ..specimens import Specimen, motion, recorded

#: The strut in the test machine: N/m, N s/m, N; a damper that is steep at low speed and flat at high.
STRUT = Specimen({"stiffness": 18e3, "viscous": 500.0}, "digressive-damping", {"force": 300.0, "speed": 0.08})
#: kg, kg, N/m and N s/m of the tyre.
BODY, WHEEL, TYRE, TYRE_DAMPING = 300.0, 40.0, 180e3, 120.0


@dataclass(frozen=True)
class Driven:
    """Time (n,), displacement of body and wheel (n, 2), m, and the strut's force on the body (n,), N."""

    time: np.ndarray
    moved: np.ndarray
    force: np.ndarray


def strut_and_wheel(folder: Path) -> tuple[Path, Path]:
    """The FMUs of strut and wheel for this machine, in a folder: the strut identified from three recordings."""
    from ...export.element_fmu import export_element_fmu
    from ...export.fmu import export_fmu
    from ...export.platforms import own_platform
    from ...model.library import oscillator_with
    from ...prescribed.element_fit import identify_element

    tests = [
        recorded(STRUT, motion(kind, 0.03, frequency, 400.0, 12.0, i), 400.0, noise=2e-3, motion_noise=1e-5, seed=i)
        for i, (kind, frequency) in enumerate((("sweep", 2.0), ("sines", 1.0), ("random", 3.0)))
    ]
    strut = identify_element(tests, laws=["digressive-damping"], name="strut").element
    none = {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
    values = {"mass": WHEEL, "omega0": np.sqrt(TYRE / WHEEL), "viscous": TYRE_DAMPING / WHEEL, **none}
    here = (own_platform(),)
    folder.mkdir(parents=True, exist_ok=True)
    return (
        export_element_fmu(strut, folder / "strut.fmu", platforms=here),
        export_fmu(oscillator_with(values, (), name="wheel"), folder / "wheel.fmu", platforms=here),
    )


def bump(t: float) -> tuple[float, float]:
    """Height of the road, m, and how fast it rises: 30 mm over 0.15 s from 0.1 s on, and down again."""
    turn = 2.0 * np.pi * (t - 0.1) / 0.3
    if not 0.0 <= turn <= 2.0 * np.pi:
        return 0.0, 0.0
    return 0.015 * (1.0 - np.cos(turn)), 0.015 * np.sin(turn) * 2.0 * np.pi / 0.3


def drive(
    strut_fmu: Path,
    wheel_fmu: Path,
    road: Callable[[float], tuple[float, float]] = bump,
    *,
    step: float = 1e-3,
    seconds: float = 1.5,
) -> Driven:
    """The car over a road, by co-simulation without iteration.

    Args:
        strut_fmu, wheel_fmu: of FMI 2.
        road: height and its rate at a time.
        step: of communication, s.
        seconds: to simulate.
    """
    strut, wheel = RigFmu(strut_fmu), RigFmu(wheel_fmu)
    count = round(seconds / step) + 1
    time, moved, force = step * np.arange(count), np.zeros((count, 2)), np.zeros(count)
    body, speed, pull, before = 0.0, 0.0, 0.0, 0.0
    for k, t in enumerate(time):
        x, v, a = wheel.get("displacement", "velocity", "acceleration")
        if k:  # the body's speed with the mean of both accelerations (Verlet 1967)
            strut.move(x - body, v - speed - 0.5 * step * pull, a - pull)
            now = strut.get("F")[0] / BODY
            speed += 0.5 * step * (pull + now)
            pull = now
        strut.move(x - body, v - speed, a - pull)
        force[k] = strut.get("F")[0]
        moved[k] = body, x
        height, rise = road(t)
        slope = (force[k] - before) / step if k else 0.0
        before = force[k]
        wheel.push(TYRE * height + TYRE_DAMPING * rise - force[k], TYRE * rise - slope)
        body += step * speed + 0.5 * step**2 * pull
        for fmu in (strut, wheel):
            fmu.step(step)
    for fmu in (strut, wheel):
        fmu.end()
    return Driven(time, moved, force)


def monolithic(time: np.ndarray, road: Callable[[float], tuple[float, float]] = bump) -> np.ndarray:
    """(n, 2) displacement of body and wheel by one integration of all equations, with the strut's true numbers."""
    from scipy.integrate import solve_ivp

    numbers, members = STRUT.numbers or {}, STRUT.members

    def rates(t: float, z: np.ndarray) -> list[float]:
        x, v = z[2] - z[0], z[3] - z[1]
        force = members["stiffness"] * x + members["viscous"] * v + numbers["force"] * np.tanh(v / numbers["speed"])
        height, rise = road(t)
        tyre = TYRE * (height - z[2]) + TYRE_DAMPING * (rise - z[3])
        return [z[1], force / BODY, z[3], (tyre - force) / WHEEL]

    how = {"t_eval": time, "rtol": 1e-9, "atol": 1e-12, "max_step": 1e-3}
    return solve_ivp(rates, (0.0, float(time[-1])), np.zeros(4), **how).y[[0, 2]].T

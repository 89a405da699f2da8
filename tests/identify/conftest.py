"""An independent simulator of the Eq. 17 family: pure Python, RK4 between located sign changes of x and x'."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pytest

Force = Callable[[float], float]


@dataclass(frozen=True)
class Rig:
    mass: float = 0.27
    omega0: float = 2 * math.pi * 12.67
    cubic: float = 4.6e5
    preload: float = 0.02 / 0.27
    viscous: float = 5.0
    dry: float = 0.015


def simulate(rig: Rig, force: Force | None, fs: float, n: int, x0: float = 0.0, v0: float = 0.0, substeps: int = 2):
    """Displacement and velocity (n,) at fs, the signs of x and x' held inside each substep, changes located."""
    k, c3, pre, c, dry, inv_m = rig.omega0**2, rig.cubic, rig.preload, rig.viscous, rig.dry, 1.0 / rig.mass
    h_full = 1.0 / (fs * substeps)

    def acc(t: float, x: float, v: float, sx: float, sv: float) -> float:
        a = -c * v - dry * sv - k * x - c3 * x * x * x - pre * sx
        return a + force(t) * inv_m if force else a

    def rk4(t: float, x: float, v: float, h: float, sx: float, sv: float) -> tuple[float, float]:
        a1 = acc(t, x, v, sx, sv)
        v2 = v + 0.5 * h * a1
        a2 = acc(t + 0.5 * h, x + 0.5 * h * v, v2, sx, sv)
        v3 = v + 0.5 * h * a2
        a3 = acc(t + 0.5 * h, x + 0.5 * h * v2, v3, sx, sv)
        v4 = v + h * a3
        a4 = acc(t + h, x + h * v3, v4, sx, sv)
        return x + h * (v + 2 * v2 + 2 * v3 + v4) / 6, v + h * (a1 + 2 * a2 + 2 * a3 + a4) / 6

    def modes(t: float, x: float, v: float, sx: float, sv: float) -> tuple[float, float, bool]:
        """Signs to go on with from an event, and whether the mass sticks."""
        if x == 0.0:
            sx = math.copysign(1.0, v) if v else 0.0
        if v == 0.0:
            drive = acc(t, x, 0.0, sx, 0.0)
            reach = dry + (pre if x == 0.0 else 0.0)
            if abs(drive) <= reach:
                return sx, 0.0, True
            sv = math.copysign(1.0, drive)
            if x == 0.0:
                sx = sv
        return sx, sv, False

    xs, vs = np.zeros(n), np.zeros(n)
    x, v, t = x0, v0, 0.0
    sx = math.copysign(1.0, x) if x else 0.0
    sv = math.copysign(1.0, v) if v else 0.0
    sx, sv, stuck = modes(t, x, v, sx, sv)
    xs[0], vs[0] = x, v
    for i in range(1, n * substeps - substeps + 1):
        t_end, remaining, events = i * h_full, h_full, 0
        while remaining > 1e-15:
            if stuck:
                t = t_end
                sx, sv, stuck = modes(t, x, 0.0, sx, sv)
                break
            xn, vn = rk4(t, x, v, remaining, sx, sv)
            if xn * sx >= 0 and vn * sv >= 0:
                x, v, t = xn, vn, t_end
                break
            events += 1
            if events > 20:  # chatter at the origin: it has come to rest
                x, v, stuck, t = 0.0, 0.0, True, t_end
                break
            low, high = 0.0, remaining
            for _ in range(60):
                mid = 0.5 * (low + high)
                xm, vm = rk4(t, x, v, mid, sx, sv)
                if xm * sx >= 0 and vm * sv >= 0:
                    low = mid
                else:
                    high = mid
                if high - low < 1e-14:
                    break
            xm, vm = rk4(t, x, v, high, sx, sv)
            if xm * sx < 0:
                xm, sx = 0.0, -sx
            if vm * sv < 0:
                vm = 0.0
            x, v, t = xm, vm, t + high
            remaining = t_end - t
            sx, sv, stuck = modes(t, x, v, sx, sv)
        if i % substeps == 0:
            xs[i // substeps], vs[i // substeps] = x, v
    return xs, vs


def sweep(level: float, f0: float, f1: float, duration: float, taper: float = 0.5) -> Force:
    def force(t: float) -> float:
        gain = min(1.0, t / taper, max(0.0, (duration - t) / taper))
        return level * gain * math.sin(2 * math.pi * (f0 * t + 0.5 * (f1 - f0) * t * t / duration))

    return force


def bursts(level: float, f: float, on: float, off: float) -> Force:
    def force(t: float) -> float:
        t = t % (on + off)
        return level * math.sin(2 * math.pi * f * t) if t < on else 0.0

    return force


def multisine(level: float, f0: float, f1: float, period: float, seed: int) -> Force:
    rng = np.random.default_rng(seed)
    lines = np.arange(math.ceil(f0 * period), math.floor(f1 * period) + 1) / period
    table = [(2 * math.pi * f, p) for f, p in zip(lines, rng.uniform(0, 2 * math.pi, lines.size), strict=True)]
    amplitude = level / math.sqrt(lines.size / 2)

    @lru_cache(maxsize=4)  # the middle of a step is asked for twice, its end again as the next beginning
    def force(t: float) -> float:
        return amplitude * sum(math.sin(w * t + p) for w, p in table)

    return force


@dataclass(frozen=True)
class Case:
    fs: float
    x: np.ndarray
    v: np.ndarray
    force: np.ndarray | None

    def noisy(self, displacement: float, force: float, seed: int) -> Case:
        """White noise: `displacement` in m, `force` as a part of the force's peak."""
        rng = np.random.default_rng(seed)
        f = self.force
        if f is not None:
            f = f + force * np.max(np.abs(f)) * rng.standard_normal(f.size)
        return replace(self, x=self.x + displacement * rng.standard_normal(self.x.size), force=f)


def case(rig: Rig, force: Force | None, fs: float, duration: float, x0: float = 0.0, substeps: int = 2) -> Case:
    n = round(duration * fs)
    x, v = simulate(rig, force, fs, n, x0=x0, substeps=substeps)
    return Case(fs, x, v, None if force is None else np.array([force(i / fs) for i in range(n)]))


@pytest.fixture(scope="session")
def rigs() -> SimpleNamespace:
    return SimpleNamespace(
        Rig=Rig, simulate=simulate, case=case, sweep=sweep, bursts=bursts, multisine=multisine, reference=Rig()
    )


@pytest.fixture(scope="session")
def reference_decay() -> Case:
    """From rest at 9 mm, 3 s at 1 kHz, noiseless."""
    return case(Rig(), None, 1000.0, 3.0, x0=9e-3)


@pytest.fixture(scope="session")
def reference_sweeps() -> tuple[Case, Case]:
    """5-20 Hz at 0.3 N up and 1 N down, 40 s at 1 kHz, noiseless."""
    low = case(Rig(), sweep(0.3, 5, 20, 40), 1000.0, 40.0)
    high = case(Rig(), sweep(1.0, 20, 5, 40), 1000.0, 40.0)
    return low, high

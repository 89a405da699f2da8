"""Specimens in a test machine: motions that are imposed, and the forces of laws with known numbers.

The forces are computed here, in closed form or by an integrator of their own, and by nothing of the product.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..recording import Recording

#: Steps of an inner state from sample to sample.
_SUBSTEPS = 16
Rate = Callable[[float, float], float]


@dataclass(frozen=True)
class Specimen:
    """Members of Eq. 17 in N and m, and one further law by its name and numbers; no law where ``law`` is empty."""

    members: Mapping[str, float]
    law: str = ""
    numbers: Mapping[str, float] | None = None

    def force(self, x: np.ndarray, v: np.ndarray, a: np.ndarray, dt: float) -> np.ndarray:
        """(n,) along a motion (n,)."""
        m = {"inertia": 0.0, "stiffness": 0.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.0, "dry": 0.0, "load": 0.0}
        m |= self.members
        made = m["inertia"] * a + m["stiffness"] * x + m["cubic"] * x**3 + m["preload"] * np.sign(x) + m["load"]
        made = made + m["viscous"] * v + m["dry"] * np.sign(v)
        return made + LAWS[self.law](self.numbers or {}, x, v, dt) if self.law else made


def motion(kind: str, amplitude: float, frequency: float, fs: float, seconds: float, seed: int = 0) -> np.ndarray:
    """(n,) displacement: ``sines`` at several levels, ``sweep``, ``triangle`` with rounded corners, or ``random``."""
    t = np.arange(int(seconds * fs)) / fs
    if kind == "sines":
        level = np.interp(t, np.linspace(0.0, seconds, 7), [0.0, 1.0, 1.0, 0.45, 0.45, 0.2, 0.2])
        return amplitude * level * np.sin(2 * np.pi * frequency * t)
    if kind == "sweep":
        turn = 2 * np.pi * np.cumsum(0.3 * frequency * 10.0 ** (t / seconds)) / fs
        return amplitude * np.sin(turn) * (1.0 - 0.7 * t / seconds)
    if kind == "triangle":
        turn = np.cumsum(np.interp(t, [0.0, seconds], [0.5, 2.0]) * frequency) / fs
        wave = 1.0 - 2.0 * np.abs(2.0 * ((turn + 0.25) % 1.0) - 1.0)
        window = np.hanning(max(5, int(fs / frequency / 8)) + 2)
        half = window.size // 2
        rounded = np.convolve(np.pad(wave, half, mode="edge"), window / window.sum(), "same")
        return amplitude * rounded[half:-half]
    lines = np.fft.rfft(np.random.default_rng(seed).standard_normal(t.size))
    line = np.fft.rfftfreq(t.size, 1.0 / fs)
    lines[(line > 2.0 * frequency) | (line < 0.1 * frequency)] = 0.0
    wave = np.fft.irfft(lines, t.size)
    return amplitude * wave / np.max(np.abs(wave))


def recorded(
    specimen: Specimen, x: np.ndarray, fs: float, *, noise: float = 0.0, motion_noise: float = 0.0, seed: int = 0
) -> Recording:
    """A recording of a specimen along a motion (n,), with white noise: parts of force and displacement, rms."""
    from scipy.interpolate import CubicSpline

    time = np.arange(x.size) / fs
    spline = CubicSpline(time, x)
    force = specimen.force(x, spline(time, 1), spline(time, 2), 1.0 / fs)
    rng = np.random.default_rng(seed)
    shown = x + motion_noise * np.std(x) * rng.standard_normal(x.size)
    force = force + noise * np.std(force) * rng.standard_normal(x.size)
    return Recording(f"specimen {seed}", fs, shown, force, prescribed=True)


def _integrated(rate: Rate, v: np.ndarray, dt: float) -> np.ndarray:
    """(n,) inner state from zero, by the midpoint rule."""
    state, made, step = 0.0, np.zeros(v.size), dt / _SUBSTEPS
    for i in range(v.size - 1):
        for k in range(_SUBSTEPS):
            speed = v[i] + (k + 0.5) / _SUBSTEPS * (v[i + 1] - v[i])
            state += step * rate(state + 0.5 * step * rate(state, speed), speed)
        made[i + 1] = state
    return made


def _bouc_wen(p: Mapping[str, float], _x: np.ndarray, v: np.ndarray, dt: float) -> np.ndarray:
    limit, loading = p["limit"], p["loading"]
    rate: Rate = lambda z, u: u * (1 - abs(z / limit) ** p["exponent"] * (loading * np.sign(u * z) + 1 - loading))  # noqa: E731
    return p["stiffness"] * _integrated(rate, v, dt)


def _maxwell(p: Mapping[str, float], _x: np.ndarray, v: np.ndarray, dt: float) -> np.ndarray:
    return p["stiffness"] * _integrated(lambda z, u: u - p["rate"] * z, v, dt)


def _nonlinear_maxwell(p: Mapping[str, float], _x: np.ndarray, v: np.ndarray, dt: float) -> np.ndarray:
    def rate(z: float, u: float) -> float:
        return u - p["speed"] * np.sign(z) * min(abs(z) / p["limit"], 50.0) ** p["exponent"]

    return p["stiffness"] * _integrated(rate, v, dt)


def _lugre(p: Mapping[str, float], _x: np.ndarray, v: np.ndarray, dt: float) -> np.ndarray:
    def rate(z: float, u: float) -> float:
        return u - abs(u) * z / (p["limit"] * (1 + p["excess"] * np.exp(-((u / p["speed"]) ** 2))))

    z = _integrated(rate, v, dt)
    return p["stiffness"] * z + p["damping"] * np.array([rate(*pair) for pair in zip(z, v, strict=True)])


def _stribeck(p: Mapping[str, float], _x: np.ndarray, v: np.ndarray, _dt: float) -> np.ndarray:
    return p["excess"] * np.exp(-((np.abs(v) / p["speed"]) ** p["exponent"])) * np.sign(v)


def _stops(p: Mapping[str, float], x: np.ndarray, _v: np.ndarray, _dt: float) -> np.ndarray:
    gap = p["position"]
    return p["stiffness"] * (np.maximum(x - gap, 0.0) + np.minimum(x + gap, 0.0))


def _stop(p: Mapping[str, float], x: np.ndarray, _v: np.ndarray, _dt: float) -> np.ndarray:
    return p["stiffness"] * np.maximum(x - p["position"], 0.0)


#: The force of each law, by its name; numbers are called as in the library.
LAWS: Mapping[str, Callable[[Mapping[str, float], np.ndarray, np.ndarray, float], np.ndarray]] = {
    "hysteresis": _bouc_wen,
    "viscoelastic": _maxwell,
    "nonlinear-maxwell": _nonlinear_maxwell,
    "lugre": _lugre,
    "stribeck": _stribeck,
    "two-sided-stop": _stops,
    "one-sided-stop": _stop,
    "quadratic-drag": lambda p, x, v, dt: p["coefficient"] * v * np.abs(v),
    "cubic-damping": lambda p, x, v, dt: p["coefficient"] * v**3,
    "softening-stiffness": lambda p, x, v, dt: p["stiffness"] * p["width"] * np.tanh(x / p["width"]),
    "quadratic-stiffness": lambda p, x, v, dt: p["coefficient"] * x**2,
    "digressive-damping": lambda p, x, v, dt: p["force"] * np.tanh(v / p["speed"]),
    "gas-spring": lambda p, x, v, dt: p["force"] * ((1 - x / p["length"]) ** -p["exponent"] - 1),
    "exponential-spring": lambda p, x, v, dt: p["force"] * (np.exp(x / p["length"]) - 1),
    "asymmetric-friction": lambda p, x, v, dt: p["viscous"] * np.abs(v),
}

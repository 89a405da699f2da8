"""Laws that nobody wrote: sums of bends that neither the library nor any grammar of formulas in the product has.

Each is one to three bends of random kind, place and width (arc tangent, bell, log cosh, area sine, error function,
cosine), less what of it is a straight line or a cubic over the working range: that the base rig has already.
"""

from __future__ import annotations

import math

import numpy as np

from .base import Base, log_uniform

BENDS = ("atan", "bell", "log-cosh", "asinh", "erf", "cosine")
MOST = 3
_FUNCTIONS = (
    np.arctan,
    lambda u: np.exp(-u * u),
    lambda u: np.abs(u) + np.log1p(np.exp(-2 * np.abs(u))),
    np.arcsinh,
    np.vectorize(math.erf),
    np.cos,
)
_GRID = np.linspace(-1.0, 1.0, 401)
_TRIES = 200


def shape(parameters: dict[str, float], q: np.ndarray) -> np.ndarray:
    """What the law is at q (n,): m/s² over displacement or velocity, 1/s where it is times the velocity."""
    total = np.zeros(q.shape)
    for i in range(1, MOST + 1):
        if kind := int(parameters.get(f"bend_{i}", 0)):
            size, place, width = (parameters[f"{name}_{i}"] for name in ("size", "place", "width"))
            bend = _FUNCTIONS[kind - 1]
            total += size * (bend((q - place) / width) - bend(-place / width))
    return total


def _bends(rng: np.random.Generator, reach: float) -> dict[str, float]:
    """One to three bends within a reach, of sizes that let each be seen beside the others."""
    drawn: dict[str, float] = {}
    for i in range(1, int(rng.integers(1, MOST + 1)) + 1):
        drawn[f"bend_{i}"] = float(rng.integers(1, len(BENDS) + 1))
        drawn[f"size_{i}"] = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 1.0))
        drawn[f"place_{i}"] = reach * float(rng.uniform(-0.6, 0.6))
        drawn[f"width_{i}"] = reach * log_uniform(rng, 0.15, 0.7)
    return drawn


def _sized(drawn: dict[str, float], factor: float) -> dict[str, float]:
    return {name: value * (factor if name.startswith("size") else 1.0) for name, value in drawn.items()}


def _beyond_the_base(values: np.ndarray, odd: bool) -> float:
    """The largest part (of values over the grid) that neither a straight line nor, of a spring, a cubic has."""
    columns = [_GRID, np.ones(_GRID.size), *([_GRID**3] if odd else [])]
    basis = np.column_stack(columns)
    return float(np.max(np.abs(values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0])))


def spring(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A spring of any smooth shape: what of it is not linear or cubic has 3 to 12 % of the spring force at its most.

    The whole restoring force rises everywhere within one and a half working amplitudes.
    """
    share = rng.uniform(0.03, 0.12) * base.spring
    for _ in range(_TRIES):
        drawn = _bends(rng, base.amplitude)
        found = _sized(drawn, share / _beyond_the_base(shape(drawn, base.amplitude * _GRID), odd=True))
        x = 1.5 * base.amplitude * _GRID
        whole = base.parameters["omega2"] * x + base.parameters["cubic"] * x**3 + shape(found, x)
        if np.all(np.diff(whole) > 0.25 * base.parameters["omega2"] * np.diff(x)):
            return {"unwritten_over": 1.0} | _sized(found, strength)
    raise ValueError("no spring among so many rises everywhere")


def resistance(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A resistance over the velocity: what is not linear of it has 1 to 4 % of the spring force; it takes energy."""
    share = rng.uniform(0.01, 0.04) * base.spring
    v = 1.5 * base.speed * _GRID
    for _ in range(_TRIES):
        drawn = _bends(rng, base.speed)
        found = _sized(drawn, share / _beyond_the_base(shape(drawn, base.speed * _GRID), odd=False))
        if np.all(v * (base.parameters["viscous"] * v + shape(found, v)) >= 0.2 * base.parameters["viscous"] * v * v):
            return {"unwritten_over": 2.0} | _sized(found, strength)
    raise ValueError("no resistance among so many takes energy everywhere")


def damping_by_position(rng: np.random.Generator, base: Base, variant: str, strength: float) -> dict[str, float]:
    """A damping that depends on the position: it varies by 2 to 8 % of damping ratio, and stays above none."""
    share = 2 * rng.uniform(0.02, 0.08) * base.omega
    for _ in range(_TRIES):
        drawn = _bends(rng, base.amplitude)
        values = shape(drawn, base.amplitude * _GRID)
        found = _sized(drawn, share / float(np.ptp(values)))
        x = 1.5 * base.amplitude * _GRID
        if np.all(base.parameters["viscous"] + shape(found, x) > 0.2 * base.parameters["viscous"]):
            return {"unwritten_over": 3.0} | _sized(found, strength)
    raise ValueError("no damping among so many stays above none")

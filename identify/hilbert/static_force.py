"""Static force characteristics from backbone and damping curve: describing functions inverted.

A force f(x) of a symmetric law has under x = A sin(theta) the fundamental

    F(A) = 4/pi ∫ f(A sin(theta)) sin(theta) dtheta        from 0 to pi/2,

which is what ``omega0(A)² A`` measures. Its inverse is

    f(x) = 1/2 d/dx ( x ∫ F(x sin(theta)) dtheta ),

as a power shows: f = x^n gives F = c x^n with c ∫ sin^n = 2/(n + 1). (Abel's integral equation; for describing
functions Gibson and di Tada 1963.) Feldman, Bucher, Rotberg, Eq. 15 plots F itself, so that a cubic comes out at three
quarters and a friction plateau at 4/pi of the force.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_POINTS = 40
_ANGLES = 400


@dataclass(frozen=True, eq=False)
class Characteristic:
    """Force per unit mass (n,) at positive displacements or velocities (n,), from measured curves."""

    at: np.ndarray
    force: np.ndarray
    std: np.ndarray  # of the force; zero where that of the curve was not given


def static_force(
    amplitude: np.ndarray, fundamental: np.ndarray, std: np.ndarray | None = None, independent: float = 1.0
) -> Characteristic:
    """The static force behind the fundamental F(A), both (n,), in any order; empty below eight amplitudes.

    `std` (n,) is the standard error of F at each point, `independent` how many independent values a point stands for.

    Below the smallest amplitude F is continued as a straight line (exact for a preloaded linear spring, and for dry
    and viscous friction together).
    """
    given = np.zeros(np.shape(amplitude)) if std is None else std
    a, f, error = medians(amplitude, fundamental, given, independent)
    if a.size < 8:
        return Characteristic(np.empty(0), np.empty(0), np.empty(0))
    grid = np.linspace(0, a[-1], 4 * _POINTS + 1)[1:]
    at, edges = grid[3::4], np.zeros(1)
    middle = at - 0.5 * np.diff(np.append(0.0, at))
    seen = middle >= a[0]
    # each step is linear in F: what it makes of one of its values alone gives the error of all
    shares = np.stack([_inverted(a, column, grid) for column in np.eye(a.size)], axis=1) if std is not None else edges
    spread = np.sqrt((shares**2) @ error**2) if std is not None else np.zeros(at.size)
    return Characteristic(middle[seen], _inverted(a, f, grid)[seen], spread[seen])


def _inverted(a: np.ndarray, f: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Force between every fourth point of the grid, from F at the amplitudes a, rising."""
    slope, start = np.polyfit(a[:6], f[:6], 1)
    # the middle of each small angle: the integrand is smooth or a step at the origin
    theta = (np.arange(_ANGLES) + 0.5) * (np.pi / 2 / _ANGLES)
    reach = grid[:, None] * np.sin(theta)
    inner = np.where(reach < a[0], start + slope * reach, np.interp(reach, a, f))
    moment = grid * np.mean(inner, axis=1) * (np.pi / 2)
    # over four grid steps: what is drawn are points, not the noise between them
    return 0.5 * np.diff(np.append(0.0, moment[3::4])) / np.diff(np.append(0.0, grid[3::4]))


def medians(
    amplitude: np.ndarray, value: np.ndarray, std: np.ndarray, independent: float = 1.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Medians of amplitude and value over stretches of equal numbers of neighbouring amplitudes, rising, with errors.

    All (n,), in any order; what is not finite is passed over. The error of a median is that of the mean of as many
    independent values as its points stand for, at least one.
    """
    good = np.isfinite(amplitude) & np.isfinite(value) & (amplitude > 0)
    amplitude, value, std = amplitude[good], value[good], std[good]
    order = np.argsort(amplitude, kind="stable")
    bins = [i for i in np.array_split(order, min(60, max(1, amplitude.size))) if i.size]
    a = np.array([np.median(amplitude[i]) for i in bins])
    f = np.array([np.median(value[i]) for i in bins])
    error = np.array([np.median(std[i]) / np.sqrt(max(1.0, independent * i.size)) for i in bins])
    if a.size > 1:
        keep = np.append(True, np.diff(a) > 0)
        a, f, error = a[keep], f[keep], error[keep]
    return a, f, error

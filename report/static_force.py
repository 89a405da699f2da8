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


def static_force(amplitude: np.ndarray, fundamental: np.ndarray) -> Characteristic:
    """The static force behind the fundamental F(A), both (n,), in any order; empty below eight amplitudes.

    Below the smallest amplitude F is continued as a straight line (exact for a preloaded linear spring, and for dry
    and viscous friction together).
    """
    good = np.isfinite(amplitude) & np.isfinite(fundamental) & (amplitude > 0)
    a, f = _medians(amplitude[good], fundamental[good])
    if a.size < 8:
        return Characteristic(np.empty(0), np.empty(0))
    slope, start = np.polyfit(a[:6], f[:6], 1)
    grid = np.linspace(0, a[-1], 4 * _POINTS + 1)[1:]
    # the middle of each small angle: the integrand is smooth or a step at the origin
    theta = (np.arange(_ANGLES) + 0.5) * (np.pi / 2 / _ANGLES)
    reach = grid[:, None] * np.sin(theta)
    inner = np.where(reach < a[0], start + slope * reach, np.interp(reach, a, f))
    moment = grid * np.mean(inner, axis=1) * (np.pi / 2)
    # over four grid steps: what is drawn are points, not the noise between them
    at, edges = grid[3::4], np.append(0.0, moment[3::4])
    width = np.diff(np.append(0.0, at))
    force = 0.5 * np.diff(edges) / width
    middle = at - 0.5 * width
    seen = middle >= a[0]
    return Characteristic(middle[seen], force[seen])


def _medians(amplitude: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Medians over stretches of equal numbers of neighbouring amplitudes, rising."""
    order = np.argsort(amplitude, kind="stable")
    bins = np.array_split(order, min(60, max(1, amplitude.size)))
    a = np.array([np.median(amplitude[i]) for i in bins if i.size])
    f = np.array([np.median(value[i]) for i in bins if i.size])
    if a.size > 1:
        keep = np.append(True, np.diff(a) > 0)
        a, f = a[keep], f[keep]
    return a, f

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

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from ...model.frequency_response import FrequencyResponse, branches, steady_amplitude
from ..signals.registry import numerics, shown
from .limits import LEAST_POINTS
from .modal_result import ModalCurve

_POINTS = shown(40, "points", why="of a curve")
_BINS = shown(60, "medians", why="of a curve's values")
_ANGLES = numerics(400, "angles of a cycle", why="of an average over it")


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
    if a.size < LEAST_POINTS:
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
    bins = [i for i in np.array_split(order, min(_BINS, max(1, amplitude.size))) if i.size]
    a = np.array([np.median(amplitude[i]) for i in bins])
    f = np.array([np.median(value[i]) for i in bins])
    error = np.array([np.median(std[i]) / np.sqrt(max(1.0, independent * i.size)) for i in bins])
    if a.size > 1:
        keep = np.append(True, np.diff(a) > 0)
        a, f, error = a[keep], f[keep], error[keep]
    return a, f, error


# Static characteristics of spring and friction from measured curves: Eq. 15 as printed, and inverted to a force.


@dataclass(frozen=True, eq=False)
class StaticCharacteristic:
    """Force over displacement or velocity, from measured curves, at positive values; both halves of a rig are alike.

    Attributes:
        at, force, force_std: displacement or velocity (n,), the force there and its standard error.
        amplitude, literal: the same by Eq. 15 as printed, (m,).
    """

    at: np.ndarray
    force: np.ndarray
    force_std: np.ndarray
    amplitude: np.ndarray
    literal: np.ndarray


def spring_characteristic(curves: Sequence[ModalCurve], mass: float | None = None) -> StaticCharacteristic:
    """Restoring force over displacement, Eq. 15.

    Args:
        curves: backbones of one or several stretches, from ``hilbert_analysis``.
        mass: kg; with it forces are in N, without per unit mass.

    Raises:
        BadInput: the curves cover too few amplitudes.
    """
    a, squared, std = _joined(curves, lambda c: (c.amplitude, c.omega0**2, 2 * c.omega0 * c.omega0_std))
    return _characteristic(a, squared * a, squared * a, std * a, curves, mass)


def friction_characteristic(curves: Sequence[ModalCurve], mass: float | None = None) -> StaticCharacteristic:
    """Friction force over velocity, Eq. 15; arguments and errors as above."""
    speed, damping, std = _joined(curves, lambda c: (c.amplitude * c.omega, c.damping, c.damping_std))
    return _characteristic(speed, 2 * damping * speed, damping * speed, 2 * std * speed, curves, mass)


def _joined(
    curves: Sequence[ModalCurve], parts: Callable[[ModalCurve], tuple[np.ndarray, ...]]
) -> Iterator[np.ndarray]:
    if not curves:
        raise BadInput("there is no curve to draw a characteristic from; record a decay or a slow sweep")
    return (np.concatenate(values) for values in zip(*(parts(c) for c in curves), strict=True))


def _characteristic(
    at: np.ndarray,
    fundamental: np.ndarray,
    printed: np.ndarray,
    std: np.ndarray,
    curves: Sequence[ModalCurve],
    mass: float | None,
) -> StaticCharacteristic:
    independent = float(np.mean([c.independent for c in curves]))
    inverted = static_force(at, fundamental, std, independent)
    if not inverted.at.size:
        raise BadInput("the curves cover too few amplitudes for a characteristic; record a longer decay or sweep")
    amplitude, literal, _ = medians(at, printed, std * (printed / fundamental), independent)
    m = 1.0 if mass is None else mass
    return StaticCharacteristic(inverted.at, m * inverted.force, m * inverted.std, amplitude, m * literal)


# Eqs. 13 and 14 with the measured curves in them: the response to a sine without any model.


def measured_response(curves: Sequence[ModalCurve], force: float) -> FrequencyResponse:
    """Eq. 14: both branches of the steady response to a sine, at the amplitudes that the curves cover.

    Args:
        curves: backbones and damping curves of one rig, from ``hilbert_analysis``.
        force: amplitude of the force per unit mass, displacement's unit per s².

    Raises:
        BadInput: no curve, or a force that is not positive.
    """
    if not curves:
        raise BadInput("there is no curve to compute a response from; record a decay or a slow sweep")
    a, squared, damping = (
        np.concatenate(values) for values in zip(*((c.amplitude, c.omega0**2, c.damping) for c in curves), strict=True)
    )
    nothing = np.zeros(a.size)
    grid, squares, _ = medians(a, squared, nothing)
    return branches(grid, np.sqrt(squares), medians(a, damping, nothing)[1], force)


def quasi_steady_amplitude(curve: ModalCurve, mass: float) -> np.ndarray:
    """Corrected Eq. 13 along a driven stretch: the amplitude (n,) that a steady sine of this force would keep up there.

    Where it is the measured amplitude, the sweep is slow enough to be read as a frequency response.

    Args:
        curve: by FORCEVIB.
        mass: kg.
    """
    return steady_amplitude(curve.omega, curve.omega0, curve.damping, curve.force / mass)

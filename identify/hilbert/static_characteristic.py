"""Static characteristics of spring and friction from measured curves: Eq. 15 as printed, and inverted to a force.

Feldman, Bucher, Rotberg, Eq. 15 plots `omega0² A` over A, and `h0 A_v` over the envelope A_v of the velocity. These
are fundamentals: read as forces, a cubic is three quarters of itself, the plateau of a preload 4/pi, and that of dry
friction, for which h0 stands in place of 2 h0, 0.637. Inverted (``static_force``) they are the forces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import BadInput
from .modal_result import ModalCurve
from .static_force import medians, static_force


@dataclass(frozen=True, eq=False)
class StaticCharacteristic:
    """Force over displacement or velocity, from measured curves, at positive values; both halves of a rig are alike.

    Attributes:
        at, force, force_std: displacement or velocity (n,), the force there and its standard error.
        amplitude, literal, literal_std: the same by Eq. 15 as printed, (m,).
        in_newton: whether the forces are in N; else they are per unit mass.
    """

    at: np.ndarray
    force: np.ndarray
    force_std: np.ndarray
    amplitude: np.ndarray
    literal: np.ndarray
    literal_std: np.ndarray
    in_newton: bool


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
    amplitude, literal, error = medians(at, printed, std * (printed / fundamental), independent)
    m = 1.0 if mass is None else mass
    return StaticCharacteristic(
        inverted.at, m * inverted.force, m * inverted.std, amplitude, m * literal, m * error, mass is not None
    )

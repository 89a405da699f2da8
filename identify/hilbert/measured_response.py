"""Eqs. 13 and 14 with the measured curves in them: the response to a sine without any model.

Feldman, Bucher, Rotberg, section 4.2, corrected: the last term under the root of Eq. 13 is `4 h² omega² / omega0⁴`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import BadInput
from ...model.frequency_response import FrequencyResponse, branches, steady_amplitude
from .modal_result import ModalCurve
from .static_force import medians


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

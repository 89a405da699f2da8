"""FORCEVIB: mass, natural frequency and damping of a driven motion, instant by instant.

Feldman 1994, as used in Feldman, Bucher, Rotberg 2009, section 6.2: with the analytic signals of response and force

    X'' + 2 h0 X' + omega0² X = F / m.

The mass is found first (``modal_mass``); with it every instant gives omega0² and h0 (``instantaneous``), which are
low-passed. The amplitude must change slowly: a sweep, a sine that builds up. Under noise or a multisine there is no
single amplitude.
"""

from __future__ import annotations

import numpy as np

from ...errors import BadInput
from .instantaneous import modal_parameters
from .modal_fit import modal_fit
from .modal_mass import MassFit
from .modal_result import ModalCurve, ModalFit
from .modal_stretch import Stretch
from .within_the_cycle import within_the_cycle


def modal_curve(
    stretch: Stretch,
    mass: MassFit | None,
    recording: str,
    samples: tuple[int, int],
    begin: float,
    displacement: np.ndarray | None = None,
) -> ModalCurve:
    """The curves of one stretch: by FREEVIB where nothing drives it, else by FORCEVIB with the mass given.

    Args:
        stretch: displacement, and force where it is driven.
        mass: of this stretch alone, from ``mass_fit``; None for a decay.
        recording: name.
        samples: start and stop of the stretch in it.
        begin: time of the stretch's first sample, s.
        displacement: the samples (m,) that a decay was made from, for what happens within its cycles; None: not asked.

    Raises:
        BadInput: nothing in it stands clear of its noise.
    """
    inverse = 0.0 if mass is None else mass.inverse
    s = stretch.signal
    squared, damping = modal_parameters(s, stretch.ratio, inverse)
    low = stretch.low_pass(np.stack([squared, damping, s.omega]))
    variance = stretch.point_variance(squared, damping, inverse)
    of_damping = variance / s.omega[stretch.keep] ** 2
    force = np.zeros(s.time.size)
    if mass is not None and stretch.ratio is not None:  # an error of the mass moves all points together
        of_mass = stretch.low_pass(np.real(stretch.ratio)), stretch.low_pass(np.imag(stretch.ratio) / s.omega)
        variance = variance + (of_mass[0] * mass.std) ** 2
        of_damping = of_damping + (of_mass[1] * mass.std) ** 2
        force = np.abs(stretch.ratio) * s.amplitude
    good = stretch.clear & (low[0] > 0) & (low[2] > 0)
    if not np.any(good):
        raise BadInput(
            "nothing in it stands clear of its noise with an amplitude that changes slowly; record a larger motion"
        )
    try:
        fit = modal_fit([stretch], mass)
    except BadInput:
        fit = None
    keep = stretch.keep
    if fit is not None:
        low[:2] += _bent_off(stretch, fit)
        good &= low[0] > 0
    omega0 = np.sqrt(low[0][good])
    amplitude, phase = stretch.smooth_motion if stretch.ratio is None else (stretch.amplitude[keep], s.phase[keep])
    return ModalCurve(
        recording=recording,
        method="freevib" if stretch.ratio is None else "forcevib",
        start=samples[0],
        stop=samples[1],
        time=begin + s.time[keep][good],
        amplitude=amplitude[good],
        phase=phase[good],
        omega=low[2][good],
        omega0=omega0,
        damping=low[1][good],
        omega0_std=np.sqrt(variance[good]) / (2 * omega0),
        damping_std=0.5 * np.sqrt(of_damping[good]),
        force=force[keep][good],
        # the kernels' effective length is a third of their joint length
        independent=min(1.0, 3.0 / (s.kernel + stretch.low_pass_kernel.size)),
        fit=fit,
        within=None if displacement is None or mass is not None else within_the_cycle(stretch, displacement, good),
    )


def _bent_off(stretch: Stretch, fit: ModalFit) -> np.ndarray:
    """What the low-passes take off omega0² and h, (2, k), as the fitted laws have it: much near rest, else nothing."""
    first, keep = stretch.signal.equation_first, stretch.keep
    a, values = np.maximum(stretch.amplitude, np.finfo(float).tiny), fit.values
    spring = values["omega0"] ** 2 + 0.75 * values["cubic"] * a**2 + 4 * values["preload"] / (np.pi * a)
    friction = 0.5 * values["viscous"] + 2 * values["dry"] / (np.pi * a * np.abs(first))
    seen = np.real(stretch.passed(spring[None])[0]), np.imag(stretch.passed(friction[None], first)[0]) / np.imag(first)
    return np.stack([spring, friction])[:, keep] - stretch.low_pass(np.stack(seen))

"""What FREEVIB and FORCEVIB find, as values: a law fitted to curves, and all fits of one method."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from .within_the_cycle import WithinTheCycle

_NOTHING: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True)
class LawFit:
    """One law fitted to the curves of one or several stretches.

    Attributes:
        law: ``preload`` (Eq. 1), ``polynomial`` (Eq. 6), ``preload and polynomial``, or ``viscous and dry`` (Eq. 7).
        values, stds: by parameter of Eq. 17, SI, per unit mass, with standard errors; infinite where the law is not all
            that moves the rig, so that none would hold.
        misfit: mean square of what is left over that of the sensors' noise; 1 where noise explains it.
    """

    law: str
    values: Mapping[str, float]
    stds: Mapping[str, float]
    misfit: float

    @property
    def over_noise(self) -> float:
        """Rms of what is left over that of the noise: what pages, text and JSON say."""
        return math.sqrt(self.misfit)

    @property
    def without_errors(self) -> LawFit:
        """The same with no error that would have to hold: all infinite."""
        return replace(self, stds=dict.fromkeys(self.stds, math.inf))


@dataclass(frozen=True)
class ModalFit:
    """All fits of one method to the same curves; ``both`` and ``damping`` together are its Eq. 17.

    Standard errors are infinite where these two leave more than noise: then none would hold.

    Attributes:
        preload: Eq. 1 alone; None where it does not go through the curves at all.
        polynomial: Eq. 6 alone.
        both: Eqs. 1 and 6 together, as describing functions.
        damping: Eq. 7.
        mass, mass_std: kg, by FORCEVIB; None and infinity by FREEVIB.
        derived, derived_std: ``F0/k`` in m and, where there is a mass, ``k`` in N/m and ``F0`` in N.
    """

    preload: LawFit | None
    polynomial: LawFit
    both: LawFit
    damping: LawFit
    mass: float | None = None
    mass_std: float = float("inf")
    derived: Mapping[str, float] = field(default_factory=lambda: _NOTHING)
    derived_std: Mapping[str, float] = field(default_factory=lambda: _NOTHING)

    @property
    def values(self) -> dict[str, float]:
        """Eq. 17's parameters, by name; with the mass where there is one."""
        return {**({} if self.mass is None else {"mass": self.mass}), **self.both.values, **self.damping.values}

    @property
    def misfit(self) -> float:
        """Mean square of what the laws leave over that of the noise, of stiffness or damping, whichever is larger."""
        return max(self.both.misfit, self.damping.misfit)

    @property
    def over_noise(self) -> float:
        """Rms of what the laws leave over that of the noise, as of a single law."""
        return max(self.both.over_noise, self.damping.over_noise)

    @property
    def has_errors(self) -> bool:
        """Whether standard errors are stated."""
        return math.isfinite(sum(self.both.stds.values()) + sum(self.damping.stds.values()))

    @property
    def without_errors(self) -> ModalFit:
        """The same with no error that would have to hold: those of ``both``, ``damping`` and what follows infinite."""
        none = dict.fromkeys(self.derived_std, math.inf)
        both, damping = self.both.without_errors, self.damping.without_errors
        return replace(self, both=both, damping=damping, mass_std=math.inf, derived_std=none)

    @property
    def stds(self) -> dict[str, float]:
        """Their standard errors, by name."""
        return {**({} if self.mass is None else {"mass": self.mass_std}), **self.both.stds, **self.damping.stds}


@dataclass(frozen=True, eq=False)
class ModalCurve:
    """Instantaneous modal parameters of one decay or driven stretch, low-passed; every array has shape (n,).

    Attributes:
        recording: its name.
        method: ``freevib`` or ``forcevib``.
        start, stop: the samples of the recording that it comes from.
        time: s, of the recording; rising, with gaps where the motion does not stand clear of its noise.
        amplitude: envelope of the displacement A, in its unit.
        phase: psi, rad, unwrapped.
        omega: instantaneous frequency, rad/s.
        omega0: natural frequency (Eq. 12; with a force Feldman 1994), rad/s: over the amplitude, the backbone.
        damping: h0, 1/s; ``viscous = 2 h0`` of a linear system.
        omega0_std, damping_std: standard errors of a point from the sensors' noise, and of the mass.
        force: amplitude of the force, in its unit; zero in a decay.
        independent: how many independent values a point stands for: the curves are smoother than they are dense.
        fit: the laws fitted to this curve alone; None where it is too short for that.
        within: what happens within the cycles of a decay; None under a force, and where a band took the harmonics.
        cut: s at the end of a decay that are left out, because friction stops it within the reach of the kernels.
    """

    recording: str
    method: str
    start: int
    stop: int
    time: np.ndarray
    amplitude: np.ndarray
    phase: np.ndarray
    omega: np.ndarray
    omega0: np.ndarray
    damping: np.ndarray
    omega0_std: np.ndarray
    damping_std: np.ndarray
    force: np.ndarray
    independent: float
    fit: ModalFit | None
    within: WithinTheCycle | None = None
    cut: float = 0.0

    @property
    def decrement(self) -> np.ndarray:
        """Logarithmic decrement (n,) of a cycle, 2 pi h0 / sqrt(omega0² - h0²), at each amplitude; NaN if critical."""
        inside = self.omega0**2 - self.damping**2
        return 2 * np.pi * self.damping / np.sqrt(np.where(inside > 0, inside, np.nan))

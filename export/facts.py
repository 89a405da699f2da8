"""What an export needs to know of a model, measured once and passed from file to file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import BadInput
from ..files.computed_once import computed_once
from ..model.describing import HarmonicMotion
from ..model.equations import Equations, equations
from ..simulate.core import internal_step
from .smoothing import MotionSize, Sample, amplitude_of, motion_size, sample_motion

if TYPE_CHECKING:
    from ..model import Oscillator

#: The amplitude at which a model is run, in parts of the largest that it was identified for.
LARGE = 0.9
#: Longest internal step, s, of a model that neither swings nor decays.
_STILL_STEP = 1e-3


@dataclass(frozen=True, eq=False)
class Facts:
    """A model and the facts of it that more than one file of an export states; each is measured when first asked for.

    Made at the door of an export (``export_fmu``, ``export_ssp``, ``export_plain_c``, ``export_casadi``).
    """

    oscillator: Oscillator

    @computed_once
    def equations(self) -> Equations:
        """The equations of motion."""
        return equations(self.oscillator)

    @computed_once
    def loaded(self) -> Equations:
        """The same of a rig that may carry a payload: an FMU's."""
        return equations(self.oscillator, payload=True)

    @computed_once
    def values(self) -> dict[str, float]:
        """Plain values of the parameters by their names."""
        return self.oscillator.values()

    @property
    def amplitude(self) -> float:
        """Largest amplitude that the model was identified for, in the displacement's unit."""
        return amplitude_of(self.oscillator)

    @computed_once
    def longest(self) -> float:
        """Longest internal step within that amplitude, s; raises BadInput where the model has no motion."""
        return internal_step(self.oscillator, self.values, self.amplitude)

    @computed_once
    def max_step(self) -> float:
        """The same, s, for a model without any motion too: there any step will do."""
        try:
            return self.longest
        except BadInput:
            return _STILL_STEP

    @computed_once
    def sample(self) -> Sample:
        """A motion from the largest amplitude on; raises BadInput where it is too fast to be followed."""
        return sample_motion(self.oscillator, self.equations, self.longest)

    @computed_once
    def size(self) -> MotionSize:
        """How large surfaces and states become in the model's own motion."""
        return motion_size(self.oscillator, self.equations, lambda: self.sample)

    @computed_once
    def natural(self) -> tuple[float, float]:
        """Natural frequency, rad/s, and damping h, 1/s, near the largest amplitude, or what stands in where it does not
        swing."""
        try:
            with np.errstate(all="ignore"):
                omega, h = (float(series[0]) for series in self.harmonic.natural(LARGE * self.amplitude))
        except BadInput:
            omega, h = math.nan, math.nan
        plain = self.oscillator.omega0.value
        omega = omega if math.isfinite(omega) and omega > 0 else plain if plain > 0 else 2 * math.pi
        return omega, h if math.isfinite(h) and h > 0 else 0.0

    @computed_once
    def harmonic(self) -> HarmonicMotion:
        """The laws in a harmonic motion: natural frequency and damping at any amplitude."""
        return HarmonicMotion(self.oscillator)

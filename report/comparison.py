"""Measured and simulated response of one recording side by side, whether the FMU or the fit made the latter."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..identify.left import left_of_recording
from ..identify.signals.hilbert import noise_level
from ..model import Response
from ..model.left import over

if TYPE_CHECKING:
    from ..identify.identification import Identification
    from ..verify.verification import Verification


@dataclass(frozen=True, eq=False)
class Comparison:
    """One recording.

    Attributes:
        name: of the recording.
        time, measured, simulated: (n,) s and the response's unit; ``simulated`` is NaN where nothing was simulated.
        nrmse: rms(simulated - measured) / std(measured), over what was simulated.
        noise_floor: the same of a perfect model, from the noise of sensor and force.
        by_fmu: whether an FMU was run, over all of the recording, instead of the fit's own stretches.
        response: what was measured, and in which unit.
        held_out: whether the identification has not seen it.
        backbone_error: largest distance of the backbones, Hz; None where not known.
        passed: None where no verdict was asked for.
        limit: the ``nrmse`` that would still pass; NaN where no verdict was asked for.
    """

    name: str
    time: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    nrmse: float
    noise_floor: float
    by_fmu: bool
    response: Response
    held_out: bool = False
    backbone_error: float | None = None
    passed: bool | None = None
    limit: float = math.nan

    @property
    def residual(self) -> np.ndarray:
        """Simulated minus measured, (n,)."""
        return self.simulated - self.measured

    @property
    def noise_rms(self) -> float:
        """The noise floor in the response's unit."""
        there = np.isfinite(self.simulated)
        return self.noise_floor * float(np.std(self.measured[there] if there.any() else self.measured))

    @property
    def fs(self) -> float:
        """Sampling rate, Hz."""
        return (self.time.size - 1) / float(self.time[-1] - self.time[0])

    @property
    def sensor_rms(self) -> float:
        """White noise of the sensor, in the response's unit."""
        return noise_level(self.measured, self.fs)

    @property
    def ratio(self) -> float:
        """Times the noise that is left: 1 for a perfect model."""
        return over(self.nrmse, self.noise_floor)


def comparisons(identification: Identification, verification: Verification | None) -> tuple[Comparison, ...]:
    """From the FMU's runs where it was verified, else from the fit's own simulation."""
    if verification is None:
        return tuple(c for i in range(len(identification.recordings)) if (c := _of_fit(identification, i)) is not None)
    known = {r.name for r in identification.recordings}
    return tuple(replace(c, held_out=c.name not in known) for c in of_verification(verification))


def of_verification(verification: Verification) -> tuple[Comparison, ...]:
    """From the FMU's runs; of no recording is it known whether it was held out."""
    return tuple(
        Comparison(
            c.file,
            c.time,
            c.measured,
            c.simulated,
            c.nrmse,
            c.noise_floor,
            True,
            c.response,
            backbone_error=c.backbone_max_error_hz,
            passed=c.passed,
            limit=c.nrmse_limit,
        )
        for c in verification.recordings
    )


def _of_fit(identification: Identification, index: int) -> Comparison | None:
    recording, left = identification.recordings[index], left_of_recording(identification.fit, index)
    if left is None or not math.isfinite(left.part):
        return None
    simulated = np.full(recording.n, np.nan)
    for fitted in identification.fit.segments:
        if fitted.segment.recording == index:
            simulated[fitted.segment.start : fitted.segment.stop] = fitted.simulated
    measured = np.asarray(recording.response, float)
    shown = Response(recording.quantity, recording.unit)
    return Comparison(recording.name, recording.time, measured, simulated, left.part, left.noise, False, shown)

"""The equation of motion along the measured motion of all segments: what is missing in it, sample by sample.

A free-run residual smears: a wrong spring shows as a phase error long afterwards. The missing force does not, so that
the place where it acts can be read from it. It is the smoother's, with one prior for all segments.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ...errors import BadInput
from ...identify.problem.data import Data
from ...identify.signals.hilbert import analytic_signal
from ...identify.signals.limits import SHORTEST_PERIOD
from ...identify.signals.registry import numerics
from ...model import Oscillator
from ...recording.smoothing import with_polynomials
from ..limits import BLOCK_CYCLES
from .smoother import Smoothed, Smoother

_SPAN = numerics(6, "spans a cycle", why="of a filter that three harmonics pass")

_DENSITY = numerics(16.0, "samples a cycle that are kept", why="eight harmonics")
_MARGIN_CYCLES = numerics(1.0, "cycles", why="left out at either end of a stretch, where a filter sees one side alone")


@dataclass(frozen=True, eq=False)
class Stretch:
    """One segment's motion and the force that is missing along it, about sixteen samples a cycle.

    Attributes:
        name: of the recording.
        driven: whether a recorded force acts.
        time: (n,) s.
        x, v, a: (n,) displacement, velocity, acceleration.
        missing: (n,) missing force per unit mass, positive where it opposes a positive motion.
        noise: (n,) what noise alone would make of it.
        drive, drive_rate, drive_bend: (n,) force per unit mass and its first two derivatives.
        amplitude, frequency_hz, phase: (n,) of the motion by its Hilbert transform, NaN where it has none.
        block: (n,) number of the block of cycles that a sample belongs to.
        seen: gives of forces (n, m) along the stretch what the smoother would find of them; None: all.
    """

    name: str
    driven: bool
    time: np.ndarray
    x: np.ndarray
    v: np.ndarray
    a: np.ndarray
    missing: np.ndarray
    noise: np.ndarray
    drive: np.ndarray
    drive_rate: np.ndarray
    drive_bend: np.ndarray
    amplitude: np.ndarray
    frequency_hz: np.ndarray
    phase: np.ndarray
    block: np.ndarray
    seen: Callable[[np.ndarray], np.ndarray] | None = None

    @property
    def n(self) -> int:
        """Number of samples."""
        return self.time.size


def equation_error(model: Oscillator, data: Data) -> tuple[list[Stretch], float]:
    """The stretches of all segments that move, and what a missing force gains: log-likelihood a sample, in the mean.

    The strength and memory of the missing force are those of the segment where it is strongest: with one prior for
    all of them, quiet and loud recordings can be compared.
    """
    smoothers, priors, evidence, samples = [], [], 0.0, 0
    for i in range(len(data.segments)):
        smoother = Smoother(model, data, i)
        smoothers.append(smoother)
        loudest = smoother.loudest()
        strength, memory = smoother.most_likely(*loudest)
        priors.append((strength, memory))
        evidence += smoother.evidence(strength, memory, *loudest)
        samples += loudest[1] - loudest[0]
    prior = max(priors)
    stretches = []
    for segment, smoother in zip(data.segments, smoothers, strict=True):
        smoothed = smoother.smooth(prior=prior)
        stretch = _stretch(data.recordings[segment.recording].name, segment.force is not None, smoothed, smoother)
        if stretch is not None:
            stretches.append(stretch)
    return stretches, evidence / max(samples, 1)


def _stretch(name: str, driven: bool, smoothed: Smoothed, smoother: Smoother) -> Stretch | None:
    dt, period = smoother.dt, smoother.period
    step = max(int(period / dt / _DENSITY), 1)
    margin = int(_MARGIN_CYCLES * period / dt)
    keep = np.arange(margin, smoothed.time.size - margin, step)
    keep = keep[smoothed.moving[keep]]
    if keep.size < 2 * _DENSITY:
        return None
    span = max(int(period / dt / _SPAN) | 1, SHORTEST_PERIOD)
    rate, bend = (with_polynomials(smoothed.drive, span, 3, k) / dt**k for k in (1, 2))
    amplitude = frequency = phase = np.full(smoothed.time.size, np.nan)
    try:
        analytic = analytic_signal(smoothed.displacement, 1.0 / dt)
        amplitude, frequency, phase = analytic.amplitude, analytic.omega / (2 * np.pi), analytic.phase
    except BadInput:  # too few cycles, or too few samples in one, for an envelope
        pass
    return Stretch(
        name=name,
        driven=driven,
        time=smoothed.time[keep],
        x=smoothed.displacement[keep],
        v=smoothed.velocity[keep],
        a=np.gradient(smoothed.velocity, dt)[keep],
        missing=smoothed.force[keep],
        noise=smoothed.noise[keep],
        drive=smoothed.drive[keep],
        drive_rate=rate[keep],
        drive_bend=bend[keep],
        amplitude=amplitude[keep],
        frequency_hz=frequency[keep],
        phase=phase[keep],
        block=((keep * dt) / (BLOCK_CYCLES * period)).astype(int),
        seen=partial(_seen, smoother, (smoothed.strength, smoothed.memory), keep),
    )


def _seen(smoother: Smoother, prior: tuple[float, float], keep: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """(n, m) what the smoother finds of forces (n, m) that are known at the samples ``keep``."""
    from scipy.interpolate import make_interp_spline

    inside = np.clip(np.arange(smoother.n), keep[0], keep[-1])
    return smoother.makes_of(make_interp_spline(keep, forces, k=3, axis=0)(inside), prior)[keep]

"""Whether a fit knows what a rig is asked for first: its frequency and its damping amid the recorded amplitudes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import BadInput
from ...model.fit_state import LACKING
from ...model.show import STRONG
from ...recording.recording import Recording
from ..motion.limits import KNOWN
from ..problem.data import displacement_amplitude
from ..problem.equivalent import equivalent
from ..signals.registry import numerics
from .reported_result import Fit

_FEELER = numerics(1e-2, "standard errors", why="over which what follows from a parameter is all but straight")


def refuse_unknown(fit: Fit, recordings: Sequence[Recording]) -> None:
    """Refuse a fit of which frequency or damping amid the recorded amplitudes is not known to a third.

    A frequency to a third of itself or of the motion's, a damping ratio to a third of itself or of the critical: a
    small one may well be none. Nor is a frequency known that moves with a mass that is not: over such an error what
    follows from it is no longer straight. Where the model explains the motion in part and leaves more than noise, other
    physics widens the errors; what is left is said, and a diagnosis may begin with it. What slides has no frequency.

    Args:
        fit: with the covariance of its free parameters.
        recordings: that it was made to.

    Raises:
        BadInput: where one of the two is not known.
    """
    segments = [part.segment for part in fit.segments]
    lacks = any(s.over_noise > LACKING for s in fit.segments) and _explains(fit)
    if not fit.names or lacks or any(segment.slide for segment in segments):
        return
    model, pace = fit.oscillator, segments[0].pace
    size = 0.5 * displacement_amplitude(segments)
    values = model.values()
    errors = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))

    def moved(by: float) -> np.ndarray:
        both = [
            equivalent(values | {n: values[n] + by * e}, size, pace) for n, e in zip(fit.names, errors, strict=True)
        ]
        return np.array(both)

    stiffness, damping = equivalent(values, size, pace)
    scale = np.where(errors > 0.0, errors, 1.0)
    slopes = (moved(_FEELER) - moved(-_FEELER)) / (2 * _FEELER * scale[:, None])
    spread = np.sqrt(np.maximum(np.diag(slopes.T @ fit.covariance @ slopes), 0.0))
    omega = np.sqrt(max(abs(stiffness), pace**2))
    known = (spread[0] <= 2 * KNOWN * omega**2, spread[1] <= 2 * KNOWN * omega * max(1.0, abs(damping) / (2 * omega)))
    names = ", ".join(dict.fromkeys(recordings[s.recording].name for s in segments))
    if _moves_with_a_mass_that_is_unknown(fit, errors):
        raise BadInput(
            f"{names}: mass and natural frequency cannot be told apart: for each mass there is a frequency that "
            "explains as much; record a force of other frequencies, or a release beside it"
        )
    if all(known):
        return
    what = "the damping ratio" if known[0] else "the natural frequency"
    raise BadInput(
        f"{names}: {what} is not known to a third of itself; record more cycles or less noise: "
        "a release and the ringing after it, or a force that excites the resonance"
    )


def _moves_with_a_mass_that_is_unknown(fit: Fit, errors: np.ndarray) -> bool:
    """Whether mass and frequency, of standard errors (free,), are hard to tell apart and the mass is not known."""
    if fit.oscillator.mass is None or not {"mass", "omega0"} <= set(fit.names):
        return False
    mass, omega0 = fit.names.index("mass"), fit.names.index("omega0")
    both = abs(fit.covariance[mass, omega0]) > STRONG * errors[mass] * errors[omega0]
    return bool(both and errors[mass] > KNOWN * fit.oscillator.mass.value)


def _explains(fit: Fit) -> bool:
    """Whether a fit takes more of the motion than so many unknowns take of noise (Schwarz 1978)."""
    samples = sum(part.segment.n for part in fit.segments)
    unknowns = len(fit.names) + sum(part.initial.size for part in fit.segments)
    left = [min(np.log(max(part.nrmse, np.finfo(float).tiny)), 0) for part in fit.segments]
    gained = -sum(part.segment.n * each for part, each in zip(fit.segments, left, strict=True))
    return bool(2 * gained > unknowns * np.log(samples))

"""What of a response its force does not explain, and the most white noise that either can hold.

A random command has power at every frequency, and so has the acceleration that it makes: neither shows its noise alone.
Together they do. In every band of lines the response is the force times a polynomial of the frequency, and another for
how the motion began and ended; what remains of the lines is noise, and what is not linear (local polynomial method:
Pintelon, Schoukens, Vandersteen and Barbé 2010). Noise on the force is passed on as the force is, so that it is at most
what remains over the squared response in the band where that is least. What a mismatch adds can only make it more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...recording.fact import fact
from ...recording.recording import Recording
from .registry import numerics

_LINES = numerics(
    33, "lines", why="of a band: so many more than the six polynomial terms that a mean is good to a sixth"
)
_TERMS = numerics(3, "terms", why="of each polynomial: a resonance is seldom narrower than a band of parabolas")
_RANK = numerics(1e-6, "of the largest singular value", why="below which force and ends are one smooth line")
_KNOWN = numerics(0.1, "of itself", why="to which a band knows its response, for what remains to be divided by it")
_HIGHEST = numerics(0.375, "of the sampling rate", why="the quarter of the band from which white noise is taken")


@dataclass(frozen=True, eq=False)
class Unexplained:
    """The most white noise (standard deviations) that response and force can hold; inf where that is not told."""

    response: float = np.inf
    force: float = np.inf


@fact("motion", "force")
def unexplained(recording: Recording) -> Unexplained:
    """What the force of a recording, if it has one, leaves of its response, as noise of either."""
    if recording.force is None:
        return Unexplained()
    force, response = (np.asarray(samples, float) for samples in (recording.force, recording.response))
    n, bands = response.size, (response.size // 2 - 1) // _LINES
    if bands < 1 or not np.ptp(force):
        return Unexplained()
    drive, shown = (np.fft.rfft(samples - np.mean(samples))[1 : 1 + bands * _LINES] for samples in (force, response))
    drive, shown = drive.reshape(bands, _LINES), shown.reshape(bands, _LINES)
    size = np.maximum(np.sqrt(np.mean(np.abs(drive) ** 2, axis=1)), np.finfo(float).tiny ** 0.5)
    powers = np.linspace(-1.0, 1.0, _LINES)[:, None] ** np.arange(_TERMS)
    terms = np.concatenate(
        [(drive / size[:, None])[:, :, None] * powers, np.broadcast_to(powers, (bands, _LINES, _TERMS))], axis=2
    )
    left, values, right = np.linalg.svd(terms, full_matrices=False)
    kept = values > _RANK * values[:, :1]
    inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
    parts = np.einsum("bln,bl->bn", left.conj(), shown) * kept
    remains = np.sum(np.abs(shown) ** 2, axis=1) - np.sum(np.abs(parts) ** 2, axis=1)
    remains = np.maximum(remains, 0.0) / (_LINES - np.sum(kept, axis=1)) / n
    passed = np.abs(np.einsum("bn,bn->b", right[:, :, 0].conj(), parts * inverse) / size) ** 2
    doubt = np.sum(np.abs(right[:, :, 0]) ** 2 * inverse**2, axis=1) * remains * n / size**2
    told = (doubt < _KNOWN**2 * passed) & (passed > 0.0)
    highest = (1 + np.arange(bands) * _LINES + _LINES // 2) / n >= _HIGHEST
    return Unexplained(
        float(np.sqrt(np.mean(remains[highest]))) if np.any(highest) else np.inf,
        float(np.sqrt(np.min(remains[told] / passed[told]))) if np.any(told) else np.inf,
    )

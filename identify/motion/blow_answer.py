"""Whether a struck rig moves the way it was struck: a plug may be turned round, or a sensor look the other way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...model.oscillator import QUANTITIES
from .blows import contact_force
from .decay import Blow


def answers_against(blows: Sequence[Blow], force: np.ndarray, response: np.ndarray, period: int, quantity: str) -> bool:
    """Whether the motion that blows set going runs against them.

    A mass goes where it is pushed, whatever holds it: over a cycle from where the force was largest its response is
    nearly that of an undamped linear rig of its own frequency. Blows count by what they set going; what still rings
    from before one belongs to none and has any sign.

    Args:
        blows: of the recording.
        force: (n,) recorded.
        response: (n,) displacement, velocity or acceleration.
        period: samples a cycle of the motion.
        quantity: which of these the response is.
    """
    struck = contact_force(force, blows, period)
    both = own = plain = 0.0
    for blow in blows:
        before = response[blow.before(period) : blow.start]
        peak = blow.start + int(np.argmax(np.abs(struck[blow.start : blow.stop])))  # a band draws a contact out
        first = slice(blow.start, peak + period)
        moved = response[first] - (np.mean(before) if before.size else 0.0)
        expected = _linear_response(struck[first], 2 * np.pi / period, quantity)
        both, own, plain = both + moved @ expected, own + moved @ moved, plain + expected @ expected
    # at a correlation below -1/2 they are more than a third of a cycle apart, which no filter or delay makes of a chain
    # that is meant to show the motion
    return bool(2 * both < -np.sqrt(own * plain))


def _linear_response(force: np.ndarray, omega: float, quantity: str) -> np.ndarray:
    """Response (n,) of x'' + omega² x = force from rest, with time in samples."""
    order = QUANTITIES.index(quantity)
    impulse = np.sin(omega * np.arange(force.size) + order * np.pi / 2) * omega ** (order - 1)
    driven = np.convolve(force, impulse)[: force.size]
    return driven + force if quantity == "acceleration" else driven

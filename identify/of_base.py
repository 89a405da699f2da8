"""What a moving base drives: one mass, or something that takes part in its motion by a factor of its own.

A mass on a spring feels minus the base's acceleration, per unit mass. A mode of a beam, seen at one place, feels that
times its participation factor and its shape there: 1.57 at the tip of a cantilever (Ewins 2000). What a mass would be
is then one over that. One mass is the plainer answer: another factor is asked for only where it leaves more than noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from ..recording.fact import changed
from ..recording.recording import PART, Recording
from .fit.likeliest_modes import odds
from .signals.odds import ABOVE_NOISE, DECISIVE

if TYPE_CHECKING:
    from .identification import Identification


def taking_part(recordings: Sequence[Recording]) -> list[Recording]:
    """The same recordings, where what a base moves takes part in that by a factor."""
    return [changed(recording, base=PART) if recording.rides else recording for recording in recordings]


def of_base(found: Identification, answer: Callable[[list[Recording]], Identification]) -> Identification:
    """The same without a mass or, where that alone leaves no more than noise, with the factor, as one over a mass.

    Args:
        found: of one mass.
        answer: identifies from recordings.
    """
    plain = replace(found, oscillator=replace(found.oscillator, mass=None))
    if max(part.over_noise for part in found.fit.segments) <= ABOVE_NOISE:
        return plain
    other = answer(taking_part(found.recordings))
    noise = max(part.over_noise for part in other.fit.segments) <= ABOVE_NOISE
    if not noise or other.oscillator.mass is None or not odds(other.fit, found.fit) > DECISIVE:
        return plain
    factor = 1.0 / other.oscillator.mass.value
    note = (
        f"the base's acceleration counts {factor:.4g} times what it does for one mass on a spring: what was recorded "
        "is a mode of something longer, or a channel has another gain; mass in the model is one over that"
    )
    return replace(other, notes=(note, *other.notes))

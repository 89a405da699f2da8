"""Free motion in a recording, found by itself: where the force is off, after a blow, or where the motion falls."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...recording.fact import fact
from ...recording.short_decay import LEAST_CYCLES, is_short_decay
from .beating import without_beats
from .blow_answer import answers_against
from .blows import blows_of, ringing
from .decay import Blow, Decay, FreeMotion
from .envelope import SHORTEST_CYCLES, envelope_of
from .excluded_ranges import left_out
from .falling import falling
from .force_off import force_is_silent, force_off, zero_of
from .swings import swings_of

if TYPE_CHECKING:
    from ...recording.recording import Recording

__all__ = ["Blow", "Decay", "FreeMotion", "find_decays", "find_free_motion", "force_is_silent"]


def find_decays(recording: Recording) -> tuple[Decay, ...]:
    """Find the free decays of a recording, in order of time; none is an empty tuple, not an error."""
    return find_free_motion(recording).decays


@fact("name", "response", "force", "fs", "start", "free", "quantity")
def find_free_motion(recording: Recording) -> FreeMotion:
    """Find the free decays of a recording and say what was left out.

    With a force: from the sample after the force went off (its level over a cycle is down at its own noise) to where it
    comes on again. Without one, or with a force that is zero throughout: from where the motion was let go, or a cycle
    after the corner at which its envelope begins to fall, so that no driven part is in it, as long as it falls and
    is not stopped. Both end where the envelope meets the noise of the recording. A recording that is known to be free
    is one decay, and so is one of few cycles whose fall stands out of its own error (``short_decay``).
    """
    if recording.free:
        return FreeMotion((Decay(0, recording.n),))
    x, force = np.asarray(recording.response, float), recording.force
    envelope = envelope_of(recording)
    if envelope is None:
        free = force is None or force_is_silent(recording)
        return FreeMotion((Decay(0, recording.n),) if free and is_short_decay(x, recording.fs) else ())
    period, blows = envelope.period, ()
    if force is None or force_is_silent(recording):
        slow, beats = without_beats(envelope)
        swings, shortest = swings_of(x, envelope), SHORTEST_CYCLES
        decays = falling(x, slow, swings)
        if not decays and not beats:  # few cycles between a hold and a stop: their errors decide, not their number
            shortest = LEAST_CYCLES
            short = falling(x, slow, swings, shortest)
            decays = [d for d in short if is_short_decay(x[d.start : d.stop], recording.fs)]
        if force is not None and np.ptp(force) > 0:
            # white noise may be a shaker's too: only a fall to the noise, or the whole record, is a free decay then
            decays = [
                d for d in decays if envelope.size[d.stop - 1] < 1.1 * envelope.floor or d.stop - d.start > 0.8 * x.size
            ]
    else:
        force = np.asarray(force, float)
        blows = tuple(Blow(*struck) for struck in recording.struck) or blows_of(force, period)
        if answers_against(blows, force, x, period, recording.quantity):
            blows = tuple(replace(blow, answered=False) for blow in blows)
        # a blow says how the motion began, which a decay must show by itself
        beats, shortest = False, LEAST_CYCLES if blows else SHORTEST_CYCLES
        decays = ringing(blows, envelope) if blows else force_off(force - zero_of(force, period)[0], envelope)
    decays = tuple(sorted((d for d in decays if d.stop - d.start >= shortest * period), key=lambda d: d.start))
    motion = FreeMotion(decays, blows)
    return replace(motion, notes=left_out(recording, envelope, motion, beats))

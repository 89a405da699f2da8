"""What of a recording is no free motion, in one sentence: where it stood still, was moved, or was stopped."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...recording.clipping import clipping
from ..signals.odds import HALF_AGAIN
from .decay import Decay, FreeMotion
from .envelope import Envelope

if TYPE_CHECKING:
    from ...recording.recording import Recording

AGAINST = (
    "the response goes against the blows that set it going: the force or the sensor is turned round, or both stand "
    "where this mode moves opposite ways; what rings is used, the blows are not; --calibration response=-1 turns it"
)


def left_out(recording: Recording, envelope: Envelope, motion: FreeMotion) -> tuple[str, ...]:
    """Sentences for the user; none where the whole motion is used.

    The noise that a decay ends in needs no word. Where a force was recorded, what lies between decays is driven by it.
    """
    if not (motion.decays or motion.blows):
        return ()
    sentences = []
    if motion.blows:
        sentences += _of_blows(recording, motion)
    else:
        parts = [] if _driven(recording) else _gaps(recording, envelope, motion.decays)
        if parts:
            used = " and ".join(_span(recording, decay.start, decay.stop) for decay in motion.decays)
            sentences.append(f"{recording.name}: free motion is used, {used}; left out: {', '.join(parts)}")
    return tuple(sentences)


def swelling(recording: Recording, swell: tuple[int, int]) -> str:
    """That nothing of a recording is known to be free, as it grows between two samples without a force."""
    force = recording.force
    none = "there is no force" if force is None else f"the force is {force[0]:.4g} {recording.force_unit} throughout"
    first, last = (_at(recording, sample) for sample in swell)
    return (
        f"{recording.name}: {none} while the response grows swing by swing from {first} to {last} s, so that "
        "something drives it that was not recorded; was the force recorded? Record it with the response, or a release "
        "and the ringing after it"
    )


def _of_blows(recording: Recording, motion: FreeMotion) -> list[str]:
    sentences = []
    twice = [_at(recording, blow.start) for blow in motion.blows if blow.contacts > 1]
    if twice:
        sentences.append(f"{recording.name}: the hammer hit more than once at {', '.join(twice)} s")
    clipped = [_at(recording, blow.start) for blow in motion.blows if blow.clipped]
    if clipped:
        sentences.append(
            f"{recording.name}: the force of the blow at {', '.join(clipped)} s is clipped; the ringing after it is "
            "used, the blow is not"
        )
    if not all(blow.answered for blow in motion.blows):
        sentences.append(f"{recording.name}: {AGAINST}")
    return sentences


def _gaps(recording: Recording, envelope: Envelope, decays: tuple[Decay, ...]) -> list[str]:
    size, period = envelope.size, envelope.period
    rails = clipping(np.asarray(recording.response, float))
    edges = [0, *(edge for decay in decays for edge in (decay.start, decay.stop)), recording.n]
    parts = []
    for k, (a, b) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
        # the envelope's kernel reaches a cycle into what is left out, and what was let go is not still before
        inside = size[a if k == 0 else min(a + period, b) : b if k == len(decays) else max(a, b - 2 * period)]
        if b - a <= period:
            continue
        moved = inside.size > 0 and float(np.max(inside)) > 2 * envelope.floor
        stopped = k > 0 and size[a - 1] > HALF_AGAIN * envelope.floor
        if not moved and not stopped and k > 0:
            continue  # it faded
        what = "moved by something that was not recorded" if moved else "at rest or held"
        what = f"stopped, {what}" if stopped else what
        cut = any(rail.first < b and rail.last >= a for rail in rails)
        parts.append(f"{_span(recording, a, b)} ({'clipped' if cut else what})")
    return parts


def _driven(recording: Recording) -> bool:
    from .force_off import force_is_silent

    return recording.force is not None and not force_is_silent(recording)


def _span(recording: Recording, a: int, b: int) -> str:
    return f"{_at(recording, a)} to {_at(recording, b)} s"


def _at(recording: Recording, sample: int) -> str:
    return f"{recording.start + sample / recording.fs:.4g}"

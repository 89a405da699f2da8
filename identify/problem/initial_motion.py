"""Where each stretch begins: displacement and velocity at its first sample, from the signal itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...model.oscillator import QUANTITIES
from ..motion.first_motion import first_motion
from ..signals.registry import numerics
from .segments import Segment

_FEWEST = numerics(4, "samples", why="for a mean, a cosine and a sine, and one that is left")


def initial_states(segments: Sequence[Segment], offsets: Sequence[float] | None = None) -> np.ndarray:
    """(segments, 2) displacement and velocity at each segment's first sample; zero where it begins at rest.

    Of a displacement by a parabola through its beginning; of a velocity or an acceleration by the line at the motion's
    own frequency in its first cycle, divided by that frequency (x0 = -a / omega² and its like): a start at zero would
    be one that friction holds.

    Args:
        segments: stretches of recordings.
        offsets: (segments,) what the sensor shows at zero.
    """
    states = np.zeros((len(segments), 2))
    for i, segment in enumerate(segments):
        if segment.rests:
            continue
        response = segment.response - (0.0 if offsets is None else offsets[i])
        if segment.quantity == "displacement":
            states[i] = first_motion(response, segment.dt, segment.pace)[0]
        else:
            states[i] = from_first_cycle(response, segment.dt, segment.pace, segment.quantity)
    return states


def from_first_cycle(response: np.ndarray, dt: float, pace: float, quantity: str) -> tuple[float, float]:
    """Displacement and velocity at the first sample, by the line at ``pace`` (rad/s) in the first cycle of (n,)."""
    count = int(np.clip(round(2 * np.pi / pace / dt), _FEWEST, response.size))
    turn = pace * dt * np.arange(count)
    columns = np.column_stack([np.ones(count), np.cos(turn), np.sin(turn)])
    _, cosine, sine = np.linalg.lstsq(columns, response[:count])[0]
    phasor = complex(cosine, -sine) / (1j * pace) ** QUANTITIES.index(quantity)
    return phasor.real, (1j * pace * phasor).real

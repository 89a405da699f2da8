"""The force of an element along a motion: of a recording, or of samples of one's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from ..model.covered import element_beyond
from ..model.dependence import beyond
from ..model.element import Element
from ..recording import Recording
from ..recording.frequency import frequency_of
from ..recording.plain_numbers import vector_of
from ..recording.prescribed import refuse_free
from ..simulate.imposed import force_along, spline_of


@dataclass(frozen=True, eq=False)
class AlongRecording:
    """The force of an element along a recorded motion.

    Attributes:
        columns: (n,) each, by name with unit: time, displacement, the recorded force where there is one, the force.
        left: what is left of the recorded force as NRMSE; None where there is none, or it never changes.
        notes: what is to be known, a sentence each.
    """

    columns: Mapping[str, np.ndarray]
    left: float | None
    notes: tuple[str, ...]


def under_a_motion(
    element: Element, displacement: Any, fs: Any, channels: Mapping[str, Any]
) -> tuple[np.ndarray, list[str]]:
    """(n,) force along samples (n,) of a displacement at ``fs`` Hz, and sentences on what goes beyond what was covered.

    For arguments and errors see ``ForceElement.force``.
    """
    motion, rate = vector_of(displacement, "the displacement"), frequency_of(fs)
    if motion.ndim != 1 or motion.size < 4:
        raise BadInput(f"the displacement has the shape {motion.shape}; give at least four numbers in one row")
    if (bad := np.flatnonzero(~np.isfinite(motion))).size:
        raise BadInput(
            f"the displacement has {bad.size} value(s) that are not a number, the first at place {bad[0]}; fill them "
            "in, or cut that part out"
        )
    if not 0.0 < rate < np.inf:
        raise BadInput(f"fs is {rate:g}; the sampling frequency is a positive number, in Hz")
    beside = {name: vector_of(np.atleast_1d(values), name) for name, values in channels.items()}
    for name, values in beside.items():
        if name not in element.channels:
            there = ", ".join(element.channels) or "none"
            raise BadInput(f"{element.name} depends on no channel {name!r}; it has {there}")
        if values.shape not in ((1,), motion.shape) or not np.all(np.isfinite(values)):
            raise BadInput(f"the channel {name} must be one number, or {motion.size} as the displacement has")
    velocity, _ = spline_of(motion, 1.0 / rate)
    said = _beyond(element, motion, velocity, beside)
    return force_along(element, motion, 1.0 / rate, channels=beside), said


def along_recording(element: Element, recordings: Sequence[Recording]) -> AlongRecording:
    """The force along the motion of one recording, whether or not its force was recorded.

    Raises BadInput where there are several recordings, its motion was not prescribed, or a channel is missing.
    """
    from ..prescribed.motion import moved, unit_of_motion

    refuse_free(recordings)
    if len(recordings) != 1:
        raise BadInput(f"simulate writes one force, and {len(recordings)} records were given; name one of them")
    (recording,) = recordings
    motion, own = moved(recording), unit_of_motion(recording)
    if own != element.unit:
        raise BadInput(
            f"{motion.name}: the motion is in {own}, and {element.name} has it in {element.unit}; say what the column "
            "is with --prescribed and --unit"
        )
    units = {channel.name: channel.unit for channel in recording.channels}
    for name, one in element.channels.items():
        if name not in units:
            raise BadInput(
                f"{motion.name}: {element.name} depends on the {name}, and nobody says what it was; give it with "
                f"--channel {name}=NUMBER, in {one.unit}, or name its column"
            )
        if units[name] != one.unit:
            raise BadInput(
                f"{motion.name}: the channel {name} is in {units[name]}, and {element.name} has it in {one.unit}"
            )
    made = force_along(element, motion.displacement, motion.dt, start=motion.start, channels=motion.channels)
    notes = _beyond(element, motion.displacement, motion.velocity[motion.told], motion.channels)
    notes += [f"nothing depends on the {name}; it is left out" for name in units if name not in element.channels]
    unit, force_unit = element.unit.replace("/", "_"), element.force_unit.replace("/", "_")
    columns, left = {"time_s": motion.time, f"displacement_{unit}": motion.displacement}, None
    if recording.force is not None:
        force = np.asarray(recording.force, float)
        columns[f"measured_{force_unit}"] = force
        moves = force[motion.told]
        if moves.size and np.ptp(moves) > 0.0:
            left = float(np.std((force - made)[motion.told]) / np.std(moves))
    return AlongRecording({**columns, f"force_{force_unit}": made}, left, tuple(notes))


def _beyond(
    element: Element, displacement: np.ndarray, velocity: np.ndarray, channels: Mapping[str, np.ndarray]
) -> list[str]:
    """Sentences on a motion (n,) and channels that leave what the recordings covered."""
    reach = float(np.max(np.abs(displacement - element.origin)))
    said = element_beyond(element, reach, float(np.max(np.abs(velocity), initial=0.0)))
    ends = [{name: float(end(values)) for name, values in channels.items()} for end in (np.min, np.max)]
    return said + beyond(element.dependences, *ends)

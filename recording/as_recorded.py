"""Values of a recording as a person knows them: in the unit that its file has, mm where it has mm, and not in m."""

from __future__ import annotations

from .recording import Recording
from .units import find_unit


def scale_of_unit(unit: str, recorded: str) -> tuple[float, str]:
    """By how much a value in the SI ``unit`` is more in the ``recorded`` one, and that; 1 where it is no other."""
    found = find_unit(recorded) if recorded else None
    return (1.0, unit) if found is None or found.si != unit else (1.0 / found.factor, found.text)


def of_response(recording: Recording) -> tuple[float, str]:
    """Factor and unit in which the response was recorded."""
    return scale_of_unit(recording.unit, recording.recorded_unit)


def of_force(recording: Recording) -> tuple[float, str]:
    """The same of the force."""
    return scale_of_unit(recording.force_unit, recording.recorded_force_unit)

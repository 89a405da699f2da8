"""Values of a recording as a person knows them: in the unit that its file has, mm where it has mm, and not in m."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from .recording import Recording
from .units import find_unit

#: By how much a value in it is more than in SI, and its text.
InUnit = tuple[float, str]
#: Values (n,) in SI, what they are, and one of them in words.
Signal = tuple[np.ndarray, str, Callable[..., str]]


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


def of_length(recordings: Sequence[Recording], own: str) -> InUnit:
    """Factor and unit of a length or an angle in SI, ``own``, as recordings had it: mm where all had mm or mm/s."""
    known = {recording.recorded_unit.partition("/")[0] for recording in recordings}
    return scale_of_unit(own, known.pop() if len(known) == 1 else "")


def said_of(recording: Recording, value: float, digits: int = 4, *, force: bool = False) -> str:
    """``0.365 mm``: a value of the response, or of the force, given in SI, in words."""
    factor, unit = of_force(recording) if force else of_response(recording)
    return f"{factor * value:.{digits}g} {unit}"


def signals_of(recording: Recording) -> list[Signal]:
    """The response, and the force where there is one."""
    signals: list[Signal] = [(recording.response, "response", partial(said_of, recording))]
    if recording.force is not None:
        signals.append((recording.force, "force", partial(said_of, recording, force=True)))
    return signals

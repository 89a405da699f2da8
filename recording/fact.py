"""What a recording is, measured once: a recording never changes, so what was measured of it stays true."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from functools import wraps
from typing import Any, TypeVar

from .recording import Recording

T = TypeVar("T")

#: Fields of a recording that no signal follows from.
_WORDS = frozenset(
    {"notes", "sha256", "hold", "differs", "base", "prescribed", "channels"} | {"recorded_unit", "recorded_force_unit"}
)
_ALL = frozenset(field.name for field in fields(Recording)) - _WORDS


def fact(*rests_on: str) -> Callable[[Callable[[Recording], T]], Callable[[Recording], T]]:
    """Make a function of a recording a fact of it: measured when first asked for, known from then on.

    Args:
        rests_on: fields of the recording that it follows from; all but notes, hash and hold where none is named. Where
            ``changed`` leaves these as they are, the changed recording knows it too. ``motion`` in place of
            ``response`` is what this shows but for a zero of its sensor.
    """
    needs = frozenset(rests_on) or _ALL

    def made(measure: Callable[[Recording], T]) -> Callable[[Recording], T]:
        name = f"{measure.__module__}.{measure.__qualname__}"

        @wraps(measure)
        def known(recording: Recording) -> T:
            if name not in recording.known:
                recording.known[name] = (measure(recording), needs)
            return recording.known[name][0]

        return known

    return made


def changed(recording: Recording, *, same_motion: bool = False, **changes: Any) -> Recording:
    """``dataclasses.replace``, where what is known and does not rest on what is changed stays known.

    Args:
        recording: as it is.
        same_motion: whether its response changes by the zero of its sensor alone, or by how that drifts.
        changes: by field.
    """
    other = replace(recording, **changes)
    moved = {name for name, value in changes.items() if value is not getattr(recording, name)}
    moved |= {"motion"} if "response" in moved and not same_motion else set()
    other.known.update({name: known for name, known in recording.known.items() if not known[1] & moved})
    return other

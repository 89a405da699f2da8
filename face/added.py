"""Identification with recordings to which a known mass or stiffness was added; see ``identify.added``."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..files.arguments import number_of
from .workflow import identified

if TYPE_CHECKING:
    from ..identify.added import Added
    from ..identify.identification import Identification
    from ..recording import Recording

#: Base exponents of what may be added to a motion along a line and about an axis, and how each is written.
_KINDS = {
    "mass": (({"kg": 1}, {"kg": 1, "m": 2}), "0.5 kg or 2 kg.m2"),
    "stiffness": (({"kg": 1, "s": -2}, {"kg": 1, "m": 2, "s": -2}), "200 N/m or 3 N.m/rad"),
}


def identified_with_added(
    read: Callable[[], Sequence[Recording]],
    masses: Mapping[str, float | str],
    stiffnesses: Mapping[str, float | str],
    *,
    every: bool = False,
    fixed: Mapping[str, float | str] | None = None,
    **how: Any,
) -> Identification:
    """Identify a rig from recordings as it is and with something added; other arguments as ``identified`` has them.

    Args:
        read: gives the recordings of one rig.
        masses, stiffnesses: what was added, by a recording's name, file or a pattern of it: in SI, or with a unit.
        every: whether members of Eq. 17 stay that the recordings as it is do not tell from none.
        fixed: parameters that keep a value.

    Raises:
        BadInput: nothing is told of a recording that is named, or of none is it told that nothing was added.
    """
    from ..identify.added import Added, absent, with_what_was_added

    if how.get("mass") is not None or "mass" in (fixed or {}):
        raise BadInput("the mass was given, and what was added tells it; leave one of them out")
    recordings = read()
    sizes = {kind: _of_each(given, kind, recordings) for kind, given in (("mass", masses), ("stiffness", stiffnesses))}
    sets: dict[Added, list[Recording]] = {}
    for i, recording in enumerate(recordings):
        sets.setdefault(Added(sizes["mass"][i], sizes["stiffness"][i]), []).append(recording)
    plain = sets.pop(Added(), None)
    if plain is None:
        raise BadInput("something was added to every recording; give at least one of the rig as it is")
    as_it_is = identified(lambda: plain, every=every, fixed=fixed, **how)
    kept = {**absent(as_it_is), **(fixed or {})}
    others = [
        (added, identified(lambda part=part: part, every=True, fixed=kept, **how)) for added, part in sets.items()
    ]
    return with_what_was_added(as_it_is, others)


def _of_each(given: Mapping[str, float | str], kind: str, recordings: Sequence[Recording]) -> list[float]:
    """What was added to each recording, in SI; raises BadInput for a name that none has, and for another unit."""
    from ..model.quantity import in_base_units, said

    fit, example = _KINDS[kind]
    made = [0.0] * len(recordings)
    for pattern, value in given.items():
        if not isinstance(value, str):
            size = number_of(value, f"the {kind} added to {pattern}")
        else:
            number, unit = said(value, f"the {kind} added to {pattern}")
            factor, have = in_base_units(unit, f"the {kind} added to {pattern}") if unit else (1.0, fit[0])
            if {symbol: power for symbol, power in have.items() if symbol != "rad"} not in fit:
                raise BadInput(f"the {kind} added to {pattern} is {value!r}; give it such as {example}")
            size = number * factor
        if not (math.isfinite(size) and size):
            raise BadInput(f"the {kind} added to {pattern} is {value}; give it such as {example}")
        named = [i for i, r in enumerate(recordings) if any(fnmatchcase(n, pattern) for n in _names(r))]
        if not named:
            there = ", ".join(recording.name for recording in recordings[:5])
            raise BadInput(f"no recording is called {pattern!r}, to which something was added; there are {there}")
        for i in named:
            made[i] += size
    return made


def _names(recording: Recording) -> tuple[str, ...]:
    file = recording.name.partition("#")[0]
    return recording.name, file, Path(file).name

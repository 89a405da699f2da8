"""A part of a recording, in seconds from its first sample: a test to be left out, a start-up to be cut away."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import BadInput
from ..files.arguments import number_of, shown
from .recording import Recording


def parse_part(text: str) -> tuple[float, float]:
    """``FROM:TO`` in seconds, either side may be empty; raises BadInput for anything else."""
    begin, colon, end = text.partition(":")
    try:
        part = (float(begin) if begin.strip() else 0.0, float(end) if end.strip() else math.inf)
    except ValueError:
        colon, part = "", (0.0, 0.0)
    if not colon or not part[0] < part[1] or not part[1] > 0:
        raise BadInput(
            f"part {text!r} is not understood; write FROM:TO in seconds from the first sample, such as 2:30 or 5:"
        )
    return part


def part_of(given: Any) -> tuple[float, float] | None:
    """A part as a text, empty for all, or as two numbers of seconds; raises BadInput for anything else."""
    if isinstance(given, str):
        return parse_part(given) if given else None
    if not isinstance(given, list | tuple) or len(given) != 2:
        raise BadInput(f"part must be such as '2:30' or (2.0, 30.0), not {shown(given)}")
    begin, end = (number_of(side, "a side of part") for side in given)
    if not begin < end or not end > 0:
        raise BadInput(f"part {shown(given)} ends before it begins, or before the first sample; give (FROM, TO) in s")
    return begin, end


def cut_out(recording: Recording, part: tuple[float, float]) -> Recording:
    """The samples from ``part[0]`` to ``part[1]`` s after the first one.

    Raises:
        BadInput: where the recording ends before the part begins.
    """
    begin, end = part
    _begins_within(recording.name, begin, recording.duration)
    first = max(0, math.ceil(begin * recording.fs - 1e-6))
    last = recording.n if math.isinf(end) else min(recording.n, math.ceil(end * recording.fs - 1e-6))
    used = recording.slice(first, last)
    if used.n == recording.n:
        return recording
    return replace(used, notes=(*recording.notes, _said(recording.name, part, recording.duration)))


def rows_of(where: str, time: np.ndarray, part: tuple[float, float]) -> tuple[slice, tuple[str, ...]]:
    """The rows of a part by their time stamps (n,), in s, and what is to be said of it.

    Rows are chosen before the stamps are looked at any closer: a gap outside of the part is none of its own.

    Raises:
        BadInput: where the recording ends before the part begins, or no sample lies in it.
    """
    begin, end = part
    since = time - time[0]
    steps = np.diff(since)
    after = float(since[-1]) + float(np.median(steps)) if steps.size and np.all(np.isfinite(since)) else np.inf
    _begins_within(where, begin, after)
    hair = 1e-6 * abs(float(np.median(steps))) if steps.size else 0.0
    inside = np.flatnonzero((since >= begin - hair) & (since < end - hair))
    if not inside.size and np.all(np.isfinite(since)):
        raise BadInput(f"{where}: no sample lies between {begin:.6g} and {end:.6g} s; choose a longer part")
    if inside.size in (0, since.size):  # none where stamps are no numbers, which is said of them
        return slice(None), ()
    return slice(int(inside[0]), int(inside[-1]) + 1), (_said(where, part, after),)


def _begins_within(where: str, begin: float, duration: float) -> None:
    if begin >= duration:
        raise BadInput(
            f"{where}: lasts {duration:.6g} s, and the part to use begins at {begin:.6g} s; choose an earlier part"
        )


def _said(where: str, part: tuple[float, float], duration: float) -> str:
    return f"{where}: {part[0]:.6g} to {min(part[1], duration):.6g} s are used, the rest is left out"

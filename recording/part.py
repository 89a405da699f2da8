"""A part of a recording, in seconds from its first sample: a test to be left out, a start-up to be cut away."""

from __future__ import annotations

import math
from dataclasses import replace

from ..errors import BadInput
from .recording import Recording


def parse_part(text: str) -> tuple[float, float]:
    """``FROM:TO`` in seconds, either side may be empty; raises BadInput for anything else."""
    begin, colon, end = text.partition(":")
    try:
        part = (float(begin) if begin.strip() else 0.0, float(end) if end.strip() else math.inf)
    except ValueError:
        colon, part = "", (0.0, 0.0)
    if not colon or not part[0] < part[1] or math.isnan(part[0]):
        raise BadInput(
            f"part {text!r} is not understood; write FROM:TO in seconds from the first sample, such as 2:30 or 5:"
        )
    return part


def cut_out(recording: Recording, part: tuple[float, float]) -> Recording:
    """The samples from ``part[0]`` to ``part[1]`` s after the first one.

    Raises:
        BadInput: where the recording ends before the part begins.
    """
    begin, end = part
    if begin >= recording.duration:
        raise BadInput(
            f"{recording.name}: lasts {recording.duration:.6g} s, and the part to use begins at {begin:.6g} s; "
            "choose an earlier part"
        )
    first = max(0, math.ceil(begin * recording.fs - 1e-6))
    last = recording.n if math.isinf(end) else min(recording.n, math.ceil(end * recording.fs - 1e-6))
    used = recording.slice(first, last)
    if used.n == recording.n:
        return recording
    sentence = f"{recording.name}: {begin:.6g} to {min(end, recording.duration):.6g} s are used, the rest is left out"
    return replace(used, notes=(*recording.notes, sentence))

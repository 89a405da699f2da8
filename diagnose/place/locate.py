"""Where a model and the recordings differ beyond the noise: ranges, harmonic orders, and one sentence to act on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import DashpotError
from ...identify.problem.data import Data
from ...identify.problem.structure import Fitted
from ..limits import LEAST_EVIDENCE
from ..result import Location, RecordFit
from .equation_error import equation_error
from .mismatch_ranges import excess_range
from .shares_by_blocks import depends_on
from .statement import how_far_off, in_which_recordings, what_it_follows
from .what_it_follows import Symptoms, symptoms


def locate(fitted: Fitted, data: Data, records: Sequence[RecordFit] = ()) -> Location:
    """Say where the mismatch lies.

    Displacement, velocity and harmonic orders are those of the missing force (see ``equation_error``), since a free-run
    residual shows a wrong force only later, as a phase error. ``path`` is a guess from the symptoms alone.

    Args:
        fitted: the best fit of the given family.
        data: what it was fitted to.
        records: what its free simulation leaves of each recording, for the sentence.
    """
    model = fitted.model
    if not np.all(np.isfinite(list(model.values().values()))):
        return _everywhere(data, "the place is not known: the model has values that are no numbers")
    try:
        stretches, evidence = equation_error(model, data)
    except (DashpotError, np.linalg.LinAlgError) as problem:
        return _everywhere(data, f"the place is not known: {problem}")
    if not stretches:
        return _everywhere(data, "the place is not known: the recordings move too little or for too few cycles")
    off = how_far_off(records)
    if evidence < LEAST_EVIDENCE:
        return _everywhere(data, f"no missing force stands out of the noise in any recording{off}")
    signature = symptoms(stretches)
    if not signature.here:
        return _everywhere(data, f"too little stands out of the noise in any one recording to tell where{off}")
    return _location(signature, data, fitted, off)


def _everywhere(data: Data, statement: str) -> Location:
    """The widest ranges, with an honest sentence."""
    length, speed = data.scales.length, data.scales.length * data.scales.omega
    nyquist = max(r.fs / 2 for r in data.recordings)
    return Location(
        path="unknown",
        statement=statement,
        displacement=(-length, length),
        velocity=(-speed, speed),
        amplitude=(0.0, length),
        frequency_hz=(0.0, nyquist),
        time_s=(min(r.start for r in data.recordings), max(r.start + r.duration for r in data.recordings)),
        recordings=tuple(r.name for r in data.recordings),
        harmonics={},
    )


def _location(signature: Symptoms, data: Data, fitted: Fitted, off: str) -> Location:
    rows, model = signature.rows, fitted.model
    wide = _everywhere(data, "")
    x, v = rows.joined(lambda s: s.x), rows.joined(lambda s: s.v)
    ranges = {
        "displacement": excess_range(rows, x) or (float(np.min(x)), float(np.max(x))),
        "velocity": excess_range(rows, v) or (float(np.min(v)), float(np.max(v))),
        "amplitude": excess_range(rows, rows.joined(lambda s: s.amplitude)) or wide.amplitude,
        "frequency_hz": excess_range(rows, rows.joined(lambda s: s.frequency_hz)) or wide.frequency_hz,
        "time_s": excess_range(rows, rows.joined(lambda s: s.time)) or wide.time_s,
    }
    what, narrower = what_it_follows(signature, model, ranges)
    ranges |= narrower
    names = [r.name for r in data.recordings]
    return Location(
        path=signature.path,
        statement=f"{what}; {in_which_recordings(signature, names)}{off}",
        displacement=ranges["displacement"],
        velocity=ranges["velocity"],
        amplitude=ranges["amplitude"],
        frequency_hz=ranges["frequency_hz"],
        time_s=ranges["time_s"],
        recordings=signature.here or tuple(names),
        harmonics=signature.orders,
        depends_on=depends_on(signature, base_moves=model.is_base_driven),
    )

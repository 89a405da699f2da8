"""The improvement shown with the artefact: the mended model as an FMU, run under FMPy on what was held out.

And the mended model fitted to all there is, once a part of it has judged what is missing (``fitted_to_all``). Where the
user holds nothing out, stretches of every recording are, and a model that has seen two thirds of a decay tells the
phase of the whole one by so much worse. What is named, and what the table shows, is judged by what was held out; what
is delivered then needs no judge any more and may learn from it too (cross-validation: Stone 1974).
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import BadInput, DashpotError
from ..export.fmu import export_fmu
from ..export.platforms import own_platform
from ..identify.faults.spread import with_spread
from ..identify.fit.climb import POOR_NRMSE
from ..identify.fit.likelihood import maximum_likelihood
from ..identify.problem.replay import force_of, replay, replayed
from ..identify.provenance import with_provenance
from ..identify.signals.odds import ABOVE_NOISE
from ..model import Oscillator, Response
from ..model.left import rms, share_of_motion
from ..recording.recording import Recording
from ..verify.fmu_run import FmuRun, FmuStopped
from ..verify.noise_floor import floor_of_model, pieces
from .limits import COMPUTED
from .result import RecordFit
from .search.judgement import MATTERS

#: The sentence about it.
FITTED_TO_ALL = "the model is fitted to what was held out too; the table is of the same structure fitted without"


def record_fits(
    before: Oscillator,
    after: Oscillator | None,
    recordings: Sequence[Recording],
    *,
    holdout: bool,
    fmu: Path | None = None,
) -> list[RecordFit]:
    """Free runs of the family's best and of the mended model along recordings.

    Args:
        before: best of the given family.
        after: mended model; None where nothing was mended.
        recordings: what they are held against.
        holdout: whether no parameter was fitted to them.
        fmu: the mended model exported; its response is then the FMU's under FMPy, and none from where that stops.
    """
    with FmuRun(fmu) if fmu is not None and after is not None else nullcontext() as run:
        return [fit for r in recordings if (fit := _fit(before, after, r, holdout, run)) is not None]


def no_finding(records: Sequence[RecordFit], share: float | None) -> str | None:
    """Why the best of all structures is nothing to name; None where it is.

    However much more probable it is than all others by what is predicted from a cycle or two before: a model is used in
    free simulation, and that is where it must be seen to improve.

    Args:
        records: all recordings.
        share: of what the family lacks that it takes away in free simulation; None where the family lacks nothing.
    """
    held = [record for record in records if record.holdout]
    if not follows_any([record for record in records if not record.holdout]):
        return "follows no recording either"
    if not takes_something(records):
        return "takes nothing away that a sensor could have shown"
    if share is not None and share < MATTERS:
        return "takes nothing away of what the model lacks where it is simulated freely"
    if held and not follows_any(held):
        return "follows nothing of what was held out"
    if tells_worse(held or records):  # where nothing was held out the others stand in
        return f"explains {'what was held out' if held else 'the recordings'} worse than the given family"
    if lost := [r.file for r in records if follows_any([unmended(r)]) and not follows_any([r])]:
        return f"no longer follows {lost[0]}, which the given family does"
    if held and not tells_better(held):
        return "leaves as much of what was held out as the given family, and that is more than its noise"
    return None


def tells_better(records: Sequence[RecordFit]) -> bool:
    """Whether the mended model leaves less, on average by what the noise is known to; or nowhere more than noise."""
    at_noise = all(r.nrmse_after <= ABOVE_NOISE * r.noise_floor for r in records)
    return at_noise or _change(records) <= -2.0 * np.log(ABOVE_NOISE)


def tells_worse(records: Sequence[RecordFit]) -> bool:
    """Whether the mended model leaves more, by enough to matter: by its factor on average, as a search measures.

    A quiet end that both explain badly would else outweigh all the motion before it.
    """
    return _change(records) > np.log1p(MATTERS)


def _change(records: Sequence[RecordFit]) -> float:
    """Logarithm of the factor by which the power that is left changes, on average over the recordings."""
    return float(np.mean([2.0 * np.log(after / before) for before, after in map(_errors, records)]))


def _errors(record: RecordFit) -> tuple[float, float]:
    """What a recording is left with, its noise at least, before and after; what runs away counts as all but endless."""
    least = max(record.noise_floor, np.finfo(float).tiny)
    found = (max(error, least) for error in (record.nrmse_before, record.nrmse_after))
    before, after = (error if np.isfinite(error) else 1.0 / np.finfo(float).eps for error in found)
    return before, after


def unmended(record: RecordFit) -> RecordFit:
    """A recording's row where nothing is mended."""
    return replace(record, nrmse_after=record.nrmse_before, after=record.before)


def follows_any(records: Sequence[RecordFit]) -> bool:
    """Whether the mended model's free simulation follows any recording: to half its motion, or to its noise."""
    return any(r.nrmse_after <= max(POOR_NRMSE, ABOVE_NOISE * r.noise_floor) for r in records)


def takes_something(records: Sequence[RecordFit]) -> bool:
    """Whether the mended model takes anything away that a sensor could have shown.

    Less than half of its noise is in no measured record. Where most are so, they were computed, and what tells two
    models apart there is how.
    """
    computed = [r.nrmse_before < COMPUTED * r.noise_floor for r in records]
    return 2 * sum(computed) <= len(computed)


def fitted_to_all(model: Oscillator, recordings: Sequence[Recording], fixed: Sequence[str]) -> Oscillator | None:
    """The model with the parameters that suit whole recordings best; None where it tells them worse.

    Args:
        model: mended, from stretches of these recordings; its values are where the fit starts.
        recordings: uncut.
        fixed: parameters that keep their values.
    """
    try:
        fit, _ = with_spread(maximum_likelihood(model, recordings, fixed, near=True), recordings)
    except BadInput:  # stretches may simulate where nothing follows the whole
        return None
    found = replace(
        with_provenance(fit, recordings), amplitude=model.amplitude, frequency=model.frequency, hold=model.hold
    )
    records = record_fits(model, found, recordings, holdout=False)
    return None if not records or tells_worse(records) else found


def exported(model: Oscillator, path: Path) -> Path | None:
    """The model as an FMU for this machine, where it is run at once; None where there is no compiler."""
    try:
        return export_fmu(model, path, backend="native", platforms=(own_platform(),))
    except DashpotError:
        return None


def _fit(
    before: Oscillator, after: Oscillator | None, recording: Recording, holdout: bool, run: FmuRun | None
) -> RecordFit | None:
    times, forces, measured, old, new, noise = [], [], [], [], [], []
    for part in pieces(recording):
        piece = part.recording
        first = replay(before, piece)
        second = first
        model = before
        if after is not None:
            model = after
            there = replayed(after, piece)
            second = there.response
            if run is not None and not piece.differs:  # the FMU has the means
                force, output = force_of(piece), run.output_for(recording)
                force = force if force is None else force.shifted(-there.load)
                try:
                    second = run.record(force, piece.n, piece.dt, there.initial, piece.start, output)
                except FmuStopped as stopped:  # a motion that runs away is a finding about the model
                    second = stopped.of(piece.n)
                second = second + there.shown(piece.dt)
        times.append(piece.time)
        measured.append(np.asarray(piece.response, float))
        forces.append(np.zeros(piece.n) if piece.force is None else np.asarray(piece.force, float))
        old.append(first)
        new.append(second)
        left = min(rms([simulated - measured[-1]]) for simulated in (first, second))
        noise.append(np.full(piece.n, floor_of_model(model, part, left)))
    if not times:
        return None
    y, first, second = (np.concatenate(parts) for parts in (measured, old, new))
    force = np.concatenate(forces)
    return RecordFit(
        recording.name,
        holdout,
        share_of_motion([first - y], [y]),
        share_of_motion([second - y], [y]),
        share_of_motion([np.concatenate(noise)], [y]),
        np.concatenate(times),
        y,
        first,
        second,
        force if np.any(force) else None,
        Response(recording.quantity, recording.unit),
    )

"""What a model file says of where its values come from and how far they have been seen to hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from ..files.made_by import made_by
from ..model import Oscillator, Provenance, Range
from ..model.fit_state import LACKING
from ..model.oscillator import Band
from ..recording.recording import Recording
from .fit.reported_result import Fit, SegmentFit
from .hilbert.curves import backbone_omega0
from .left import left_of_recording
from .motion.blows import ContactForce
from .motion.excitation import band_of
from .signals.odds import SIGNIFICANT
from .start.start import Curve


def with_provenance(
    fit: Fit,
    recordings: Sequence[Recording],
    *,
    curves: Sequence[Curve] = (),
    kinds: Sequence[str] = (),
    band: Band | None = None,
    faults: Mapping[int, str] = MappingProxyType({}),
) -> Oscillator:
    """The fitted model with the range that the recordings covered, and with the covariance of its values.

    Args:
        fit: to these recordings.
        recordings: what was fitted.
        curves: measured backbones, for the least amplitude and, where no force has a band, the frequencies.
        kinds: of each recording, for the model file.
        band: in which one of several modes was isolated.
        faults: what the measuring chain did to a recording, by its place, for the model file.
    """
    model = fit.oscillator
    unit = model.response.displacement_unit
    known = _seen(curves, fit, recordings)
    floor = min((float(curve.amplitude.min()) for curve in known), default=0.0)
    peak = max(float(np.max(np.abs(_moved(s, fit, s.segment.recording in faults)))) for s in fit.segments)
    # a hammer's force reaches far beyond what it sets going
    struck = {s.segment.recording for s in fit.segments if isinstance(s.segment.force, ContactForce)}
    bands = [band_of(r) for i, r in enumerate(recordings) if i not in struck]
    frequencies = [f for band in bands if band for f in band]
    if not frequencies:
        rates = [c.omega0 for c in known]
        if not model.terms:  # at its end a curve swings with what an integration leaves there, and the model does not
            spring = model.omega0.value, model.cubic.value, model.preload.value
            rates = [backbone_omega0(c.amplitude, *spring) for c in known]
            rates = [rate if np.all(np.isfinite(rate)) else c.omega0 for rate, c in zip(rates, known, strict=True)]
        frequencies = [float(f) / (2 * np.pi) for rate in rates for f in (rate.min(), rate.max())]
    if not frequencies:
        frequencies = [model.omega0.value / (2 * np.pi)]
    files: list[dict[str, Any]] = [{"file": r.name, "sha256": r.sha256} for r in recordings]
    for file, kind in zip(files, kinds, strict=False):
        file["kind"] = kind
    zeros = {offset.recording: offset.value for offset in fit.offsets if offset.channel == "response"}
    for index, file in enumerate(files):
        file |= unit_of_file(recordings[index])
        file |= {"zero": float(zeros[index])} if index in zeros else {}
        left = left_of_recording(fit, index)
        file |= {} if left is None else left.as_json()
        if index in faults:
            file["fault"] = faults[index]
    return replace(
        model,
        amplitude=Range(min(floor, peak), peak, unit),
        frequency=Range(min(frequencies), max(frequencies), "Hz"),
        identified=Provenance(
            recordings=tuple(files),
            method="maximum-likelihood",
            **stamp(),
            parameters=fit.names,
            covariance=tuple(tuple(float(c) for c in row) for row in _as_covariance(fit.covariance)),
            log_likelihood=fit.log_likelihood,
            band=band,
        ),
    )


def unit_of_file(recording: Recording) -> dict[str, str]:
    """The unit as the file had it, for a model file; empty where that is the recording's own."""
    unit = recording.recorded_unit
    return {"unit": unit} if unit not in ("", recording.unit) else {}


def stamp() -> dict[str, Any]:
    """What made a model, as a provenance has it."""
    made = made_by()
    return {"software": made.software, "commit": made.commit, "versions": made.versions, "command": made.command}


def _as_covariance(matrix: np.ndarray) -> np.ndarray:
    """The nearest (k, k) correlations that can be, with the same variances: rounding makes others of unknown values."""
    if not matrix.size:  # all parameters were given
        return matrix
    matrix = 0.5 * (matrix + matrix.T)
    std = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale = np.where(std > 0, std, 1.0)
    alike, rounding = matrix / scale[:, None] / scale, np.finfo(float).eps * len(matrix)
    sizes, axes = np.linalg.eigh(alike)
    if sizes[0] >= -rounding and np.max(np.abs(alike)) <= 1.0 + rounding:
        return matrix
    made = (axes * np.maximum(sizes, 0.0)) @ axes.T
    own = np.sqrt(np.maximum(np.diag(made), np.finfo(float).tiny))
    return made / own[:, None] / own * scale[:, None] * scale


def _moved(part: SegmentFit, fit: Fit, faulty: bool = False) -> np.ndarray:
    """Displacement along a segment, by the pace of its motion, which omega0 is not where a law is the spring.

    Less what the sensor shows at zero. Where a fit leaves more than noise of a displacement, the recording itself says
    how far it went, but for one whose measuring chain is ``faulty``. Of an acceleration what the force itself gives the
    mass is no motion yet: during a blow that is most of it, and the rest is what spring and damping do.
    """
    segment, mass = part.segment, fit.oscillator.mass
    measured = segment.quantity == "displacement" and part.over_noise > LACKING and not faulty
    moved = (segment.response if measured else part.simulated) - sum(
        offset.value for offset in fit.offsets if offset.channel == "response" and offset.recording == segment.recording
    )
    if segment.quantity == "acceleration" and segment.force is not None and mass is not None:
        pushed = segment.force.pieces[:: segment.force.fine, 0] / mass.value
        moved = moved[: pushed.size] - pushed[: moved.size]
    return moved / segment.pace**segment.order


def _seen(curves: Sequence[Curve], fit: Fit, recordings: Sequence[Recording]) -> list[Curve]:
    """Those parts of curves whose motion stands out of the sensor's noise."""
    levels: dict[str, float] = {}
    for s in fit.segments if curves else ():
        name, level = recordings[s.segment.recording].name, s.segment.noise / s.segment.pace**s.segment.order
        levels[name] = min(level, levels.get(name, level))
    seen = [(curve, curve.amplitude > SIGNIFICANT * levels.get(curve.recording, 0.0)) for curve in curves]
    return [replace(c, amplitude=c.amplitude[out], omega0=c.omega0[out]) for c, out in seen if np.any(out)]

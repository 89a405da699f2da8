"""What the measuring chain does, which is no physics: zeros of sensors and load cells, drifts, holds, known faults."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..identify.fit.hold import hold_note
from ..identify.problem.offset import FoundOffset
from ..identify.signals.odds import BEYOND_ERRORS
from ..identify.signals.said import said
from ..identify.signals.signals import response_of
from ..model import Oscillator
from ..model.oscillator import HOLDS
from ..recording.recording import Recording
from .result import ChainFact


def hold_of(hold: str, *, found: bool) -> ChainFact:
    """That the force is held, or runs in straight lines: ``found``, or as the model or a user says."""
    known = f"the force is {HOLDS[hold]}, as the model or --hold says"
    return ChainFact("hold", None, None, hold, hold_note(hold) if found else known)


def known_faults(model: Oscillator, recordings: Sequence[Recording]) -> list[ChainFact]:
    """What the model file says that the measuring chain did to these very recordings; it was not taken off.

    ``identify --faults`` found it, where it explained all that the family left: no physics is then needed for that.
    """
    entries = [e for e in model.identified.recordings if e.get("fault") and e.get("sha256")]
    faults = {entry["sha256"]: entry["fault"] for entry in entries}
    return [
        ChainFact("fault", r.name, None, "", f"{r.name}: by the model file {faults[r.sha256]}; it is in these results")
        for r in recordings
        if r.sha256 in faults
    ]


def drifts_and_loads(recordings: Sequence[Recording], offsets: Sequence[FoundOffset]) -> list[ChainFact]:
    """Each drift of a sensor, and what load cells show at zero; by the recordings as they were given."""
    facts = []
    for offset in offsets:
        recording = recordings[offset.recording]
        if offset.channel == "drift":
            facts.append(_drift(recording, offset.value))
        elif offset.channel == "force":
            unit = recording.force_unit
            shown = said(recording, offset.value, force=True)
            sentence = f"{recording.name}: its load cell shows {shown} at zero; taken off"
            facts.append(ChainFact("force-offset", recording.name, offset.value, unit, sentence))
    return facts


def drifts(recordings: Sequence[Recording], rates: Mapping[int, float]) -> list[ChainFact]:
    """Each recording along which the zero of the sensor moves by more than its noise; ``rates`` by its index."""
    moved = {index: rate * recordings[index].duration / 2 for index, rate in rates.items()}
    return [_drift(recordings[i], rates[i]) for i, by in moved.items() if abs(by) > response_of(recordings[i]).noise]


def _drift(recording: Recording, rate: float) -> ChainFact:
    unit = f"{recording.unit}/s"
    sentence = f"{recording.name}: its sensor drifts by {said(recording, rate, per='/s')}; taken off"
    return ChainFact("drift", recording.name, rate, unit, sentence)


def zeros(recordings: Sequence[Recording], shown: Mapping[int, float]) -> list[ChainFact]:
    """Each recording whose sensor shows more than its noise at zero.

    Args:
        recordings: whose sensors they are.
        shown: what each shows at zero, by its index among them.
    """
    facts = []
    for index, value in shown.items():
        recording = recordings[index]
        if abs(value) > response_of(recording).noise:
            sentence = f"{recording.name}: its sensor shows {said(recording, value)} at zero; taken off"
            facts.append(ChainFact("offset", recording.name, value, recording.unit, sentence))
    return facts


def agree(offsets: Sequence[FoundOffset], count: int) -> bool:
    """Whether that many offsets were found, and are the same to within their errors."""
    if len(offsets) < count:
        return False
    values = np.array([offset.value for offset in offsets])
    errors = np.array([max(offset.std, 1e-300) for offset in offsets])
    mean = np.average(values, weights=errors**-2)
    return bool(np.all(np.abs(values - mean) < BEYOND_ERRORS * errors))

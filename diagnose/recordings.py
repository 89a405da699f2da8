"""What goes into a diagnosis: recordings of one quantity, long and loud enough, some of them held out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..errors import BadInput
from ..identify.decays import find_decays
from ..identify.hilbert import noise_level
from ..identify.segments import cut
from ..model import Oscillator
from ..recording.recording import Recording

#: Of a record that is to be split the first part trains.
_TRAINING_PART = 2.0 / 3.0
#: A recording of fewer cycles than this holds no stretch to fit.
_FEWEST_CYCLES = 10.0
#: A response below this many times its noise says little.
_QUIET = 3.0


def same_quantity(model: Oscillator, recordings: Sequence[Recording]) -> None:
    """Raise BadInput where a recording is not of the quantity that the model's sensor gives."""
    for recording in recordings:
        if (recording.quantity, recording.unit) != (model.response.quantity, model.response.unit):
            raise BadInput(
                f"{recording.name}: records {recording.quantity} in {recording.unit}, the model is of "
                f"{model.response.quantity} in {model.response.unit}; say what the column is with --quantity and --unit"
            )


def carries(recording: Recording, model: Oscillator) -> bool:
    """Whether a recording holds a decay or, where the mass is known, a driven stretch that can be fitted."""
    segments = cut([recording], model.omega0.value)
    return any(segment.force is None or model.mass is not None for segment in segments)


def why_unused(recording: Recording, model: Oscillator) -> str:
    """A sentence that says why a recording cannot be fitted."""
    response = np.asarray(recording.response, float)
    frequency = model.omega0.value / (2 * math.pi)
    cycles = recording.n * recording.dt * frequency
    noise = noise_level(response, recording.fs)
    loudness = float(np.std(response)) / noise if noise > 0 else math.inf
    if cycles < _FEWEST_CYCLES:
        why = f"too short: {cycles:.2g} cycles of {frequency:.3g} Hz; record at least {_FEWEST_CYCLES:.0f}"
    elif loudness < _QUIET:
        why = f"too quiet: its response is {loudness:.2g} times its noise"
    elif model.mass is None and recording.force is not None:
        why = "driven, and the model has no mass to tell what a force does; no free decay was found in it"
    else:
        why = "neither a free decay nor a stretch driven by a recorded force was found in it"
    return f"{recording.name}: {why}"


def split(recordings: Sequence[Recording], model: Oscillator) -> tuple[list[Recording], list[Recording]]:
    """The beginning of each recording to learn from, its end to be judged on; no ends where they carry nothing."""
    training, ends = [], []
    for recording in recordings:
        at = int(_TRAINING_PART * recording.n)
        if recording.force is None or not np.any(recording.force):
            for decay in find_decays(recording)[:1]:  # its quiet half is a recording of another level
                at = (decay.start + decay.stop) // 2
        beginning = replace(recording.slice(0, at), name=recording.name)
        end = replace(recording.slice(at, recording.n), name=f"{recording.name}, its end")
        whole = not (carries(beginning, model) and carries(end, model))
        training.append(recording if whole else beginning)
        ends += [] if whole else [end]
    return training, ends

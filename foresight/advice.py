"""What to record so that a parameter is told that these recordings do not tell: a few tests, rehearsed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..errors import DashpotError
from ..identify.problem.data import Data
from ..identify.signals.registry import shown
from ..model import Oscillator
from .plan import Bounds, Judged, Stage
from .told import Told
from .virtual import Noise, without_errors
from .want import Want

_WORTHWHILE = shown(0.5, "of the error", why="to what a test must bring it to be worth a sentence")


def advised(parameters: Sequence[Told], model: Oscillator, data: Data) -> tuple[Told, ...]:
    """The same, with what would tell those that are not told.

    Args:
        parameters: of a check.
        model: near the rig.
        data: what was recorded: the noise, how far the rig moved, the largest force.
    """
    lost = [told for told in parameters if told.state == "not told" and told.std is not None]
    if not lost:
        return tuple(parameters)
    try:
        tests = _tests(lost, model, data)
    except (DashpotError, np.linalg.LinAlgError):
        return tuple(parameters)
    words = {told.name: _words(told, k, tests, model) for k, told in enumerate(lost)}
    return tuple(replace(t, words=f"{t.words}; {words[t.name]}") if t.name in words else t for t in parameters)


def _tests(lost: Sequence[Told], model: Oscillator, data: Data) -> list[Judged]:
    """Releases and sweeps within what was recorded, each with the errors that it tells those with."""
    known = without_errors(model)
    held = {name: replace(p, value=max(p.value, 0.0)) for name, p in known.parameters().items() if name in _HOLD}
    known = known.with_parameters(held)
    wants = tuple(Want(told.name, told.std or math.inf, told.unit, "") for told in lost)
    driven = data.scales.force > 0.0 and known.mass is not None
    bounds = Bounds(
        amplitude=data.scales.length,
        force=data.scales.force if driven else math.inf,
        tests=("decay", "sweep") if driven else ("decay",),
    )
    noise = Noise(float(np.median(data.sensor)), max(data.force, default=0.0))
    stage = Stage(known, wants, bounds, noise, max(recording.fs for recording in data.recordings))
    return stage.judged(stage.candidates())


#: Values below zero of these push, and what pushes does not come to rest.
_HOLD = ("preload", "dry")


def _words(told: Told, place: int, tests: Sequence[Judged], model: Oscillator) -> str:
    std = told.std or math.inf
    best = min(tests, key=lambda test: test.errors[place], default=None)
    error = math.inf if best is None else best.errors[place]
    both = 1.0 / math.sqrt(std**-2 + error**-2) if error > 0 else std
    if best is None or not both < _WORTHWHILE * std:
        return "no release or sweep up to the recorded size tells it much better: record longer, or with less noise"
    unit = model.response.displacement_unit
    said = best.excitation.sentence(unit, model.force_unit)
    return f"to know it to ± {both:.2g} {told.unit}, {said}"

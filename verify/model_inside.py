"""The model inside an FMU: its file, what it says of its own errors, and its core, which answers in the FMU's place.

Noise is drawn and simulated many times over. The FMU is called once a sample; its model's core does the same in a
fiftieth of the time, and stands in for it where both were seen to give the same response.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import BadInput
from ..files.yaml_loader import MAX_CHARACTERS
from ..identify.problem.replay import Replay, natural_frequency
from ..model import Oscillator
from ..model.element import Element
from ..model.element_file import load_element
from ..model.file import load
from ..model.oscillator import QUANTITIES
from ..recording.recording import Recording
from ..simulate.core import core_of, internal_step
from ..simulate.force import Force

#: Responses that differ by less than this part of the sensor's noise are the same.
SAME = 0.1


def model_inside(file: Path) -> Oscillator | None:
    """The model of a file in an FMU; None where there is none, or it holds something else."""
    try:
        return load(file) if file.is_file() and file.stat().st_size <= MAX_CHARACTERS else None
    except (OSError, BadInput):
        return None  # an FMU of another make may hold anything under that name


def element_inside(file: Path) -> Element | None:
    """The element of a file in an FMU; None where there is none, or it holds something else."""
    try:
        return load_element(file) if file.is_file() and file.stat().st_size <= MAX_CHARACTERS else None
    except (OSError, BadInput):
        return None


def covariance_of(model: Oscillator | Element, names: Sequence[str]) -> np.ndarray:
    """(k, k) covariance of the parameters ``names`` in the model's units, as its file states it.

    Standard errors stand for what no covariance names; what has neither is taken for exact.
    """
    parameters, provenance = model.parameters(), model.identified
    covariance = np.diag(np.array([(parameters[name].std or 0.0) ** 2 for name in names], float))
    if provenance.covariance is not None:
        places = {name: place for place, name in enumerate(provenance.parameters)}
        both = [i for i, name in enumerate(names) if name in places]
        there = [places[names[i]] for i in both]
        covariance[np.ix_(both, both)] = np.array(provenance.covariance, float)[np.ix_(there, there)]
    return covariance


@dataclass(frozen=True, eq=False)
class Twin:
    """What answers in an FMU's place.

    Attributes:
        values: (k,) the parameters; none where nothing is known of them.
        covariance: (k, k) of these.
        respond: a force and (k,) parameters -> the (n,) response from the state that the replay found.
    """

    values: np.ndarray
    covariance: np.ndarray
    respond: Callable[[Force | None, np.ndarray], np.ndarray]

    @property
    def exact(self) -> bool:
        """Whether the model states no errors of its own."""
        return not np.any(self.covariance)


def twin_of(
    model: Oscillator | None, recording: Recording, force: Force | None, replay: Replay, sensor: float
) -> Twin | None:
    """The core of the model inside an FMU; None where there is none or it gives another response than the FMU.

    Args:
        model: that the FMU holds.
        recording: along which the FMU ran.
        force: that it ran with.
        replay: what came of it.
        sensor: standard deviation of the sensor's noise.
    """
    if model is None or len(replay.initial) != (core := core_of(model)).states:
        return None
    order = QUANTITIES.index(recording.quantity)
    peak = float(np.max(np.abs(recording.response))) / natural_frequency(recording) ** order
    step = internal_step(model, model.values(), peak)

    def respond(pushed: Force | None, values: np.ndarray) -> np.ndarray:
        n, dt, start = recording.n, recording.dt, recording.start
        return core.record(values, replay.initial, pushed, n, dt, step, start=start, quantity=recording.quantity)

    values = np.array(list(model.values().values()))
    apart = respond(force, values) - (replay.response - replay.shown(recording.dt))
    if not float(np.sqrt(np.mean(apart**2))) <= SAME * sensor:
        return None
    return Twin(values, covariance_of(model, tuple(model.parameters())), respond)

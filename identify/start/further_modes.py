"""Modes that ring beside the wanted one, as further terms of the model: linear oscillators that the sensor shows too.

They are fitted with it in the time domain. A free piece has an amplitude and a phase of each of its own; frequency and
damping, and the answer to a force, are shared by all of the recordings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...model import Oscillator
from ...model.laws import MODES
from ...model.terms import with_term, without_term
from ...recording.recording import Recording
from ..motion.decays import linear_modes

#: Natural frequency, rad/s, damping ratio, and answer to the force, one over its modal mass; 0 where it is not known.
Mode = tuple[float, float, float]


def ringing_modes(recordings: Sequence[Recording], wanted: float | None = None) -> tuple[Mode, ...]:
    """Several modes that the free motion of recordings shows; none where there is one.

    The first is that which moves most, or the one nearest to ``wanted``, in Hz.
    """
    struck = wanted is not None
    modes = max((linear_modes(recording, struck=struck) for recording in recordings), key=len, default=())
    if wanted is not None:
        modes = sorted(modes, key=lambda mode: abs(np.log(mode.frequency / wanted)))
    return tuple((2 * np.pi * mode.frequency, mode.damping_ratio or 0.0, 0.0) for mode in modes)


def with_modes(model: Oscillator, modes: Sequence[Mode]) -> Oscillator:
    """The model as a linear rig of the first mode, with a term for each further one."""
    (omega, zeta, gain), *others = modes
    for term in model.terms:
        if term.effect in MODES:
            model = without_term(model, term.effect)
    known = model.parameters()
    values = {"omega0": omega, "viscous": 2 * zeta * omega, "cubic": 0.0, "preload": 0.0, "dry": 0.0}
    if "mass" in known and gain > 0.0:
        values["mass"] = 1.0 / gain
    model = model.with_parameters({name: replace(known[name], value=value, std=None) for name, value in values.items()})
    for name, (omega, zeta, gain) in zip(MODES, others, strict=False):
        model = with_term(model, name, {"participation": gain, "frequency": omega, "viscous": 2 * zeta * omega})
    return model

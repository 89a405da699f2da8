"""The free pieces of a recording with one mode of a linear rig alone: the others, as fitted, are taken off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...recording.recording import Recording
from .damped_modes import Modes
from .decays import find_free_motion
from .mode import Mode


def without_other_modes(recording: Recording, kept: Mode) -> Recording:
    """The recording without what all other modes show in its free pieces.

    Frequencies and damping ratios are those of ``find_free_motion``; amplitudes are those of least squares in each
    piece. No band is cut, so that modes may lie as near to each other as they are told apart.
    """
    motion = find_free_motion(recording)
    modes = [kept, *(mode for mode in motion.modes if mode.frequency != kept.frequency)]
    if len(modes) < 2:
        return recording
    omega = np.array([2 * np.pi * mode.frequency / recording.fs for mode in modes])
    zeta = np.array([mode.damping_ratio or 0.0 for mode in modes])
    columns_of = Modes(omega, zeta, np.zeros((2 * omega.size, 2 * omega.size))).columns
    response = np.array(recording.response, float)
    for decay in motion.decays:
        columns = columns_of(decay.stop - decay.start)
        scale = np.linalg.norm(columns, axis=0)
        weights = np.linalg.lstsq(columns / scale, response[decay.start : decay.stop])[0] / scale
        response[decay.start : decay.stop] -= columns[:, 2:-1] @ weights[2:-1]
    return replace(recording, response=response)

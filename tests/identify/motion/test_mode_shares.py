"""Shares of modes with their errors, and one mode without the others: against damped cosines in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.motion.mode import Mode
from dashpot.identify.motion.mode_lines import modes_of
from dashpot.identify.motion.modes import without_other_modes
from dashpot.recording.recording import Recording

FS, N, NOISE = 40.0, 1200, 2e-3
TIMES = np.arange(N) / FS


def one(frequency, zeta, amplitude):
    omega = 2 * np.pi * frequency
    return amplitude * np.exp(-zeta * omega * TIMES) * np.cos(omega * np.sqrt(1 - zeta**2) * TIMES)


@pytest.mark.parametrize("second", [(1.02, 0.012, 0.4), (1.3, 0.02, 0.12)])
def test_modes_and_shares_are_within_their_errors(second):
    first = (1.0, 0.01, 1.0)
    parts = [one(*first), one(*second)]
    z = []
    for seed in range(6):
        x = sum(parts) + NOISE * np.random.default_rng(seed).standard_normal(N)
        recording = Recording("two", FS, x)
        modes, (decay,) = modes_of([recording]), find_free_motion(recording).decays
        power = np.array([float(np.sum(part[decay.start : decay.stop] ** 2)) for part in parts])
        truth = [(f, zeta, p / np.sum(power)) for (f, zeta, _), p in zip((first, second), power, strict=True)]
        assert [mode.strongest for mode in modes] == [True, False]
        for mode, true in zip(modes, truth, strict=True):
            found = (mode.frequency, mode.damping_ratio, mode.share)
            z.append((np.array(found) - true) / np.array(mode.errors))
    assert np.all(np.abs(z) < 3.5)
    assert np.all(np.std(z, axis=0) > 0.4)  # errors that are far too large would hide anything


def test_a_mode_is_listed_with_the_decimals_of_its_errors():
    mode = Mode(0.549989, 0.549989, 0.549989, 0.567, True, 0.0149963, (4.5e-6, 8e-6, 2e-4))
    assert str(mode) == "0.5499890 ± 0.0000045 Hz (damping ratio 0.0149963 ± 0.0000080, 56.700 ± 0.020 % of the power)"
    assert Mode.of_json(mode.as_json()).errors == mode.errors
    line = Mode(12.0, 11.9, 12.1, 0.25)
    assert str(line) == "12 Hz (25 %)"
    assert Mode.of_json(line.as_json()).errors is None


def test_one_mode_without_the_others():
    x = one(1.0, 0.01, 1.0) + one(1.04, 0.012, 0.8) + 0.3 + NOISE * np.random.default_rng(1).standard_normal(N)
    recording = Recording("two", FS, x)
    for mode, alone in zip(modes_of([recording]), (one(1.0, 0.01, 1.0), one(1.04, 0.012, 0.8)), strict=True):
        left = np.asarray(without_other_modes(recording, mode).response) - 0.3 - alone
        assert float(np.std(left)) == pytest.approx(NOISE, rel=0.1)


def test_a_single_mode_is_left_as_it_is():
    recording = Recording("one", FS, one(1.0, 0.01, 1.0) + NOISE * np.random.default_rng(1).standard_normal(N))
    assert find_free_motion(recording).modes == ()
    assert without_other_modes(recording, Mode(1.0, 1.0, 1.0, 1.0)) is recording

"""What is refused because nobody could know it: against a rig in closed form under a force of one frequency."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify import identify
from dashpot.recording.recording import Recording

OMEGA, ZETA, MASS, FS = 2 * np.pi * 2.0, 0.2, 0.5, 100.0


def steady(*frequencies):
    """What the rig does under unit forces of frequencies in Hz once all else has rung down, and 1e-3 of noise."""
    t = np.arange(3000) / FS
    turns = [2 * np.pi * f for f in frequencies]
    answers = [1 / MASS / (OMEGA**2 - w**2 + 2j * ZETA * OMEGA * w) for w in turns]
    x = sum((a * np.exp(1j * w * t)).real for a, w in zip(answers, turns, strict=True))
    noise = 1e-3 * np.std(x) * np.random.default_rng(1).standard_normal(t.size)
    return Recording("steady", FS, x + noise, force=sum(np.cos(w * t) for w in turns))


def test_under_a_force_of_one_frequency_mass_and_frequency_are_not_told_apart():
    with pytest.raises(BadInput, match=r"cannot be told apart.*other frequencies"):
        identify([steady(0.7)], every=False)


def test_under_forces_of_three_they_are():
    found = identify([steady(0.7, 1.9, 2.9)], every=False).oscillator
    assert found.mass is not None
    assert found.mass.value == pytest.approx(MASS, abs=3.5 * found.mass.std)
    assert found.omega0.value == pytest.approx(OMEGA, abs=3.5 * found.omega0.std)

"""What is cut off at the end of a measuring range, and what only looks so: commands in steps, and smooth peaks."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.recording.clipping import clipping

N = 20_000
TIME = np.arange(N) / 1000.0


def held_levels(levels, samples):
    return np.repeat(levels, samples)[np.arange(N) % (len(levels) * samples)]


def slewed(command, rate):
    path = [0.0]
    for level in command[1:]:
        path.append(path[-1] + float(np.clip(level - path[-1], -rate, rate)))
    return np.array(path)


LEVELS = np.round(0.3 * np.random.default_rng(3).integers(-20, 21, 150) / 20, 3)
BANG = 0.3 * np.random.default_rng(4).choice([-1.0, 0.0, 0.0, 1.0], 150)
COMMANDS = {
    "steps": held_levels(LEVELS, 30),
    "steps between limits": held_levels(np.clip(4 * LEVELS, -0.3, 0.3), 30),
    "steps of four samples": held_levels(LEVELS, 4),
    "bang-bang": held_levels(BANG, 30),
    "bang-bang at a limited rate": slewed(held_levels(BANG, 40), 0.05),
    "half square, half sine": np.where(TIME % 1.0 < 0.3, 0.3, 0.15 * np.sin(2 * np.pi * 9 * TIME)),
}


@pytest.mark.parametrize("kind", COMMANDS)
@pytest.mark.parametrize("converter", [0.0, 1e-3])
def test_a_force_in_steps_is_not_clipped(kind, converter):
    command = COMMANDS[kind]
    if converter:  # measured: the noise of the sensor is less than a step
        noise = 0.15 * converter * np.random.default_rng(5).standard_normal(N)
        command = np.round((command + noise) / converter) * converter
    assert clipping(command) == []


@pytest.mark.parametrize("share", [0.95, 0.8, 0.65])
@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_sine_and_a_sweep_cut_at_the_rail_are_clipped(share, noise):
    for phase in (2 * np.pi * 3 * TIME, 2 * np.pi * (2 * TIME + 0.1 * TIME**2)):
        whole = 0.3 * (np.sin(phase) + noise * np.random.default_rng(6).standard_normal(N))
        cut = np.clip(whole, -0.3 * share, 0.3 * share)
        assert len(clipping(cut)) == 2
        assert clipping(whole) == []


def test_a_hammer_cut_at_the_rail_is_clipped():
    beats = 1 + 0.1 * np.random.default_rng(7).standard_normal(N)
    blows = 100 * np.maximum(np.sin(2 * np.pi * 5 * TIME), 0) ** 2 * beats[np.arange(N) // 40 * 40]
    assert clipping(blows) == []
    assert len(clipping(np.minimum(blows, 60.0))) == 1

"""A prescribed motion: its smoothing, where it tells nothing, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.specimens import motion
from dashpot.prescribed.motion import imposed, origin_of
from dashpot.recording import Recording

FS = 200.0
TIME = np.arange(4000) / FS
SINE = 4e-3 * np.sin(2 * np.pi * TIME)


def test_speed_and_acceleration_are_those_of_a_noisy_sine() -> None:
    noise = 4e-7 * np.random.default_rng(0).standard_normal(TIME.size)
    made = imposed(Recording("sine", FS, SINE + noise, 100.0 * SINE))
    inside = slice(200, -200)
    speed, acceleration = 8e-3 * np.pi, 16e-3 * np.pi**2
    assert np.std(made.velocity - speed * np.cos(2 * np.pi * TIME), where=_mask(inside)) < 2e-3 * speed
    off = made.acceleration + acceleration * np.sin(2 * np.pi * TIME)
    assert np.std(off, where=_mask(inside)) < 2e-2 * acceleration
    assert made.pace == pytest.approx(2 * np.pi, rel=1e-3)


def _mask(part: slice) -> np.ndarray:
    mask = np.zeros(TIME.size, bool)
    mask[part] = True
    return mask


def test_a_recorded_speed_is_integrated() -> None:
    speed = 8e-3 * np.pi * np.cos(2 * np.pi * TIME)
    made = imposed(Recording("speed", FS, speed, 100.0 * speed, quantity="velocity", unit="m/s"))
    assert np.max(np.abs(made.displacement - SINE)) < 1e-5
    assert np.max(np.abs(made.velocity - speed)[5:-5]) < 1e-3 * np.max(speed)


def test_where_it_stands_or_turns_and_the_first_half_cycle_nothing_is_told() -> None:
    still = np.where((TIME > 5.0) & (TIME < 7.0), 4e-3 * np.sin(10.0 * np.pi), SINE)
    noise = 1e-6 * np.random.default_rng(1).standard_normal(TIME.size)
    made = imposed(Recording("dwell", FS, still + noise, SINE + 1e-5))
    assert np.mean(made.told[(TIME > 5.1) & (TIME < 6.9)]) < 0.02
    assert np.mean(made.told[(TIME > 8.0) & (TIME < 12.0)]) > 0.9
    assert not np.any(made.told[TIME < 0.4])
    turns = np.flatnonzero(np.diff(np.sign(made.velocity)))
    assert not np.any(made.told[turns])
    assert not np.any(made.told[turns + 1])


def test_laws_count_from_the_recorded_zero_or_from_the_middle_of_the_stroke() -> None:
    centred, aside = (imposed(Recording("x", FS, SINE + shift, SINE)) for shift in (1e-3, 20e-3))
    assert origin_of([centred]) == 0.0
    assert origin_of([aside]) == pytest.approx(20e-3, rel=1e-3)


def test_a_part_begins_with_half_a_cycle_that_is_not_told() -> None:
    made = imposed(Recording("sine", FS, SINE, SINE)).part(1000, 3000)
    assert made.n == 2000
    assert made.start == pytest.approx(5.0)
    assert not np.any(made.told[:95])
    assert np.any(made.told[105:])
    assert made.otherwise[0].size == 2000


@pytest.mark.parametrize(
    ("recording", "words"),
    [
        (Recording("r", FS, SINE), "without the force"),
        (Recording("r", FS, SINE, SINE, quantity="acceleration", unit="m/s2"), "prescribed acceleration"),
        (Recording("r", FS, 0.0 * SINE, SINE), "does not move"),
        (Recording("r", FS, SINE, 0.0 * SINE + 3.0), "the force is 3 throughout"),
        (Recording("r", FS, 1e-9 * np.random.default_rng(2).standard_normal(4000), SINE), "no more than its noise"),
    ],
)
def test_what_is_no_prescribed_motion_is_refused(recording: Recording, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        imposed(recording)


@pytest.mark.parametrize("kind", ["sines", "sweep", "triangle", "random"])
def test_each_kind_of_motion_is_followed(kind: str) -> None:
    x = motion(kind, 5e-3, 1.0, FS, 15.0, seed=3)
    made = imposed(Recording(kind, FS, x, 1e3 * x))
    assert np.max(np.abs(made.displacement - x)) < 2e-2 * np.max(np.abs(x))

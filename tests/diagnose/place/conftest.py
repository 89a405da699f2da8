"""Stretches of a motion in closed form, with a force missing along them that the test chooses."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from dashpot.diagnose.place.equation_error import BLOCK_CYCLES, Stretch

#: Samples a cycle, angular frequency and largest displacement of the motion.
PER_CYCLE, OMEGA, SIZE = 16, 2 * np.pi * 10.0, 5e-3
NOISE = 0.02

Missing = Callable[[Stretch], np.ndarray]


def make(
    missing: Missing | None = None,
    *,
    name: str = "run",
    driven: bool = True,
    cycles: int = 120,
    size: float = SIZE,
    noise: float = NOISE,
    seed: int = 0,
) -> Stretch:
    """A motion that swells and fades, x = A cos(phase), under two tones of force that do not follow it.

    Args:
        missing: force per unit mass along the stretch, the noise of which is added; None for none.
        name, driven: of the recording.
        cycles: its length.
        size: largest displacement.
        noise: standard deviation of the noise of the missing force.
        seed: of the noise.
    """
    random = np.random.default_rng(seed)
    t = np.arange(cycles * PER_CYCLE) * 2 * np.pi / OMEGA / PER_CYCLE
    slow = OMEGA / 31.0
    swell, rise, bow = 0.6 - 0.4 * np.cos(slow * t), 0.4 * slow * np.sin(slow * t), 0.4 * slow**2 * np.cos(slow * t)
    turn = OMEGA * t + 0.3
    c, s = np.cos(turn), np.sin(turn)
    tones = [(0.7 * OMEGA, 1.0, 0.4), (1.3 * OMEGA, 0.6, 1.9)] if driven else []
    drive = [np.zeros(t.size)] * 3
    for w, level, phase in tones:
        wave = level * np.exp(1j * (w * t + phase))
        drive = [total + (wave * (1j * w) ** k).real for k, total in enumerate(drive)]
    blank = np.zeros(t.size)
    stretch = Stretch(
        name=name,
        driven=driven,
        time=t,
        x=size * swell * c,
        v=size * (rise * c - OMEGA * swell * s),
        a=size * (bow * c - 2 * OMEGA * rise * s - OMEGA**2 * swell * c),
        missing=blank,
        noise=noise * random.standard_normal(t.size),
        drive=drive[0],
        drive_rate=drive[1],
        drive_bend=drive[2],
        amplitude=size * swell,
        frequency_hz=np.full(t.size, OMEGA / (2 * np.pi)),
        phase=turn,
        block=(np.arange(t.size) // int(BLOCK_CYCLES * PER_CYCLE)).astype(int),
    )
    force = blank if missing is None else np.asarray(missing(stretch), float)
    object.__setattr__(stretch, "missing", force + noise * random.standard_normal(t.size))
    return stretch


@pytest.fixture(scope="session")
def stretch() -> Callable[..., Stretch]:
    """``stretch(lambda s: 3.0 * s.v * abs(s.v), name="sweep")``; see ``make``."""
    return make

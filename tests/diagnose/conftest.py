"""Rigs with a concealed effect, by the integrator that shares no code with the product."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.suite import Spec
from dashpot.examples.concealed.virtual import draw
from dashpot.identify import identify
from dashpot.model import Oscillator
from dashpot.recording import Recording

TRAINING = ("sweep_high", "sweep_low", "ringdown")
HOLDOUT = ("holdout_multisine", "holdout_sweep")


@dataclass(frozen=True, eq=False)
class Case:
    """Recordings of one virtual rig, the model identified from them, and the truth."""

    model: Oscillator
    training: tuple[Recording, ...]
    holdout: tuple[Recording, ...]
    truth: dict


@cache
def concealed(kind: str, *effects: str, variants: tuple[str, ...] = (), noise: str = "white", seed: int = 7) -> Case:
    """A rig of about a hundred cycles a recording."""
    spec = Spec(kind, effects, variants or ("",) * len(effects), noise, 0)
    tables, truth = record(draw(spec, seed, cycles=(110.0, 130.0)))
    found = {
        name: Recording(
            name=name,
            fs=truth["fs_hz"],
            response=table[:, 2],
            force=table[:, 1] if np.any(table[:, 1]) else None,
        )
        for name, table in tables.items()
    }
    training = tuple(found[name] for name in TRAINING)
    model = identify(training, name="rig").oscillator
    return Case(model, training, tuple(found[name] for name in HOLDOUT), truth)


@pytest.fixture
def rig():
    """``rig(kind, *effects)`` makes a case, once per run."""
    return concealed

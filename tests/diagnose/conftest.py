"""Rigs with a concealed effect, by the integrator that shares no code with the product."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

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


def concealed(kind: str, *effects: str, variants: tuple[str, ...] = (), noise: str = "white", seed: int = 7) -> Case:
    """A rig of about a hundred cycles a recording."""
    spec = Spec(kind, effects, variants or ("",) * len(effects), noise, 0)
    tables, truth = record(draw(spec, seed, cycles=(110.0, 130.0)))
    recordings = {
        name: Recording(
            name=name,
            fs=truth["fs_hz"],
            response=table[:, 2],
            force=table[:, 1] if np.any(table[:, 1]) else None,
        )
        for name, table in tables.items()
    }
    training = tuple(recordings[name] for name in TRAINING)
    model = identify(training, name="rig").oscillator
    return Case(model, training, tuple(recordings[name] for name in HOLDOUT), truth)


@pytest.fixture(scope="session")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Case]:
    """``rig(kind, *effects)`` makes a case, once per run: what one process identified the others read."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    made: dict[str, Case] = {}

    def get(*what: str, **more: object) -> Case:
        name = "-".join(["rig", *what, *(str(value) for _, value in sorted(more.items()))])
        if name not in made:
            made[name] = _kept(folder / f"{name}.pickle", lambda: concealed(*what, **more))  # type: ignore[arg-type]
        return made[name]

    return get


def _kept(path: Path, make: Callable[[], Case]) -> Case:
    """What a process of this run wrote to a file, or made and written there whole."""
    if not path.exists():
        case = make()
        unfinished = path.with_suffix(f".{os.getpid()}")
        unfinished.write_bytes(pickle.dumps(case))
        unfinished.replace(path)
    return pickle.loads(path.read_bytes())

"""What the measuring chain does to a force is no physics."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.examples.force import chirp, multisine
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator
from dashpot.recording import Recording

FS, N = 500.0, 8000


def recording(kind, level, hold, seed):
    random = np.random.default_rng(seed)
    t = np.arange(N) / FS
    if kind == "sweep":
        force = chirp(level, 5.0, 15.0 * FS / N, t, 1 / FS)[:, 0]
    else:
        lines = np.arange(80, 320) * FS / N
        phases = random.uniform(0, 2 * np.pi, lines.size)
        force = multisine(2 * level / np.sqrt(lines.size), lines, phases, t, 1 / FS)[:, 0]
    pieces = force[:, None] if hold == "zero" else np.column_stack([force, np.append(np.diff(force), 0.0)])
    x = integrate_pieces(TRUTH, pieces[:-1], 1 / FS)[0] + 2e-6 * random.standard_normal(N)
    return Recording(name=f"{kind} {level}", fs=FS, response=x, force=force + 1e-3 * random.standard_normal(N))


@pytest.mark.parametrize("hold", ["zero", pytest.param("linear", marks=pytest.mark.long)])
def test_nothing_is_named_for_a_hold(hold):
    model = Oscillator.from_values(TRUTH | {"mass": 1.01 * TRUTH["mass"]})
    training = [recording("sweep", 1.0, hold, 1), recording("random", 0.5, hold, 2)]
    diagnosis = diagnose(model, training, [recording("random", 1.0, hold, 3)])
    assert diagnosis.effects == ()
    assert diagnosis.verdict == "consistent"
    assert diagnosis.model.hold == hold
    assert [fact.what for fact in diagnosis.chain if "fitted so" in fact.sentence] == ["hold"]

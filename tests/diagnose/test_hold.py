"""What the measuring chain does to a force is no physics."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.diagnose import diagnose
from dashpot.examples.force import chirp, multisine
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
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


def with_drag(
    level: float, seed: int, fs: float = 250.0, n: int = 1200, *, drag: float = 6.0, white: bool = False
) -> Recording:
    """A linear rig of 3 Hz with drag (1/m) under a swept or white force, held; Runge and Kutta's rule of order 4."""
    omega, viscous, mass, fine = 2 * np.pi * 3.0, 0.6, 0.8, 8
    t = np.arange(n) / fs
    force = chirp(level, 1.5, 4.0 * fs / n, t, 1 / fs)[:, 0]
    if white:
        force = level * np.random.default_rng([seed, 1]).standard_normal(n)

    def rates(z, f):
        return np.array([z[1], f / mass - viscous * z[1] - drag * abs(z[1]) * z[1] - omega**2 * z[0]])

    z, x, h = np.zeros(2), np.zeros(n), 1 / fs / fine
    for i in range(n):
        x[i] = z[0]
        for _ in range(fine):
            a = rates(z, force[i])
            b = rates(z + h / 2 * a, force[i])
            c = rates(z + h / 2 * b, force[i])
            z = z + h / 6 * (a + 2 * b + 2 * c + rates(z + h * c, force[i]))
    x += 1e-4 * np.std(x) * np.random.default_rng(seed).standard_normal(n)
    return Recording(name=f"{'white' if white else 'sweep'} {level}", fs=fs, response=x, force=force)


@pytest.mark.long
@pytest.mark.parametrize("fs", [180.0, 250.0])
def test_half_a_sample_late_is_a_hold_beside_a_drag(fs):
    """A smooth force with a lag of half a sample, of whatever law, would take most of what a hold does."""
    training = [with_drag(level, seed, fs) for seed, level in enumerate((2.0, 5.0))]
    model = identify(training, doubted=False).oscillator
    assert model.hold == "smooth"
    diagnosis = diagnose(model, training, [with_drag(3.5, 2, fs)])
    assert [effect.law for effect in diagnosis.effects] == ["quadratic-drag"]
    assert diagnosis.model.hold == "zero"
    drag = diagnosis.model.parameters()["quadratic-drag.coefficient"]
    assert drag.value == pytest.approx(6.0, abs=3.5 * drag.std)


@pytest.mark.long
def test_physics_that_a_white_command_shows_is_no_noise_of_its_sensor():
    """The command was taken for its noise: the model was consistent, with a tenth of the motion left."""
    training = [with_drag(level, seed, 200.0, 4000, drag=0.5, white=True) for seed, level in enumerate((8.0, 16.0))]
    model = identify(training, doubted=False).oscillator
    held_out = with_drag(12.0, 2, 200.0, 4000, drag=0.5, white=True)
    diagnosis = diagnose(model, training, [held_out])
    assert [effect.law for effect in diagnosis.effects] == ["quadratic-drag"]
    drag = diagnosis.model.parameters()["quadratic-drag.coefficient"]
    assert drag.value == pytest.approx(0.5, abs=3.5 * drag.std)
    (record,) = (record for record in diagnosis.records if record.holdout)
    assert record.noise_floor == pytest.approx(1e-4, rel=0.5)
    assert record.nrmse_after < 1.5 * record.noise_floor < 0.02 * record.nrmse_before

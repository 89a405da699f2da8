"""Recordings of one rig that was not quite the same in each, by the closed form of a linear decay."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate_pieces
from dashpot.identify import identify
from dashpot.identify.faults.spread import Deviation, differing, with_spread
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.model.terms import with_term
from dashpot.recording import Recording
from scipy.integrate import solve_ivp

OMEGA, VISCOUS, FS, SECONDS, NOISE = 2 * np.pi * 5.0, 0.8, 150.0, 4.0, 2e-3
MODEL = Oscillator.from_values({"omega0": OMEGA, "viscous": VISCOUS, "dry": 0.0, "cubic": 0.0, "preload": 0.0})


def decay(name, seed, omega=1.0, viscous=1.0, begin=1.0):
    """A linear decay from rest, its frequency and damping times a factor each."""
    t = np.arange(round(FS * SECONDS)) / FS
    rate, omega = 0.5 * viscous * VISCOUS, omega * OMEGA
    turn = np.sqrt(omega**2 - rate**2)
    x = begin * np.exp(-rate * t) * (np.cos(turn * t) + rate / turn * np.sin(turn * t))
    return Recording(name, FS, x + NOISE * np.random.default_rng(seed).standard_normal(t.size))


def fitted(recordings):
    return maximum_likelihood(MODEL, recordings, ("cubic", "preload"), doubted=False, near=True)


@cache
def struck_thrice():
    """The recordings of a rig whose frequency moved between them, and what identify makes of them."""
    recordings = tuple(decay(f"{i}.csv", i, omega) for i, omega in enumerate((1.0, 1.008, 0.997)))
    return recordings, identify(recordings)


def test_a_frequency_that_moved_between_recordings_is_found():
    recordings = [decay("a", 1), decay("b", 2, 1.008), decay("c", 3, 0.997)]
    made, mean = differing(fitted(recordings), recordings)
    expected = OMEGA * (np.array([1.0, 1.008, 0.997]) - np.mean([1.0, 1.008, 0.997]))
    assert [[name for name, _ in r.differs] for r in made] == [["omega0"]] * 3
    assert [r.differs[0][1] for r in made] == pytest.approx(expected, abs=2e-4 * OMEGA)
    assert mean.omega0.value == pytest.approx(OMEGA * 3.005 / 3, rel=2e-4)


def test_so_is_a_damping():
    recordings = [decay("a", 1), decay("b", 2, viscous=1.1), decay("c", 3, viscous=0.9)]
    made, _ = differing(fitted(recordings), recordings)
    assert [r.differs[0][0] for r in made] == ["viscous"] * 3
    assert [r.differs[0][1] for r in made] == pytest.approx(np.array([0.0, 0.1, -0.1]) * VISCOUS, abs=0.02 * VISCOUS)


def test_of_one_rig_nothing_is_said():
    for seed in range(0, 10, 2):
        recordings = [decay("a", seed), decay("b", seed + 1, begin=0.5)]
        assert differing(fitted(recordings), recordings) is None


@pytest.mark.parametrize("factor", [1.001, 1.25, 0.8])
def test_it_is_found_however_large_it_is(factor):
    recordings = [decay("a", 1), decay("b", 2, factor)]
    made, _ = differing(fitted(recordings), recordings)
    assert made[1].differs[0][1] - made[0].differs[0][1] == pytest.approx((factor - 1) * OMEGA, abs=3e-4 * OMEGA)


@pytest.mark.parametrize("law", [lambda x, v: 0.05 * v * abs(v), lambda x, v: 2.0 * VISCOUS * x**2 * v])
def test_missing_physics_is_no_spread(law):
    """A damping by the amplitude makes recordings of different levels differ, and the blocks of each as well."""

    def rates(_, y):
        return [y[1], -VISCOUS * y[1] - law(*y) - OMEGA**2 * y[0]]

    t = np.arange(round(FS * SECONDS)) / FS
    recordings = []
    for i, begin in enumerate((1.0, 0.8, 0.3)):
        x = solve_ivp(rates, (0, t[-1]), [begin, 0.0], t_eval=t, rtol=1e-9, atol=1e-12).y[0]
        recordings.append(Recording(f"{i}", FS, x + NOISE * np.random.default_rng(i).standard_normal(t.size)))
    fit = fitted(recordings)
    assert max(s.over_noise for s in fit.segments) > 1.5
    assert differing(fit, recordings) is None


def test_a_driven_motion_is_not_asked():
    force = np.sin(OMEGA * np.arange(600) / FS)
    x, _ = integrate_pieces(MODEL.values() | {"mass": 1.0}, np.column_stack([force[:-1]]), 1 / FS)
    x = x + 1e-3 * np.max(x) * np.random.default_rng(0).standard_normal(x.size)
    recordings = [Recording("driven", FS, x, force=force, hold="zero"), decay("free", 1)]
    model = Oscillator.from_values(MODEL.values() | {"mass": 1.0})
    fit = maximum_likelihood(model, recordings, doubted=False, near=True)
    assert differing(fit, recordings) is None


def test_identify_states_it_and_keeps_all_else():
    _, found = struck_thrice()
    assert max(s.over_noise for s in found.fit.segments) < 1.1
    assert not found.faults
    assert not found.oscillator.terms
    assert len(found.differs) == 1
    assert found.differs[0] in found.notes


def test_the_error_is_no_smaller_than_that_of_a_mean_of_so_many_recordings():
    _, found = struck_thrice()
    values = [OMEGA * factor for factor in (1.0, 1.008, 0.997)]
    assert found.oscillator.omega0.std > np.std(values, ddof=1) / np.sqrt(3)
    # of the damping, which is the same in all, it is that of the noise
    assert found.oscillator.viscous.std < 0.01 * VISCOUS


def test_the_sentence(reads):
    reads(struck_thrice()[1].differs[0], "spread of three")


def test_a_model_is_run_along_a_recording_as_the_rig_was():
    """The same response where a parameter is as much more and the recording says that it differs by as much less."""
    made, _ = differing(fitted(list(struck_thrice()[0])), list(struck_thrice()[0]))
    own = made[1]
    data = data_of([own], MODEL)
    structure = Structure(MODEL, data)
    shifted = MODEL.with_parameters({"omega0": MODEL.omega0.__class__(OMEGA + own.differs[0][1], "rad/s")})
    plain = Structure(shifted, data_of([Recording(own.name, FS, own.response)], shifted))
    state = structure.state(None)
    expected = plain.problem.residuals(plain.state(state.initial))[0]
    assert structure.problem.residuals(state)[0] == pytest.approx(expected)


def test_without_what_differs_a_fit_stays_as_it_is():
    recordings = [decay("a", 1), decay("b", 2)]
    fit = fitted(recordings)
    assert with_spread(fit, recordings) == (fit, ())


def test_pieces_of_one_recording_differ_as_one():
    recordings = differing(fitted(list(struck_thrice()[0])), list(struck_thrice()[0]))[0]
    pieces = [piece for r in recordings for piece in (r.slice(0, 300), r.slice(300, None))]
    whole, halves = (with_spread(fitted(r), r)[0].oscillator.omega0.std for r in (recordings, pieces))
    assert halves == pytest.approx(whole, rel=0.1)


def test_a_deviation_takes_the_place_of_one_that_is_known():
    segment = data_of([decay("a", 1)], MODEL).segments[0]
    deviation = Deviation(0, parameter="omega0")
    once = deviation.meant(segment, np.array([0.3]))
    assert dict(deviation.meant(once, np.array([0.5])).differs) == {"omega0": 0.5}


def test_it_is_found_beside_a_further_law():
    model = with_term(MODEL, "quadratic-drag", {"coefficient": 0.0})
    recordings = list(struck_thrice()[0])
    fit = maximum_likelihood(model, recordings, ("cubic", "preload", "dry"), doubted=False, near=True)
    made, _ = differing(fit, recordings)
    assert [r.differs[0][0] for r in made] == ["omega0"] * 3


def driven(name, seed, *, gain=1.0, omega=1.0, level=1.0, law=0.0):
    """A rig swept over its resonance, by an independent integrator; of a gain of the force, and a drag where asked."""
    t = np.arange(round(FS * 20.0)) / FS
    force = 30.0 * level * np.sin(2 * np.pi * (3.0 * t + 0.1 * t**2))

    def rates(time, y):
        push = 30.0 * level * np.sin(2 * np.pi * (3.0 * time + 0.1 * time**2))
        return [y[1], push - VISCOUS * y[1] - law * y[1] * abs(y[1]) - (omega * OMEGA) ** 2 * y[0]]

    x = solve_ivp(rates, (0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-12, max_step=0.01).y[0]
    x = x + NOISE * np.random.default_rng(seed).standard_normal(t.size)
    return Recording(name, FS, x, force=gain * force)


def fitted_with_a_force(recordings):
    model = Oscillator.from_values(MODEL.values() | {"mass": 1.0})
    return maximum_likelihood(model, recordings, ("cubic", "preload", "dry"), doubted=False, near=True)


def test_a_gain_that_moved_between_driven_recordings_is_found():
    recordings = [driven("a", 1), driven("b", 2, gain=1.02), driven("c", 3, gain=0.995)]
    made, mean = differing(fitted_with_a_force(recordings), recordings)
    assert [[name for name, _ in r.differs] for r in made] == [["mass"]] * 3
    assert [r.differs[0][1] for r in made] == pytest.approx([-0.005, 0.015, -0.01], abs=1e-3)
    assert mean.mass.value == pytest.approx(1.005, abs=1e-3)


def test_so_is_a_frequency_of_driven_recordings_beside_a_decay():
    recordings = [driven("a", 1), driven("b", 2, omega=1.005), driven("c", 3), decay("d", 4)]
    made, _ = differing(fitted_with_a_force(recordings), recordings)
    assert [[name for name, _ in r.differs] for r in made] == [["omega0"]] * 4
    assert made[1].differs[0][1] - made[0].differs[0][1] == pytest.approx(0.005 * OMEGA, abs=3e-4 * OMEGA)


def test_of_driven_recordings_of_several_levels_nothing_is_said_for_missing_physics():
    recordings = [driven(f"{level}", i, level=level, law=0.03) for i, level in enumerate((1.0, 0.6, 0.3))]
    fit = fitted_with_a_force(recordings)
    assert max(s.over_noise for s in fit.segments) > 1.5
    assert differing(fit, recordings) is None


def test_the_sentence_of_a_gain_leaves_out_what_no_force_drives(reads):
    recordings = [driven("a", 1), driven("b", 2, gain=1.02), decay("c", 3)]
    made, mean = differing(fitted_with_a_force(recordings), recordings)
    fit = maximum_likelihood(mean, made, ("cubic", "preload", "dry"), doubted=False, near=True)
    reads(with_spread(fit, made)[1][0], "spread of a gain")

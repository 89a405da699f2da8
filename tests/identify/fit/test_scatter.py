"""The scatter of the score against its closed forms: information under white noise, the drawn noise where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate, integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify.fit.hold import held_as
from dashpot.identify.fit.scatter import scatter
from dashpot.identify.problem.data import data_of, noise_of
from dashpot.identify.problem.linearised import Linearised
from dashpot.identify.problem.normal_equations import pseudo_inverse
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.structure import Structure
from dashpot.identify.signals.noise_spectrum import NoiseSpectrum
from dashpot.model import Oscillator
from dashpot.recording import Recording

FS, NOISE = 500.0, 2e-6
MODEL = Oscillator.from_values(TRUTH)
LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}


def sweep(n):
    t = np.arange(n) / FS
    return np.sin(2 * np.pi * (8 * t + 0.5 * 10 / t[-1] * t**2))


def recorded(values, force, n, begin=(0.0, 0.0), name="run"):
    drive = np.zeros(n) if force is None else force
    x = integrate(values, drive, 1 / FS, *begin)[0]
    y = x + NOISE * np.random.default_rng(1).standard_normal(n)
    return Recording(name, FS, y, force, free=force is None, hold="linear")


def problem_of(values, recordings, offsets=(), fixed=("cubic", "preload", "dry")):
    model = Oscillator.from_values(values)
    structure = Structure(model, data_of(recordings, model, coarse=False), fixed, offsets)
    return structure.problem, structure.state(None)


def flat(problem, level=NOISE):
    return [NoiseSpectrum(np.full(s.n // 2 + 1, level**2), s.n) for s in problem.segments]


def dense(problem, state, level=NOISE):
    """Information on what is shared, from all rows and all initial states at once."""
    derivatives = problem.derivatives(state, problem.residuals(state))
    shared, columns = problem.shared, []
    for i, rows in enumerate(derivatives):
        used = np.flatnonzero(np.any(rows[shared:] != 0.0, axis=1))
        own = np.zeros((len(derivatives), used.size, rows.shape[1]))
        own[i] = rows[shared:][used]
        columns.append((rows[:shared], own))
    upper = np.hstack([rows for rows, _ in columns])
    border = [
        np.hstack([np.zeros((own.shape[1], r.shape[1])) if j != i else own[i] for j, (r, _) in enumerate(columns)])
        for i, (_, own) in enumerate(columns)
    ]
    jacobian = np.vstack([upper, *border])
    scale = np.linalg.norm(jacobian, axis=1)
    jacobian = jacobian / scale[:, None]
    covariance = np.linalg.inv(jacobian @ jacobian.T / level**2)
    return np.linalg.inv(covariance[: len(problem.free), : len(problem.free)]) * np.outer(
        scale[: len(problem.free)], scale[: len(problem.free)]
    )


def same(scattered, expected, rel):
    size = np.sqrt(np.diag(expected))
    assert scattered / np.outer(size, size) == pytest.approx(expected / np.outer(size, size), abs=rel)


def test_of_white_noise_it_is_the_information():
    recordings = [recorded(LINEAR, sweep(4000), 4000), recorded(LINEAR, None, 1500, (8e-3, 0.0), "decay")]
    problem, state = problem_of(LINEAR, recordings)
    expected = dense(problem, state)
    same(scatter(problem, state, flat(problem), [0.0, 0.0], 10), expected, 1e-6)
    noise = flat(problem)
    linear = Linearised.of(problem, state, problem.residuals(state), noise)
    same(linear.information(linear.unknowns.parameters), expected, 1e-6)


def test_with_offsets_it_is_that_of_the_parameters_alone():
    recordings = [recorded(LINEAR, sweep(4000), 4000), recorded(LINEAR, None, 1500, (8e-3, 0.0), "decay")]
    offsets = (Offset(0, "response", 1e-5), Offset(1, "response", 1e-5))
    problem, state = problem_of(LINEAR, recordings, offsets)
    scattered = scatter(problem, state, flat(problem), [0.0, 0.0], 10)
    assert scattered.shape == (3, 3)
    same(scattered, dense(problem, state), 1e-6)


def test_noise_that_is_larger_than_it_was_weighed_scatters_as_much_more():
    problem, state = problem_of(LINEAR, [recorded(LINEAR, sweep(4000), 4000)])
    level = 3e-4
    rough = scatter(problem, state, flat(problem), [level], 400, seed=3)
    twice = scatter(problem, state, flat(problem), [2 * level], 400, seed=3)
    quiet = scatter(problem, state, flat(problem), [0.0], 400)
    same((twice - quiet) / 4.0, rough - quiet, 0.01)  # a variance, of a rig that is linear


def test_force_noise_goes_through_the_rig_as_its_impulse_response_says():
    """Of a linear rig the scatter by force noise is in closed form: the score's rows folded with the response."""
    n, level = 3000, 3e-4
    problem, state = problem_of(LINEAR, [recorded(LINEAR, sweep(n), n)])
    (segment,) = problem.segments
    assert segment.force.fine == 1
    rows = (
        problem.derivatives(state, problem.residuals(state))[0][:3] / NOISE**2
    )  # at rest: no initial state to project
    kick = np.zeros(n)
    kick[1] = 1.0
    shape = integrate(LINEAR, kick, 1 / FS)[0]  # what one sample of force, joined by straight lines, does
    folded = np.array([[row[k:] @ shape[1 : n - k + 1] for k in range(1, n)] for row in rows])
    expected = level**2 * folded @ folded.T
    quiet = scatter(problem, state, flat(problem), [0.0], 1)
    scattered = scatter(problem, state, flat(problem), [level], 1) - quiet
    same(scattered, expected, 6e-3)  # a straight line is taken for its mean over an interval, 25 to 60 of a cycle


def test_drawn_noise_scatters_the_score_as_the_adjoint_says(monkeypatch):
    """Of the whole law, with friction that turns and a preload; once no draw is simulated."""
    n, level = 8000, 3e-4
    problem, state = problem_of(TRUTH, [recorded(TRUTH, sweep(n), n)], fixed=())
    adjoint = scatter(problem, state, flat(problem), [level], 1)
    monkeypatch.setattr(problem, "felt", lambda *_: None)
    same(adjoint, scatter(problem, state, flat(problem), [level], 600, seed=4), 0.2)  # a variance is good to 6 %


def test_without_draws_nothing_is_simulated_for_the_noise(monkeypatch):
    n, level = 4000, 3e-4
    problem, state = problem_of(TRUTH, [recorded(TRUTH, sweep(n), n)], fixed=())
    adjoint = scatter(problem, state, flat(problem), [level], 1)
    own, runs = problem.simulate, []

    def simulate(i, point, **how):
        runs.append(how)
        return own(i, point, **how)

    monkeypatch.setattr(problem, "simulate", simulate)
    same(scatter(problem, state, flat(problem), [level], 0), adjoint, 1e-9)
    assert not any("added" in how for how in runs)


def test_noise_of_levels_is_the_same_on_all_samples_of_each(monkeypatch):
    """As the adjoint says and as draws do; of levels longer than a cycle much less than of as noisy samples."""
    n, level = 6000, 3e-4
    force = np.repeat(np.random.default_rng(7).choice([-1.0, 1.0], n // 60), 60)  # two cycles or so
    response = integrate_pieces(LINEAR, force[:-1, None], 1 / FS)[0]
    recording = Recording("levels", FS, response, force, hold="zero")
    problem, state = problem_of(LINEAR, [recording])
    quiet = scatter(problem, state, flat(problem), [0.0], 1)
    adjoint = scatter(problem, state, flat(problem), [level], 1) - quiet
    monkeypatch.setattr(problem, "felt", lambda *_: None)
    same(scatter(problem, state, flat(problem), [level], 600, seed=4) - quiet, adjoint, 0.2)
    noisy, _ = problem_of(LINEAR, [replace(recording, force=force + 1e-9 * np.arange(n))])
    by_sample = scatter(noisy, state, flat(noisy), [level], 1) - quiet
    assert np.all(np.diag(adjoint) < 0.7 * np.diag(by_sample))


def test_the_mean_of_a_level_is_known_as_well_as_its_samples():
    recording = recorded(LINEAR, sweep(4000), 4000)
    force = np.repeat([0.0, 1.0, -1.0, 0.5], 1000) + 0.01 * np.random.default_rng(3).standard_normal(4000)
    (held,) = held_as([replace(recording, force=force, hold=None)], "zero")
    assert np.unique(held.force).size == 4
    assert held.force_noise == pytest.approx(0.01, rel=0.1)
    assert held_as([held], "zero")[0].force_noise == held.force_noise
    assert recording.force_noise == 0.0


def test_of_a_long_sweep_the_errors_are_near_those_of_the_information():
    """Below them: noise is taken for stationary there, and rings otherwise where the sweep is elsewhere.

    In the score, weighed by such noise, little is left of much: scores of parts of the record would leave twice that.
    """
    n, level = 100_000, 1e-3
    t = np.arange(n) / 1000.0
    force = 10.0 * np.sin(2 * np.pi * (5.0 * t + 0.1 * t**2))
    random = np.random.default_rng(1)
    x = integrate(TRUTH, force + level * random.standard_normal(n), 1e-3)[0] + 1e-6 * random.standard_normal(n)
    problem, state = problem_of(TRUTH, [Recording("long", 1000.0, x, force, hold="linear")], fixed=())
    residuals = problem.residuals(state)
    noise = noise_of(problem.segments, residuals, TRUTH, np.inf)
    spread = scatter(problem, state, noise, [level], 60, seed=5)
    inverse = pseudo_inverse(Linearised.of(problem, state, residuals, noise).shared.normal)
    ratios = np.sqrt(np.diag(inverse @ spread @ inverse) / np.diag(inverse))
    assert np.all(ratios > 0.25)
    assert np.all(ratios < 1.0)


@pytest.mark.parametrize("offsets", [(), (Offset(0, "response", 1e-5),)])
def test_where_nothing_is_to_be_found_there_is_no_score(offsets):
    """Nor is anything simulated for one."""
    problem, state = problem_of(LINEAR, [recorded(LINEAR, sweep(2000), 2000)], offsets, fixed=tuple(LINEAR))
    problem.simulate = None
    assert scatter(problem, state, flat(problem), [3e-4], 60).shape == (0, 0)

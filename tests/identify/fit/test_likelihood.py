"""The likelihood for models that are not exact: simulation where it can be, never lost, honest where it is wrong."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify.fit.from_prediction import memories
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.fit.reported_result import _said_otherwise
from dashpot.identify.problem.data import data_of, noise_spectra
from dashpot.identify.problem.linearised import Linearised
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from dashpot.recording import Recording
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

# --- Eq. 17 exactly


def exact(recorded, seed=0, noise=1e-6):
    decay = recorded(begin=(8e-3, 0.0), seconds=2.0, noise=noise, seed=seed, name="decay")
    sweep = recorded(sweep=(1.0, 5.0, 20.0), seconds=8.0, noise=noise, force_noise=1e-4, seed=seed + 50, name="sweep")
    return decay, replace(sweep, hold="smooth")


def linear_start(**values):
    plain = {"mass": 0.3, "omega0": 76.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}
    return Oscillator.from_values(plain | values)


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2, 3))])
def test_an_exact_rig_is_simulated_and_found_within_its_errors(recorded, seed):
    fit = maximum_likelihood(linear_start(), exact(recorded, seed))
    assert fit.memory == FREE
    assert fit.offsets == ()
    assert fit.converged
    assert fit.notes == ()
    known = fit.oscillator.parameters()
    scores = {name: (known[name].value - value) / known[name].std for name, value in TRUTH.items()}
    assert max(map(abs, scores.values())) < 4, scores
    assert all(0.9 < s.over_noise < 1.1 for s in fit.segments)


def test_its_errors_are_those_of_the_information(recorded):
    """Cramér-Rao at the truth, in white noise whose level is known, all initial states from one dense matrix."""
    (decay,) = exact(recorded)[:1]
    decay = replace(decay, free=True)
    fit = maximum_likelihood(linear_start(mass=None), [decay])
    truth = Oscillator.from_values(TRUTH | {"mass": None})
    problem = Structure(truth, data_of([decay], truth, coarse=False)).problem
    state = replace(Structure(truth, data_of([decay], truth, coarse=False)).state(None))
    state.initial[0] = 8e-3, 0.0
    rows = problem.derivatives(state, problem.residuals(state))[0] / 1e-6
    size = np.linalg.norm(rows, axis=1)
    bound = np.sqrt(np.diag(np.linalg.inv((rows / size[:, None]) @ (rows / size[:, None]).T))) / size
    for name, expected in zip(fit.names, bound, strict=False):
        assert fit.oscillator.parameters()[name].std == pytest.approx(expected, rel=0.3), name


@pytest.mark.parametrize("starts", [4, pytest.param(20, marks=pytest.mark.long)])
def test_every_start_reaches_the_same_optimum(recorded, starts):
    """A fifth of the frequency, five times the damping, a cubic of any sign: all end where the first did."""
    recordings, random = exact(recorded), np.random.default_rng(0)
    size = TRUTH["omega0"] ** 2 / 8e-3**2
    rows = []
    for _ in range(starts):
        start = linear_start(
            mass=TRUTH["mass"] * 2 ** random.uniform(-1, 1),
            omega0=TRUTH["omega0"] * random.uniform(0.8, 1.2),
            cubic=random.choice([-1.0, 1.0]) * random.uniform(0.0, 0.2) * size,
            viscous=TRUTH["viscous"] * 5 ** random.uniform(-1, 1),
        )
        fit = maximum_likelihood(start, recordings)
        assert fit.memory == FREE
        rows.append([p.value for p in fit.oscillator.parameters().values()])
    table = np.array(rows)
    assert np.max(np.abs(table / np.median(table, axis=0) - 1)) < 1e-4


# --- a rig that is not in the family

W, FS = 2 * np.pi * 5.0, 200.0


@cache
def strange(drag, quintic, viscous):
    """Sixty cycles from 8 mm with quadratic drag and a quintic spring, the latter a part of the linear force there."""
    fifth = quintic * W**2 / 8e-3**4
    t = np.arange(round(12.0 * FS)) / FS

    def rates(_, y):
        x, v = y
        return v, -W * W * x - fifth * x**5 - viscous * v - drag * v * abs(v)

    x = solve_ivp(rates, (0, t[-1]), (8e-3, 0.0), t_eval=t, method="DOP853", rtol=1e-10, atol=1e-14).y[0]
    return Recording("strange", FS, x + 2e-6 * np.random.default_rng(0).standard_normal(t.size), free=True)


def plain_fit(recording):
    """What the best of all damped sines leaves of a motion: least squares in amplitudes, frequency and decay rate."""
    y, t = np.asarray(recording.response), np.arange(recording.n) / recording.fs

    def residual(p):
        envelope = np.exp(-p[1] * t)
        columns = np.column_stack([envelope * np.cos(p[0] * t), envelope * np.sin(p[0] * t)])
        return columns @ np.linalg.lstsq(columns, y)[0] - y

    starts = W * np.linspace(0.95, 1.2, 26)
    best = min((least_squares(residual, (w, 0.2), x_scale=(1.0, 0.1)) for w in starts), key=lambda fit: fit.cost)
    return float(np.std(residual(best.x)) / np.std(y))


def off(part):
    return Oscillator.from_values(
        {"omega0": part * W, "viscous": 0.3, "cubic": 0.0, "preload": 0.0, "dry": 0.0, "mass": None}
    )


RIGS = [(3.0, 0.35, 0.1), (3.0, 0.35, 0.3), (1.0, 0.2, 0.05)]
FIRST_OF_RIGS = [RIGS[0], *(pytest.param(rig, marks=pytest.mark.long) for rig in RIGS[1:])]


@cache
def fitted_from(part, rig):
    """The most likely model of a strange rig from a start that many times off; made once."""
    return maximum_likelihood(off(part), [strange(*rig)])


@pytest.mark.parametrize("start", [0.9, 1.1])
@pytest.mark.parametrize("rig", FIRST_OF_RIGS)
def test_a_wrong_model_from_a_bad_start_beats_a_plain_fit(rig, start):
    """A tenth of a frequency over sixty cycles is six turns of phase: output error from there runs away."""
    recording, fit = strange(*rig), fitted_from(start, rig)
    (only,) = fit.segments
    assert only.nrmse < 0.5 * plain_fit(recording)
    assert only.over_noise > 10  # it is a wrong model, and says so
    simulated = only.simulated - np.asarray(recording.response)
    assert only.nrmse == pytest.approx(np.sqrt(np.mean(simulated**2)) / np.std(recording.response))


@pytest.mark.parametrize("rig", FIRST_OF_RIGS)
def test_both_sides_lead_to_the_same_place(rig):
    low, high = (fitted_from(part, rig) for part in (0.9, 1.1))
    for name, parameter in low.oscillator.parameters().items():
        assert high.oscillator.parameters()[name].value == pytest.approx(parameter.value, abs=0.02 * parameter.std)


def weighed(model, data):
    """The most likely prediction: white first, then every frequency weighed by what was left there, twice."""
    fitted = Structure(model, data).fit(tolerance=1e-3, most=60)
    for _ in range(2):
        noise = noise_spectra(fitted.residuals, fitted.model, data)
        fitted = Structure(fitted.model, data).fit(fitted.initial, noise=noise, tolerance=1e-3, most=60)
    return fitted


@pytest.mark.parametrize("rig", FIRST_OF_RIGS)
def test_the_errors_of_a_wrong_model_cover_what_another_memory_says(rig):
    """Hausman 1978: simulation and prediction of a right model agree; of a wrong one they do not, and it is told."""
    recording = strange(*rig)
    fit = maximum_likelihood(off(1.0), [recording])
    assert fit.memory == FREE
    data = data_of([recording], fit.oscillator, coarse=False)
    predicted = [weighed(fit.oscillator, replace(data, memory=memory)) for memory in memories(data.segments)]
    likely = max(predicted, key=lambda p: p.likelihood).model.parameters()
    known = fit.oscillator.parameters()
    apart = np.array([abs(known[name].value - likely[name].value) for name in fit.names])
    errors = np.array([known[name].std for name in fit.names])
    assert np.max(apart / errors) < 3
    # without that part they would be those of what is left, as if it were noise
    structure = Structure(fit.oscillator, data)
    state = structure.state(np.array([fit.segments[0].initial]))
    residuals = structure.problem.residuals(state)
    spectra = noise_spectra(residuals, fit.oscillator, data)
    linear = Linearised.of(structure.problem, state, residuals, spectra)
    without = np.sqrt(np.diag(np.linalg.inv(linear.information(linear.unknowns.parameters))))
    assert np.max(apart / without) > 3
    assert np.max(errors / without) > 2


def test_a_structure_that_simulates_nowhere_is_refused():
    """A frequency that is no number: no prediction of it is one."""
    bad = off(1.0).with_parameters({"viscous": replace(off(1.0).viscous, value=-1e6)})
    with pytest.raises(BadInput, match="check signs and units"):
        maximum_likelihood(bad, [strange(*RIGS[0])])


@pytest.mark.parametrize(
    ("odds", "promised", "searched", "counts"),
    [
        (999.0, {1.0: (-9.0, 5.0), 8.0: (0.0, 4.0)}, [1.0, 8.0], False),  # twice what each gains would be decisive
        (1001.0, {1.0: (-9.0, -5.0), 8.0: (0.0, 4.0)}, [8.0], True),  # the likelier first, which is decisive
        (1001.0, {1.0: (-9.0, -5.0), 8.0: (0.0, 3.4)}, [], False),  # twice 3.4 is odds of 898
        (np.inf, {1.0: (-np.inf, -np.inf), 8.0: (-np.inf, -np.inf)}, [], False),
    ],
)
def test_a_prediction_counts_against_a_simulation_at_odds_of_a_thousand(monkeypatch, odds, promised, searched, counts):
    """Of two memories the likelier is asked; what it says otherwise goes into the standard errors."""
    module, asked = "dashpot.identify.fit.reported_result", []
    found = SimpleNamespace(likelihood=float(np.log(odds)))
    monkeypatch.setattr(f"{module}.memories", lambda _: [1.0, 8.0])
    monkeypatch.setattr(f"{module}._nearest", lambda *_: None)
    monkeypatch.setattr(f"{module}.within_reach", lambda memory, *_: promised[memory])
    monkeypatch.setattr(f"{module}.whitened", lambda memory, *_, **__: asked.append(memory) or (found, 3))
    monkeypatch.setattr(f"{module}._apart", lambda one, other: one is not other)
    simulated = SimpleNamespace(likelihood=0.0, outcome=SimpleNamespace(state=None))
    problem = SimpleNamespace(segments=(), predicting=lambda memory: memory)
    apart, steps = _said_otherwise(problem, simulated, {}, None, 5)
    assert (asked, apart, steps) == (searched, counts, 3 * len(searched))

"""What speaks for a fit: against Laplace's integral over a damped oscillator that is written out here."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
from dashpot.diagnose.search.measure import Measure
from dashpot.diagnose.search.weigh import (
    evidence_of,
    foreseen_loss,
    foretold,
    foretold_by_the_others,
    forget,
    initial_prior,
    judged,
    shared_prior,
    stretches_of,
)
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data, data_of
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.structure import Fitted, Structure
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.equations import equations
from dashpot.model.law import Scales
from dashpot.model.terms import with_term

FS, NOISE = 500.0, 1e-5
#: Damped and linear, so that the motion has a closed form.
LINEAR = TRUTH | {"cubic": 0.0, "preload": 0.0, "dry": 0.0}
MODEL = Oscillator.from_values({name: value for name, value in LINEAR.items() if name != "mass"})
FREE = ("omega0", "viscous")
KEPT = ("cubic", "preload", "dry")
#: Displacement and velocity where each recording begins.
BEGINS = ((8e-3, 0.0), (5e-3, 0.1))


def closed_form(omega: float, viscous: float, x0: float, v0: float, n: int) -> np.ndarray:
    """(n,) displacement of x'' + viscous x' + omega² x = 0."""
    t, decay = np.arange(n) / FS, viscous / 2
    turn = np.sqrt(omega**2 - decay**2)
    return np.exp(-decay * t) * (x0 * np.cos(turn * t) + (v0 + decay * x0) / turn * np.sin(turn * t))


@pytest.fixture(scope="module")
def decays(recorded) -> Data:
    """Two free decays."""
    runs = [recorded(LINEAR, begin=b, seconds=2.0, noise=NOISE, seed=i, name=f"run {i}") for i, b in enumerate(BEGINS)]
    return data_of(runs, MODEL)


def only(data: Data, *places: int) -> Data:
    """Some of the segments."""
    parts = {name: tuple(getattr(data, name)[i] for i in places) for name in ("segments", "sensor", "force")}
    return replace(data, **parts)


def with_zeros(data: Data, *taken: float) -> Data:
    """The same, each sensor's zero free; so much of it was taken off the recordings before."""
    feeler = data.scales.length / 100
    return replace(data, offsets=tuple(Offset(i, "response", feeler, taken=off) for i, off in enumerate(taken)))


def fit_to(data: Data, kept: tuple[str, ...] = KEPT) -> Fitted:
    return Structure(MODEL, data, kept).fit(tolerance=1e-6)


def white(residuals) -> list[float]:
    """What each segment's samples say where all frequencies count alike and the level is what is left."""
    return [-0.5 * r.size * np.log(np.mean(r**2)) for r in residuals]


def by_hand(fitted: Fitted, data: Data) -> float:
    """Log-evidence of free decays: everything unknown in one joint integral, derivatives by the closed form."""
    values = fitted.model.values()
    at = [values[name] for name in FREE]
    wide, middles = [data.scales.omega] * 2, [0.0, 0.0]
    length, rate = data.scales.length, data.scales.length * data.scales.omega
    columns = []
    for i, (segment, begin) in enumerate(zip(data.segments, fitted.initial, strict=True)):
        zeros = [(o, value) for o, value in zip(data.offsets, fitted.offsets, strict=True) if o.recording == i]
        point = np.array([*at[:2], *begin])
        feelers = np.array([1e-4, 1e-4, 1e-7, 1e-5])
        slopes = [
            (closed_form(*(point + step), segment.n) - closed_form(*(point - step), segment.n)) / (2 * feeler)
            for step, feeler in zip(np.diag(feelers), feelers, strict=True)
        ]
        columns.append(np.array([*slopes, *(np.ones(segment.n) for _ in zeros)]))
        at += [*begin, *(value for _, value in zeros)]
        wide += [length, rate, *(length for _ in zeros)]
        middles += [0.0, 0.0, *(-o.taken for o, _ in zeros)]
    matrix = np.diag(np.array(wide) ** -2.0)
    place = 2
    for slopes, residual in zip(columns, fitted.residuals, strict=True):
        own = np.r_[0, 1, place : place + len(slopes) - 2]
        matrix[np.ix_(own, own)] += slopes @ slopes.T / np.mean(residual**2)
        place += len(slopes) - 2
    prior = -np.sum(np.log(np.pi * np.array(wide) * (1 + ((np.array(at) - middles) / wide) ** 2)))
    return sum(white(fitted.residuals)) + prior - 0.5 * np.linalg.slogdet(matrix / (2 * np.pi))[1]


# --- what a model as it is leaves


def test_a_true_model_on_recordings_it_was_not_fitted_to_leaves_their_noise(decays):
    told = judged(MODEL, decays)
    assert told.model.values() == MODEL.values()
    assert told.free == ()
    for residual, initial, begin in zip(told.residuals, told.initial, BEGINS, strict=True):
        assert np.std(residual) == pytest.approx(NOISE, rel=0.1)
        assert initial == pytest.approx(begin, abs=5e-4)


def test_a_sensors_zero_is_found_anew(decays):
    shifted = tuple(replace(s, response=s.response + 1e-3 * (1 + i)) for i, s in enumerate(decays.segments))
    told = judged(MODEL, with_zeros(replace(decays, segments=shifted), 0.0, 0.0))
    assert told.offsets == pytest.approx([1e-3, 2e-3], abs=2e-6)
    assert np.std(told.residuals[1]) == pytest.approx(NOISE, rel=0.1)


def test_what_does_not_simulate_tells_nothing_of_its_recording_alone(decays):
    """A spring that softens to nothing is passed by the larger motion only."""
    softening = MODEL.with_parameters({"cubic": replace(MODEL.cubic, value=-1.2 * MODEL.omega0.value**2 / 8e-3**2)})
    small = replace(decays.segments[1], response=0.1 * decays.segments[1].response)
    data = replace(decays, segments=(decays.segments[0], small))
    told = judged(softening, data)
    assert told.residuals[0] is data.segments[0].response
    assert told.finite
    assert np.std(told.residuals[1]) < 0.3 * np.std(small.response)


# --- evidence


def test_evidence_of_decays_is_the_integral_over_all_that_is_unknown(decays):
    fitted = fit_to(decays)
    value, training = evidence_of(fitted, decays, Measure())
    assert value == pytest.approx(by_hand(fitted, decays), abs=0.02)
    assert training.information.shape == (2, 2)
    assert np.linalg.norm(training.gradient / np.sqrt(np.diag(training.information))) < 0.1


def test_a_sensors_zero_is_averaged_over_in_its_recording(decays):
    """As wide as the motion, about what was taken off before."""
    data = with_zeros(decays, 0.5 * decays.scales.length, -2.0 * decays.scales.length)
    fitted = fit_to(data)
    assert evidence_of(fitted, data, Measure())[0] == pytest.approx(by_hand(fitted, data), abs=0.02)


def test_a_zero_belongs_to_one_recording(decays):
    data = replace(decays, offsets=(Offset(1, "response", decays.scales.length / 100),))
    fitted = fit_to(data)
    assert evidence_of(fitted, data, Measure())[0] == pytest.approx(by_hand(fitted, data), abs=0.02)


def test_what_was_kept_is_no_unknown_and_costs_nothing(decays):
    """Friction that is free costs its range and gains nothing where there is none."""
    data = only(decays, 0)
    plain, freed = (evidence_of(fit_to(data, kept), data, Measure())[0] for kept in (KEPT, ("preload", "dry")))
    assert freed < plain - 3.0


def test_free_motion_says_nothing_of_the_mass(decays):
    """It is among the parameters all the same where it was free in what was driven."""
    model = Oscillator.from_values(LINEAR)
    fitted = fit_to(decays)
    both = replace(fitted, model=model.with_parameters({n: fitted.model.parameters()[n] for n in FREE}))
    value, training = evidence_of(replace(both, free=("mass", *FREE)), decays, Measure())
    assert np.all(training.information[0] == 0.0)
    assert np.all(training.information[1:, 1:] != 0.0)
    assert training.gradient[0] == 0.0
    # what it could be is as wide before as behind, but for its place: a Cauchy's density times its Gaussian's width
    alone = np.log(np.sqrt(2 * np.pi) / (2 * np.pi))
    assert value == pytest.approx(evidence_of(fitted, decays, Measure())[0] + alone, abs=1e-3)


def test_the_measure_is_that_of_the_search(decays):
    fitted = fit_to(decays)
    measure = Measure(tuple(Measure().spectra([2.0 * r for r in fitted.residuals])))
    told, plain = (evidence_of(fitted, decays, by)[1] for by in (measure, Measure()))
    # levels are concentrated out: twice the noise in the spectrum is half of it in the level
    assert told.information == pytest.approx(plain.information, rel=1e-6)
    points = sum(r.size * np.log(2 * np.std(r)) for r in fitted.residuals)
    assert told.log_likelihood - plain.log_likelihood == pytest.approx(points, rel=1e-3)


# --- what is foretold


def test_what_is_held_out_is_worth_what_it_adds_to_the_evidence(decays):
    """The chain rule: of both recordings together, less that of the training."""
    training, holdout = only(decays, 0), only(decays, 1)
    fitted = fit_to(training)
    before, told = evidence_of(fitted, training, Measure())
    value = foretold(fitted, told, training, judged(fitted.model, holdout), holdout, Measure())
    assert value == pytest.approx(evidence_of(fit_to(decays), decays, Measure())[0] - before, abs=0.1)


def test_a_model_that_is_off_foretells_worse(decays):
    training, holdout = only(decays, 0), only(decays, 1)
    fitted = fit_to(training)
    told = evidence_of(fitted, training, Measure())[1]
    off = fitted.model.with_parameters({"omega0": replace(fitted.model.omega0, value=1.01 * fitted.model.omega0.value)})
    good, bad = (
        foretold(fitted, told, training, judged(model, holdout), holdout, Measure()) for model in (fitted.model, off)
    )
    assert good > bad + 100.0


def test_what_a_law_is_worth_is_foreseen_where_one_step_takes_it_away(decays):
    """Against a fit without it, where all that speaks for it is chance."""
    with_drag, plain = (
        Structure(model, decays, KEPT).fit(tolerance=1e-9)
        for model in (with_term(MODEL, "quadratic-drag", {"coefficient": 0.1}), MODEL)
    )
    lost = Measure().value(with_drag.residuals) - Measure().value(plain.residuals)
    assert lost > 0.01
    assert foreseen_loss(with_drag, decays, "quadratic-drag", Measure()) == pytest.approx(lost, rel=0.02)


@pytest.mark.parametrize(
    ("law", "size", "foreseen"),
    [("sensor-lag", {"time": 1e-3}, True), ("actuator-saturation", {"limit": 1.0}, False)],
)
def test_of_what_no_strength_takes_away_nothing_is_foreseen(decays, law, size, foreseen):
    model = with_term(MODEL, law, size)
    structure = Structure(model, decays, KEPT)
    state = structure.state(None)
    free = structure.free if law == "sensor-lag" else (*structure.free, f"{law}.limit")
    fitted = Fitted(model, state.initial, structure.problem.residuals(state), 0.0, free, state.offsets)
    assert (foreseen_loss(fitted, decays, law, Measure()) > 0.0) == foreseen


@pytest.mark.parametrize(("cycles", "count"), [(5.95, 1), (6.05, 3), (20.0, 3)])
def test_a_recording_is_cut_in_three_where_each_has_two_cycles(decays, cycles, count):
    n = round(cycles * 2 * np.pi / MODEL.omega0.value * FS)
    data = only(decays, 0)
    segment = replace(data.segments[0].part(0, n), rests=True)
    stretches = stretches_of(replace(data, segments=(segment,)))
    assert len(stretches.segments) == len(stretches.sensor) == len(stretches.force) == count
    lengths = [stretch.n for stretch in stretches.segments]
    assert max(lengths) - min(lengths) <= 1
    joined = np.concatenate([stretch.response for stretch in stretches.segments])
    assert np.array_equal(joined, segment.response)
    assert [stretch.rests for stretch in stretches.segments] == [True, False, False][:count]
    times = [segment.time + sum(lengths[:k]) / FS for k in range(count)]
    assert [stretch.time for stretch in stretches.segments] == pytest.approx(times)


def test_each_stretch_has_the_noise_of_its_recording(decays):
    short = decays.segments[1].part(0, 100)
    data = replace(decays, segments=(decays.segments[0], short), sensor=(1.0, 2.0), force=(3.0, 4.0))
    stretches = stretches_of(data)
    assert [stretch.recording for stretch in stretches.segments] == [0, 0, 0, 1]
    assert stretches.sensor == (1.0, 1.0, 1.0, 2.0)
    assert stretches.force == (3.0, 3.0, 3.0, 4.0)
    assert stretches.recordings is data.recordings


def test_stretches_are_foretold_from_one_another(decays):
    """Each by the chain rule: the evidence of all stretches, less that of the others."""
    data = only(decays, 0)
    stretches = stretches_of(data)
    value = foretold_by_the_others(fit_to(data), stretches, Measure())
    whole = evidence_of(fit_to(stretches), stretches, Measure())[0]
    others = [only(stretches, *(k for k in range(3) if k != i)) for i in range(3)]
    assert value == pytest.approx(sum(whole - evidence_of(fit_to(o), o, Measure())[0] for o in others), abs=0.3)


def test_a_search_that_has_ended_keeps_nothing(decays):
    """What was weighed is remembered, its derivatives and all, until it is given back."""
    data = replace(only(decays, 0))
    watched = weakref.ref(data)
    evidence_of(fit_to(data), data, Measure())
    del data
    gc.collect()
    assert watched() is not None
    forget()
    gc.collect()
    assert watched() is None


# --- priors


def test_a_parameter_could_be_as_large_as_is_natural():
    scales = Scales(length=2e-3, omega=50.0, force=3.0, response=2e-3, duration=10.0, mass=0.3)
    model = oscillator_with(TRUTH | {"mass": 0.4, "quadratic-drag.coefficient": 1.0}, effects=("quadratic-drag",))
    widths = {
        "mass": 0.4,
        "omega0": 50.0,
        "cubic": 50.0**2 / 2e-3**2,
        "preload": 50.0**2 * 2e-3,
        "viscous": 50.0,
        "dry": 50.0**2 * 2e-3,
        "quadratic-drag.coefficient": 1 / 2e-3,
    }
    middle, width = shared_prior(model, tuple(widths), scales)
    assert np.all(middle == 0.0)
    assert width == pytest.approx(list(widths.values()))
    assert shared_prior(model, ("dry", "mass"), scales)[1] == pytest.approx([50.0**2 * 2e-3, 0.4])


def test_a_motion_could_begin_anywhere_within_its_size(decays, with_law):
    model = with_law("attached-resonator")
    units = [state.unit for state in equations(model).inner]
    assert units == ["X", "X/s"]
    length, rate = decays.scales.length, decays.scales.length * decays.scales.omega
    middle, width = initial_prior(model, decays)
    assert np.all(middle == 0.0)
    assert width == pytest.approx([length, rate, length, rate])

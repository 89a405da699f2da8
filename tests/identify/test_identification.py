"""The main job: the built-in rig from its recordings alone, and what identification does with other kinds of input."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples import recordings
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify import identify
from dashpot.identify.identification import belong_together
from dashpot.identify.left import has_lost
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.file import dumps, loads
from dashpot.recording import Recording, read
from dashpot.simulate.core import core_of, internal_step

#: Percent, from the project's promise.
WITHIN = {"mass": 0.5, "omega0": 0.5, "viscous": 0.5, "cubic": 3.0, "preload": 5.0, "dry": 5.0}


@pytest.fixture(scope="module")
def identification():
    files = recordings()
    return identify([read(files[kind]) for kind in ("bursts", "sweep_low", "sweep_high")], name="paper-stand")


@pytest.mark.parametrize("name", WITHIN)
def test_each_parameter_is_found_and_its_error_is_honest(identification, name):
    parameter = identification.oscillator.parameters()[name]
    assert abs(parameter.value / TRUTH[name] - 1) < WITHIN[name] / 100
    assert abs(parameter.value - TRUTH[name]) < 3 * parameter.std


def test_what_is_left_over_is_the_noise(identification):
    for fit in identification.fit.segments:
        rms = fit.nrmse * np.std(fit.segment.response)
        assert 0.9e-6 < rms < 1.25e-6  # 1 µm of the sensor, and the force's noise through the resonance


def test_the_four_decays_are_found_by_themselves(identification):
    starts = [decay.start for decay in identification.hilbert.decays[0]]
    assert len(starts) == 4
    assert starts == pytest.approx([1500, 6500, 11500, 16500], abs=3)


def test_nothing_is_remarked_where_the_model_is_complete(identification):
    assert identification.notes == ()


def test_every_method_has_left_its_curve(identification):
    methods = [(curve.recording, curve.method) for curve in identification.hilbert.curves]
    assert methods.count(("bursts.csv.gz", "freevib")) == 4
    assert ("sweep_low.csv.gz", "regression") in methods
    assert ("sweep_high.csv.gz", "regression") in methods


def test_the_model_file_holds_the_result(identification):
    again = loads(dumps(identification.oscillator))
    assert again.values() == identification.oscillator.values()
    assert [r["kind"] for r in again.identified.recordings] == ["bursts", "sweep", "sweep"]
    errors = np.sqrt(np.diag(np.array(again.identified.covariance)))
    assert errors == pytest.approx([p.std for p in again.parameters().values()], rel=1e-3)
    assert again.amplitude.max == pytest.approx(9.1e-3, rel=0.02)
    assert again.frequency.min == pytest.approx(5, abs=0.3)
    assert again.frequency.max == pytest.approx(20, abs=0.3)


# Other kinds of input, simulated short --------------------------------------------------------------------------------


def record(kind, quantity="displacement", seed=0, noise=1e-4, values=TRUTH, seconds=12.0, fs=1000.0):
    """A recording of a rig: a sweep through the resonance or a decay from 8 mm, with a little white noise."""
    natural = values["omega0"] / 2 / np.pi
    level = values["mass"] / TRUTH["mass"]
    sweep = (level, 0.5 * natural, 1.5 * natural) if kind == "sweep" else None
    begin = (0.0, 0.0) if kind == "sweep" else (8e-3, 0.0)
    name = f"{kind}-{seed}"
    clean = recording_of(
        values, sweep=sweep, begin=begin, fs=fs, seconds=seconds, quantity=quantity, noise=0.0, name=name
    )
    disturbed = noise * np.std(clean.response) * np.random.default_rng(seed).standard_normal(clean.n)
    return replace(clean, response=clean.response + disturbed)


def test_free_decays_alone_give_everything_but_the_mass():
    result = identify([record("decay", seed=seed, seconds=4.0) for seed in range(3)])
    assert result.oscillator.mass is None
    for name in ("omega0", "viscous", "preload", "dry", "cubic"):
        parameter = result.oscillator.parameters()[name]
        assert abs(parameter.value / TRUTH[name] - 1) < WITHIN[name] / 100, name


@pytest.mark.long  # of each a case in test_accelerometer.py
@pytest.mark.parametrize("quantity", ["velocity", "acceleration"])
def test_velocity_and_acceleration_serve_as_well(quantity):
    result = identify([record("sweep", quantity), record("decay", quantity, seconds=4.0)])
    for name in ("mass", "omega0", "viscous"):
        parameter = result.oscillator.parameters()[name]
        assert abs(parameter.value / TRUTH[name] - 1) < WITHIN[name] / 100, name
    assert result.oscillator.preload.unit == "m/s2"


def test_few_samples_a_cycle_are_enough_because_the_force_is_not_held():
    values = TRUTH | {"preload": 0.0, "dry": 0.0}
    fine = record("sweep", seconds=30.0, values=values, noise=0.0)
    random = np.random.default_rng(5)
    coarse = Recording(
        name="coarse",
        fs=125.0,  # ten samples a cycle
        response=fine.response[::8] + 1e-6 * random.standard_normal(fine.response[::8].size),
        force=fine.force[::8],
    )
    parameters = identify([coarse]).oscillator.parameters()
    assert parameters["mass"].value == pytest.approx(TRUTH["mass"], rel=2e-3)
    assert parameters["viscous"].value == pytest.approx(TRUTH["viscous"], rel=5e-3)


@pytest.mark.parametrize("scale", [1e-2, pytest.param(1.0, marks=pytest.mark.long), 1e2])
def test_rigs_of_other_sizes_and_frequencies(scale):
    values = {
        "mass": 3.0 * scale,
        "omega0": 2 * np.pi * 45.0,
        "cubic": 2e6,
        "preload": 0.5,
        "viscous": 12.0,
        "dry": 0.3,
    }
    recordings = [record("sweep", values=values, fs=3000.0), record("decay", values=values, fs=3000.0, seconds=2.0)]
    parameters = identify(recordings).oscillator.parameters()
    for name in ("mass", "omega0", "viscous"):
        assert parameters[name].value == pytest.approx(values[name], rel=5e-3), name


@pytest.mark.long
def test_standard_errors_hold_over_many_noises():
    scores = []
    for seed in range(8):
        sweep, decay = record("sweep", seed=seed, noise=2e-3), record("decay", seed=seed + 50, noise=2e-3, seconds=4.0)
        force = sweep.force + 1e-3 * np.random.default_rng(seed + 500).standard_normal(sweep.n)
        noisy = Recording(name="sweep", fs=sweep.fs, response=sweep.response, force=force)
        parameters = identify([noisy, decay]).oscillator.parameters()
        scores.append([(p.value - TRUTH[name]) / p.std for name, p in parameters.items()])
    spread = np.sqrt(np.mean(np.square(scores), axis=0))
    assert np.all(spread < 1.9)  # chi-square with 8 degrees: 1.9 is exceeded once in ten thousand
    assert np.all(spread > 0.3)


# What does not belong together ----------------------------------------------------------------------------------------


def test_recordings_whose_units_have_no_factor_between_them_are_refused():
    volts = replace(record("decay", seed=1), unit="V")
    with pytest.raises(BadInput, match="no factor to it"):
        identify([record("decay"), volts])


def test_a_recording_in_another_unit_is_noticed():
    sweep = record("sweep")
    other = Recording(name="millimetres", fs=sweep.fs, response=sweep.response * 1e3, force=sweep.force)
    with pytest.raises(BadInput, match="millimetres moves 1000 times"):
        identify([sweep, other])


def test_a_load_that_stays_is_no_force_that_moves_a_mass_far():
    decay = record("decay")
    belong_together([record("sweep"), replace(decay, force=np.ones(decay.n))])


def test_nothing_given_is_said():
    with pytest.raises(BadInput, match="no recording"):
        identify([])


def test_a_force_that_never_moves_the_mass_leaves_the_mass_open():
    decay = record("decay", seconds=4.0)
    quiet = 1e-4 * np.sin(2 * np.pi * 12 * np.arange(8000) * 1e-3)
    response = 1e-7 * np.random.default_rng(0).standard_normal(8000)
    stuck = Recording(name="stuck", fs=1000.0, response=response, force=quiet)
    assert identify([decay, stuck]).oscillator.mass is None


def test_a_mass_that_friction_hardly_lets_go_does_not_make_the_errors_small():
    # The force is about the preload: in each cycle small changes decide whether it moves, and no derivative exists.
    values = TRUTH | {"preload": 0.3, "dry": 0.0}
    low = 0.35 * values["mass"] * values["preload"] * 4
    random = np.random.default_rng(7)
    clean = recording_of(values, sweep=(low, 0.5 * 12.67, 1.6 * 12.67), fs=1000.0, seconds=30.0, noise=0.0, name="low")
    sweep = replace(
        clean,
        response=clean.response + 2e-6 * random.standard_normal(clean.n),
        force=clean.force + 2e-3 * low * random.standard_normal(clean.n),
    )
    identification = identify([sweep, record("decay", values=values, seconds=4.0)])
    for name, parameter in identification.oscillator.parameters().items():
        assert abs(parameter.value - values[name]) < 4 * parameter.std, name
    assert any("small changes decide" in note for note in identification.notes)


def test_what_the_family_cannot_do_is_remarked():
    decay = record("decay", seconds=4.0)
    bent = decay.response * (1 - 15.0 * decay.response)  # a sensor that is not straight
    identification = identify([Recording(name="bent", fs=decay.fs, response=bent)])
    assert any("times the noise" in note for note in identification.notes)


@pytest.mark.long
def test_a_start_that_leads_nowhere_is_not_the_last_word(monkeypatch):
    from dataclasses import replace

    from dashpot.identify import identification

    honest = identification.hilbert_start

    def astray(recordings):
        estimate = honest(recordings)
        return replace(estimate, omega0=0.6 * estimate.omega0, cubic=1e10, mass=1.5 * estimate.mass)

    monkeypatch.setattr(identification, "hilbert_start", astray)
    both = [record("sweep"), record("decay", seconds=4.0)]
    parameters = identify(both).oscillator.parameters()
    for name in ("mass", "omega0", "viscous"):
        assert abs(parameters[name].value / TRUTH[name] - 1) < WITHIN[name] / 100, name


@pytest.mark.parametrize("asked", [True, False])
def test_a_shape_that_a_start_has_an_error_of_is_fitted_from_the_start_on(asked):
    n = 3000
    values = TRUTH | {"stribeck.excess": 0.4, "stribeck.speed": 0.05, "stribeck.exponent": 1.0}
    rig = oscillator_with(values, effects=("stribeck",))
    step = internal_step(rig, rig.values(), 5e-3)
    moved = core_of(rig).record(np.array(list(rig.values().values())), np.array([5e-3, 0.0]), None, n, 2e-3, step)
    decay = Recording("decay", 500.0, moved + 1e-6 * np.random.default_rng(2).standard_normal(n))
    known = rig.parameters()["stribeck.exponent"]
    start = rig.with_parameters({"stribeck.exponent": replace(known, std=0.1 if asked else None)})
    found = identify([decay], start=start).oscillator.parameters()
    assert (found["stribeck.exponent"].std is not None) == asked
    for name in ("stribeck.excess", "stribeck.speed", *(("stribeck.exponent",) if asked else ())):
        assert abs(found[name].value - values[name]) < 4 * found[name].std, name


@pytest.mark.long
def test_a_mass_stays_one_that_a_force_can_move():
    from dashpot.identify.fit.likelihood import maximum_likelihood

    start = Oscillator.from_values(TRUTH | {"omega0": 0.3 * TRUTH["omega0"], "cubic": 1e11})
    fit = maximum_likelihood(start, [record("sweep"), record("decay", seconds=4.0)])
    assert 0.0 < fit.oscillator.mass.value <= 1e3 * TRUTH["mass"]


@pytest.mark.parametrize(
    ("left", "times", "quiet", "lost"),
    [(0.31, 3.0, False, True), (0.29, 3.0, False, False), (0.31, 1.0, False, False), (0.31, 3.0, True, False)],
)
def test_a_simulation_has_lost_the_motion_where_it_leaves_three_tenths(monkeypatch, left, times, quiet, lost):
    """Of a segment that carries motion, and more than its noise: a noisy record may be told as well as can be."""
    monkeypatch.setattr("dashpot.identify.left.is_quiet", lambda response, fit: quiet)
    segment = SimpleNamespace(segment=SimpleNamespace(response=None), nrmse=left, over_noise=times)
    assert has_lost(segment, None) is lost


@pytest.mark.parametrize("seed", [3, 5])
def test_twenty_samples_of_noise_under_a_step_are_no_model(seed):
    random, times = np.random.default_rng(seed), 0.05 * np.arange(20)
    noise = 1e-3 * random.standard_normal(20)
    with pytest.raises(BadInput, match="neither a free decay nor a stretch driven by a force"):
        identify([Recording("noise", 20.0, noise, np.where(times > times[6], 1.0, 0.0))])


@pytest.mark.parametrize("size", [1e-9, 1e-2])
def test_a_force_of_noise_alone_drives_nothing(size):
    """A mass of a billionth of a kilogram came out, as the noise is too weak to have moved anything heavier."""
    swept = record("sweep", seconds=4.0)
    noise = size * np.random.default_rng(6).standard_normal(swept.n)
    with pytest.raises(BadInput, match="the force column holds nothing but white noise"):
        identify([replace(swept, force=noise)])

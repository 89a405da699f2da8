"""What a model file says of its recordings: how much the model leaves of each, and the range that they covered."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.force import chirp
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.left import left_of_parts, left_of_recording, stretch_words
from dashpot.identify.provenance import with_provenance
from dashpot.model import Oscillator
from dashpot.model.file import dumps, loads
from dashpot.recording import Recording

FS, SECONDS, NOISE = 400.0, 20.0, 5e-6


@pytest.fixture(scope="module")
def recording():
    t = np.arange(round(SECONDS * FS)) / FS
    pieces = chirp(0.5, 5.0, 15.0 / SECONDS, t, 1 / FS)
    x = integrate_pieces(dict(TRUTH), pieces[:-1], 1 / FS, 0.0)[0]
    return Recording("sweep", FS, x + NOISE * np.random.default_rng(0).standard_normal(t.size), force=pieces[:, 0])


@pytest.fixture(scope="module")
def fit(recording):
    return maximum_likelihood(Oscillator.from_values(TRUTH), [recording])


def test_a_right_model_leaves_the_noise(fit, recording):
    entry = with_provenance(fit, [recording], kinds=["sweep"]).identified.recordings[0]
    assert entry["over_noise"] == pytest.approx(1.0, abs=0.03)
    assert entry["nrmse"] == pytest.approx(NOISE / np.std(recording.response), rel=0.03)
    assert entry["kind"] == "sweep"


def test_it_goes_into_the_file_and_comes_back(fit, recording):
    model = with_provenance(fit, [recording])
    assert loads(dumps(model)).identified.recordings == model.identified.recordings


def test_a_covariance_whose_halves_differ_by_rounding_can_be_read_again(fit, recording):
    """Where mass and frequency move as one their correlation is one up to the last digits, and either half its own."""
    std = np.sqrt(np.diag(fit.covariance))
    rounded = np.outer(std, std) * (1.0 - 1e-5 * (np.eye(std.size) < 1))
    rounded[np.triu_indices(std.size, 1)] *= 1.00002
    model = with_provenance(replace(fit, covariance=rounded), [recording])
    assert np.array(loads(dumps(model)).identified.covariance) == pytest.approx(rounded, rel=2e-5)


def test_of_several_stretches_it_is_the_whole(fit, recording):
    """Each by its samples: a second one twice as far off, three times as loud, and of twice the noise."""
    (first,) = fit.segments
    segment, left = first.segment, first.segment.response - first.simulated
    second = replace(
        first,
        segment=replace(segment, response=3.0 * segment.response),
        simulated=3.0 * segment.response - 2.0 * left,
        noise=2.0 * first.noise,
    )
    several = replace(fit, segments=(first, second))
    both, one = left_of_recording(several, 0), left_of_recording(fit, 0)
    assert both.times == pytest.approx(one.times, rel=1e-3)
    assert both.part == pytest.approx(one.part * np.sqrt(5.0 / 10.0), rel=1e-2)  # about one mean of both
    assert left_of_parts([second]).times == pytest.approx(one.times, rel=1e-3)
    assert left_of_recording(fit, 1) is None
    assert stretch_words(first, fit, [recording]) == "sweep"
    assert stretch_words(second, several, [recording]) == "sweep, where it is worst, 0 to 20 s"


def test_a_prediction_that_is_nearer_does_not_make_what_is_simulated_so(fit):
    """What a fit is judged by may be how it predicts; what is said is how its simulation comes out."""
    (part,) = fit.segments
    far = replace(part, simulated=part.simulated + 9.0 * part.noise, over_noise=1.0)
    assert left_of_parts([far]).times == pytest.approx(np.sqrt(82.0), rel=0.02)


def test_the_range_is_that_of_motion_and_force(fit, recording):
    model = with_provenance(fit, [recording])
    assert model.amplitude.max == pytest.approx(np.max(np.abs(recording.response)), rel=0.02)
    assert model.amplitude.min == 0.0
    assert 4.5 < model.frequency.min < 7.0
    assert 17.0 < model.frequency.max < 20.5


def accelerated(force, fs, noise, seed=0):
    """A recording by an accelerometer of a linear rig under a force (n, terms), and its displacement (n,)."""
    rig = {name: TRUTH[name] if name in ("mass", "omega0", "viscous") else 0.0 for name in TRUTH}
    x, v = integrate_pieces(rig, force[:-1], 1 / fs, 0.0)[:2]
    a = force[:, 0] / rig["mass"] - rig["viscous"] * v - rig["omega0"] ** 2 * x
    seen = a + noise * np.random.default_rng(seed).standard_normal(a.size)
    return Recording("accelerometer", fs, seen, force=force[:, 0], unit="m/s2", quantity="acceleration"), x


def test_what_a_blow_gives_the_mass_is_no_motion_yet():
    """Its acceleration during the contact is some times that of the ringing, whose range is what was covered."""
    fs, n = 2000.0, 16000
    force = np.zeros((n, 4))
    for at in (400, 6000):
        k = np.arange(13)
        pulse = 40.0 * np.sin(np.pi * k / 12.0)
        force[at : at + 12] = linear(pulse, 4)
    recording, x = accelerated(force, fs, 0.02)
    model = identify([replace(recording, hold="linear")], doubted=False).oscillator
    peak = float(np.max(np.abs(x)))
    assert np.max(np.abs(recording.response)) / TRUTH["omega0"] ** 2 > 3.0 * peak
    assert model.amplitude.max == pytest.approx(peak, rel=0.1)
    # above three times the noise the frequency is that of the rig
    assert model.amplitude.min > 3.0 * 0.02 / TRUTH["omega0"] ** 2 * 0.9
    assert model.frequency.min == pytest.approx(TRUTH["omega0"] / (2 * np.pi), rel=0.03)
    assert model.frequency.max == pytest.approx(TRUTH["omega0"] / (2 * np.pi), rel=0.03)


def linear(samples, terms):
    """Straight lines between samples as polynomials (n - 1, terms)."""
    pieces = np.zeros((samples.size - 1, terms))
    pieces[:, 0], pieces[:, 1] = samples[:-1], np.diff(samples)
    return pieces


def test_what_a_slow_force_holds_is_motion():
    """Far below the resonance an accelerometer shows next to nothing of how far the spring is bent."""
    fs, n = 400.0, 16000
    t = np.arange(n) / fs
    force = chirp(20.0, 0.8, 2.2 / t[-1], t, 1 / fs) + 0.05 * chirp(20.0, 8.0, 12.0 / t[-1], t, 1 / fs)
    recording, x = accelerated(force, fs, 0.01)
    model = identify([replace(recording, hold="smooth")], doubted=False).oscillator
    assert model.amplitude.max == pytest.approx(np.max(np.abs(x)), rel=0.2)  # the pace is that of all its motion


def test_what_rounding_made_of_unknown_values_is_a_covariance_in_the_file(fit, recording):
    """Of values that nothing shows the errors are beyond all bounds, and rounding leaves correlations above one."""
    k = len(fit.names)
    std = 10.0 ** np.arange(40, 40 + k)
    wrong = np.outer(std, std) * np.where(np.eye(k) > 0, 1.0, -1.3)
    stated = np.array(with_provenance(replace(fit, covariance=wrong), [recording]).identified.covariance)
    assert np.diag(stated) == pytest.approx(std**2)
    assert np.max(np.abs(stated / np.outer(std, std))) <= 1.0 + 1e-9
    kept = with_provenance(fit, [recording]).identified.covariance
    np.testing.assert_array_equal(np.array(kept), 0.5 * (fit.covariance + fit.covariance.T))


def test_where_all_parameters_are_given_there_is_no_covariance(recording):
    found = identify([recording], fixed=dict(TRUTH))
    assert found.oscillator.identified is not None
    assert found.oscillator.identified.covariance == ()


def test_of_a_bad_fit_the_recording_says_how_far_it_went_but_not_one_of_a_faulty_chain(fit, recording):
    (part,) = fit.segments
    bad = replace(fit, segments=(replace(part, simulated=0.6 * part.simulated, over_noise=75.0),))
    moved, simulated = (float(np.max(np.abs(x))) for x in (part.segment.response, bad.segments[0].simulated))
    amplitude = with_provenance(bad, [recording]).amplitude
    faulty = with_provenance(bad, [recording], faults={0: "the response counts 1.67 times"}).amplitude
    assert amplitude is not None
    assert faulty is not None
    assert amplitude.max == pytest.approx(moved, rel=1e-12)
    assert faulty.max == pytest.approx(simulated, rel=1e-12)

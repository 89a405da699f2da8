"""Recordings as models are fitted to them: the noise, the sizes of the motion, and what noise may leave."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.identify.problem.data import (
    Data,
    data_of,
    displacement_amplitude,
    equivalent_resonance,
    expected_noise,
    likelihood,
    measured,
    noise_of,
    noise_spectra,
)
from dashpot.identify.problem.segments import Segment
from dashpot.identify.signals.noise_spectrum import concentrated_likelihood, estimate
from dashpot.model import Oscillator, Response, oscillator_with
from dashpot.recording import Recording
from dashpot.simulate.force import straight_lines

LINEAR = {"mass": 0.3, "omega0": 30.0, "cubic": 0.0, "preload": 0.0, "viscous": 4.0, "dry": 0.0}
MODEL = Oscillator.from_values(LINEAR)
FS, N = 200.0, 2000
UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}


def wave(amplitude, noise=0.0, frequency=5.0, n=N, seed=0):
    t = np.arange(n) / FS
    return amplitude * np.sin(2 * np.pi * frequency * t) + noise * np.random.default_rng(seed).standard_normal(n)


def free(amplitude=1e-3, noise=1e-6, **more):
    return Recording("free", FS, wave(amplitude, noise), free=True, **more)


def driven(amplitude=1e-3, force=2.0, n=N, **more):
    return Recording("driven", FS, wave(amplitude, 1e-6, n=n), wave(force, 1e-3, n=n, seed=1), **more)


def segment(response, force=None, **more):
    given = {"recording": 0, "start": 0, "stop": response.size, "dt": 1 / FS, "time": 0.0, "pace": 30.0}
    drive = None if force is None else straight_lines(force, 1 / FS)
    return Segment(response=response, force=drive, **(given | more))


# The sizes of the motion ---------------------------------------------------------------------------------------------


def test_what_recordings_say_of_sizes_and_noise():
    recordings = (free(2e-3, 1e-5), driven(1e-3, 2.0, 3000), driven(5e-4, 0.5))
    data = data_of(recordings, MODEL, (12.0, 34.0))
    assert [s.recording for s in data.segments] == [0, 1, 2]
    assert data.points == 2 * N + 3000
    assert data.sensor == pytest.approx((1e-5, 1e-6, 1e-6), rel=0.1)
    assert data.force == pytest.approx((0.0, 1e-3, 1e-3), rel=0.1)
    scales = data.scales
    assert scales.length == pytest.approx(2e-3, rel=0.02)
    assert scales.response == scales.length
    assert scales.omega == 30.0
    assert scales.force == pytest.approx(2.0, rel=0.01)
    assert scales.duration == 3000 / FS
    assert (scales.mass, scales.lines) == (0.3, (12.0, 34.0))
    assert data.coarse
    assert data.recordings == recordings


def test_forces_are_interpolated_as_finely_as_asked():
    """Thirty points a cycle of 30 rad/s, or of three times that, at 41.9 samples a cycle."""
    fine, coarse = (data_of([driven()], MODEL, coarse=c) for c in (False, True))
    assert not fine.coarse
    assert [d.segments[0].force.fine for d in (fine, coarse)] == [3, 1]  # pyright: ignore[reportOptionalMemberAccess]


def test_without_a_force_its_size_is_nothing():
    assert data_of([free()], MODEL).scales.force == 0.0


def test_a_model_without_a_mass_is_fitted_to_free_motion_alone():
    massless = Oscillator.from_values({name: value for name, value in LINEAR.items() if name != "mass"})
    data = data_of([driven(), free()], massless)
    assert [s.recording for s in data.segments] == [1]
    assert data.scales.mass is None
    with pytest.raises(BadInput, match=r"^driven: neither a free decay nor"):
        data_of([driven()], massless)
    with pytest.raises(BadInput, match=r"^free, free: no free decay"):
        data_of([free(0.0), free(0.0)], MODEL)


@pytest.mark.parametrize("quantity", UNITS)
def test_displacement_is_told_by_what_was_recorded(quantity):
    order = list(UNITS).index(quantity)
    size = 30.0**order * 1e-3
    near = segment(size * np.sin(0.1 * np.arange(N)) + 7.0, quantity=quantity)
    far = segment(2 * size * np.sin(0.1 * np.arange(N)), quantity=quantity)
    assert displacement_amplitude([near]) == pytest.approx(1e-3, rel=0.01)
    assert displacement_amplitude([near, far]) == pytest.approx(2e-3, rel=0.01)


@pytest.mark.parametrize("quantity", UNITS)
def test_the_peak_of_a_blow_is_no_displacement(quantity):
    order = list(UNITS).index(quantity)
    shown = 30.0**order * 1e-3 * np.sin(0.1 * np.arange(N))
    shown[500:503] += 8 * 30.0**order * 1e-3
    swung = displacement_amplitude([segment(shown, quantity=quantity)])
    # what a sensor of displacement or velocity shows, the mass does
    assert (swung > 7e-3) if order < 2 else (1e-3 < swung < 3.5e-3)


def test_the_size_of_the_response_is_that_of_its_own_quantity():
    velocity = Oscillator.from_values(LINEAR, response=Response("velocity", "m/s"))
    made = wave(0.06, 1e-6)
    seen = free()
    fast = Recording("fast", FS, made, None, "velocity", "m/s", free=True)
    slower = Recording("slower", FS, 0.5 * made, None, "velocity", "m/s", free=True)
    both = data_of([slower, fast], velocity).scales
    assert both.response == pytest.approx(np.max(np.abs(made)))
    assert both.length == pytest.approx(0.06 / 30.0, rel=0.01)
    # where none of its quantity was recorded, a sine's
    assert data_of([seen], velocity).scales.response == pytest.approx(30.0 * data_of([seen], velocity).scales.length)
    assert data_of([fast], MODEL).scales.response == pytest.approx(data_of([fast], MODEL).scales.length)


def test_a_spring_that_a_law_makes_is_a_spring():
    """What moves at 5 Hz on a spring of 0.5 is a slide, unless a further law is the spring."""
    slow = LINEAR | {"omega0": np.pi}
    recordings = [driven(1e-3, n=800)]
    slide = data_of(recordings, Oscillator.from_values(slow))
    assert slide.segments[0].slide
    assert slide.scales.omega == pytest.approx(10 * np.pi, rel=0.01)

    def gravity(stiffness, width=1.0, quantity="displacement"):
        values = slow | {"softening-stiffness.stiffness": stiffness, "softening-stiffness.width": width}
        return oscillator_with(values, effects=("softening-stiffness",), response=Response(quantity, UNITS[quantity]))

    rig = data_of(recordings, gravity(900.0))
    assert not rig.segments[0].slide
    assert rig.scales.omega == pytest.approx(np.sqrt(900.0 + np.pi**2), rel=1e-3)
    assert data_of(recordings, gravity(10.0)).segments[0].slide
    # at the amplitude of the largest motion: one that gives way within it is none
    small = replace(driven(1e-5, n=800), name="small")
    assert data_of([small], gravity(900.0, 3e-4)).scales.omega == pytest.approx(30.17, rel=0.01)
    assert data_of([small, *recordings], gravity(900.0, 3e-4)).scales.omega < 25.0


# What noise may leave ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("quantity", UNITS)
def test_the_resonance_is_that_of_the_equivalent_rig(quantity):
    """With a cubic spring: omega0² + 3/4 c A² at the amplitude of a sine with the segment's spread."""
    order = list(UNITS).index(quantity)
    amplitude = 2e-3
    own = segment(30.0**order * amplitude * np.sin(2 * np.pi * np.arange(N) / 40), quantity=quantity)
    omega = 2 * np.pi * np.fft.rfftfreq(N, 1 / FS)
    stiffness = 900.0 + 0.75 * 2e8 * amplitude**2
    expected = omega ** (2 * order) / ((stiffness - omega**2) ** 2 + (4.0 * omega) ** 2)
    assert equivalent_resonance(own, LINEAR | {"cubic": 2e8}) == pytest.approx(expected, rel=1e-9)


def test_a_spring_that_drifts_is_taken_in_the_middle_of_the_segment():
    values = LINEAR | {"stiffness-drift.rate": 30.0}
    own = segment(wave(1e-3), time=4.0)  # from 4 to 14 s
    static = 900.0 + 30.0 * 9.0
    assert equivalent_resonance(own, values)[0] == pytest.approx(1 / static**2, rel=1e-3)


def test_a_segment_that_stands_still_has_a_resonance():
    still = segment(np.zeros(N))
    assert equivalent_resonance(still, LINEAR)[0] == pytest.approx(900.0**-2)
    assert np.all(np.isfinite(equivalent_resonance(still, LINEAR | {"preload": 1.0, "dry": 1.0})))


def test_expected_noise_is_the_sensors_and_the_forces():
    """White noise through a resonance: sigma² dt / (2 c omega0² m²), Crandall and Mark 1963."""
    own = segment(wave(1e-3), wave(1.0))
    passed = 0.05 / 0.3 * np.sqrt(1 / FS / (2 * 4.0 * 30.0**2))
    assert expected_noise(own, LINEAR, 0.0, 0.05) == pytest.approx(passed, rel=0.01)
    assert expected_noise(own, LINEAR, 1e-3, 0.05) == pytest.approx(np.hypot(1e-3, passed), rel=1e-3)
    assert expected_noise(own, LINEAR, 1e-3, 0.0) == pytest.approx(1e-3)
    assert expected_noise(replace(own, force=None), LINEAR, 1e-3, 0.05) == pytest.approx(1e-3)
    # no quotient by nothing
    assert expected_noise(own, LINEAR, 0.0, 0.0) == pytest.approx(1e-9 * np.std(own.response))
    assert expected_noise(segment(np.zeros(N)), LINEAR, 0.0, 0.0) > 0.0


def test_noise_of_the_force_is_seen_in_a_simulation_that_is_driven():
    random = np.random.default_rng(3)
    decay, forced = segment(wave(1e-3)), segment(wave(1e-3), wave(1.0))
    rests = [random.standard_normal(N), random.standard_normal(N)]
    free_of_it, with_it = noise_of([decay, forced], rests, LINEAR)
    assert np.array_equal(free_of_it.density, estimate(rests[0]).density)
    resonance = equivalent_resonance(forced, LINEAR)
    assert np.array_equal(with_it.density, estimate(rests[1], resonance).density)
    assert np.max(with_it.force_share) > 0.0
    forgotten = noise_of([forced], rests[1:], LINEAR, 8.0)[0]
    assert np.array_equal(forgotten.density, estimate(rests[1]).density)


def test_likelihood_is_that_of_the_spectra():
    data = data_of([free(), driven()], MODEL)
    rests = [np.random.default_rng(k).standard_normal(N) for k in range(2)]
    spectra = noise_spectra(rests, MODEL, data)
    assert np.max(spectra[1].force_share) > 0.0
    assert likelihood(rests, MODEL, data) == pytest.approx(concentrated_likelihood(spectra))
    assert likelihood([rests[0], rests[1] * np.nan], MODEL, data) == -np.inf
    predicting = replace(data, memory=8.0)
    assert np.max(noise_spectra(rests, MODEL, predicting)[1].force_share) == 0.0


def test_data_of_given_segments():
    data = measured([segment(wave(1e-3), recording=1)], [driven(), free(noise=1e-5)], MODEL, coarse=False)
    assert isinstance(data, Data)
    assert data.sensor == pytest.approx((1e-5,), rel=0.1)
    assert data.force == (0.0,)
    assert not data.coarse
    assert data.scales.lines == ()

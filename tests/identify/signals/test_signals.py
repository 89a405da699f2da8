"""The signals of a recording: each fact of them is measured once."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from dashpot.identify.fit.hold import held_as
from dashpot.identify.motion import decays
from dashpot.identify.motion.decays import find_free_motion
from dashpot.identify.motion.displacement import displacement
from dashpot.identify.problem.segments import cut
from dashpot.identify.signals import signals
from dashpot.identify.signals.signals import Signal, drive_of, noise_levels, response_of
from dashpot.identify.start.start import hilbert_start
from dashpot.recording.fact import changed
from dashpot.recording.recording import Recording


@pytest.fixture
def recordings(rigs, reference_sweeps):
    burst = rigs.case(rigs.reference, rigs.bursts(1.0, 13.0, 1.0, 3.0), 1000.0, 12.0)
    cases = {"burst": burst.noisy(1e-6, 1e-3, 0), "sweep": reference_sweeps[0].noisy(1e-6, 1e-3, 1)}
    return [Recording(name, case.fs, case.x, case.force) for name, case in cases.items()]


@pytest.fixture
def measured(monkeypatch):
    """How often each signal was measured, by what was measured and its samples."""
    count: Counter[tuple[str, bytes]] = Counter()

    def watched(module, name):
        real = getattr(module, name)

        def counting(what, *more):
            samples = what.response if isinstance(what, Recording) else what
            count[name, np.asarray(samples).tobytes()] += 1
            return real(what, *more)

        monkeypatch.setattr(module, name, counting)

    for name in ("noise_level", "dominant_frequency", "excited_band"):
        watched(signals, name)
    watched(decays, "envelope_of")
    return count


def test_each_fact_of_each_signal_is_measured_once(recordings, measured):
    start = hilbert_start(recordings)
    for group in (recordings, held_as(recordings, "linear")):
        for band in (1.0, 3.0):
            cut(group, start.omega0, band)
        for recording in group:
            noise_levels(recording), displacement(recording), find_free_motion(recording)
    assert set(measured.values()) == {1}
    # response, force and three decays of the bursts; response and force of the sweep
    assert sum(name == "noise_level" for name, _ in measured) >= 7
    assert sum(name == "envelope_of" for name, _ in measured) == 2


def test_an_offset_taken_off_leaves_the_force_known(recordings):
    burst = recordings[0]
    noise_levels(burst)
    other = changed(burst, response=burst.response - 1e-3)
    assert drive_of(other) is drive_of(burst)
    assert response_of(other) is not response_of(burst)
    assert noise_levels(other) == pytest.approx(noise_levels(burst), rel=1e-9)


def test_the_same_part_is_the_same_signal():
    whole = Signal(np.random.default_rng(0).standard_normal(1000), 100.0)
    part = whole.part(100, 900)
    assert part is whole.part(100, 900)
    assert np.array_equal(part.samples, whole.samples[100:900])
    assert whole.part(0, 1000) is whole


def test_noise_and_largest_line():
    t = np.arange(10_000) / 1000.0
    signal = Signal(np.sin(2 * np.pi * 7.0 * t) + 1e-3 * np.random.default_rng(1).standard_normal(t.size), 1000.0)
    assert signal.noise == pytest.approx(1e-3, rel=0.1)
    assert signal.frequency == pytest.approx(7.0, rel=1e-4)


@pytest.mark.parametrize(("part", "silent"), [(0.6, True), (1.4, False)])
def test_a_signal_that_is_noise_for_its_greater_part_is_silent(part, silent):
    # noise over all is 1 / sqrt(1 + part²) of the signal: 0.86 and 0.58
    t = np.arange(20_000) / 1000.0
    noise = np.random.default_rng(2).standard_normal(t.size)
    assert Signal(noise + part * np.sqrt(2) * np.sin(2 * np.pi * 7.0 * t) + 5.0, 1000.0).is_silent == silent


def test_a_constant_is_silent_and_without_a_force_there_is_none():
    assert Signal(np.full(100, 2.0), 10.0).is_silent
    decay = Recording("decay", 1000.0, np.exp(-np.arange(1000) / 300.0) * np.sin(np.arange(1000) / 5.0))
    assert drive_of(decay) is None
    assert noise_levels(decay)[1] == 0.0

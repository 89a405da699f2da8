"""Lines in what a model leaves over: found where they are, the strongest first, and none in noise."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose.search.starts import residual_lines
from dashpot.examples.truth import TRUTH
from dashpot.identify.problem.data import Data
from dashpot.identify.problem.segments import Segment
from dashpot.identify.problem.structure import Fitted
from dashpot.identify.signals.noise_spectrum import NoiseSpectrum
from dashpot.identify.signals.odds import DECISIVE
from dashpot.model import Oscillator
from dashpot.model.law import Scales

DT, N = 2e-3, 4000
RESOLUTION = 2 * np.pi / (N * DT)


def lines_of(*residuals):
    segments = tuple(Segment(0, 0, r.size, r, None, DT, 0.0, TRUTH["omega0"]) for r in residuals)
    scales = Scales(length=1.0, omega=TRUTH["omega0"], force=1.0, response=1.0, duration=1.0, mass=0.27, lines=())
    count = len(residuals)
    recordings = (SimpleNamespace(name="run"),)
    data = Data(recordings, segments, (1.0,) * count, (0.0,) * count, scales)  # type: ignore[arg-type]
    return residual_lines(Fitted(Oscillator.from_values(TRUTH), np.zeros((count, 2)), residuals, 0.0, ()), data)


def noise(seed=0, n=N):
    return np.random.default_rng(seed).standard_normal(n)


def tone(place, power, n=N, phase=0.4):
    """A cosine at so many bins of the long record: under a Hann window it has A² n / 6 of a white spectrum of one."""
    return np.sqrt(6 * power / n) * np.cos(place * RESOLUTION * np.arange(n) * DT + phase)


@pytest.fixture
def known(monkeypatch):
    """The spectrum around the lines is known to be that of white noise of one, and none is in the way."""

    def ones(residuals, model, data):
        return [NoiseSpectrum(np.ones(r.size // 2 + 1), r.size) for r in residuals]

    monkeypatch.setattr("dashpot.diagnose.search.starts.noise_spectra", ones)


@pytest.mark.parametrize("part", [0.0, 0.25, 0.45, -0.3])
def test_a_line_between_the_bins_is_placed_there(part, known):
    """By the parabola through the logarithms of a Hann window's main lobe, a few hundredths of a bin off."""
    (line,) = lines_of(tone(200 + part, 300.0))
    assert line == pytest.approx((200 + part) * RESOLUTION, abs=0.06 * RESOLUTION)


@pytest.mark.parametrize(("part", "stands_out"), [(0.97, False), (1.03, True)])
@pytest.mark.parametrize("n", [500, N])
def test_a_line_stands_out_by_decisive_odds_beyond_the_logarithm_of_the_number_of_bins(part, stands_out, n, known):
    limit = np.log(n // 2 + 1) + DECISIVE
    assert (len(lines_of(tone(40 * N / n, part * limit, n))) > 0) == stands_out


def test_noise_has_lines_once_in_a_thousand():
    """The largest of m exponentials exceeds log m + log 1000 once in a thousand."""
    assert sum(len(lines_of(noise(seed, 500))) for seed in range(300)) <= 2


def test_a_line_is_found_in_noise_whose_spectrum_is_estimated():
    n = 5 * N
    lines = lines_of(noise(n=n) + tone(200.3, 60.0, n))
    assert lines == (pytest.approx(200.3 * RESOLUTION, abs=0.1 * RESOLUTION),)


def test_the_strongest_comes_first_and_four_are_the_most(known):
    first = tone(150, 30.0) + tone(400, 90.0)
    second = tone(700, 60.0) + tone(1000, 80.0)
    lines = np.array(lines_of(first, second, tone(1300, 40.0))) / RESOLUTION
    assert lines == pytest.approx([400.0, 1000.0, 700.0, 1300.0], abs=0.05)


def test_bins_beside_a_line_are_no_other_lines(known):
    """Three bins of a strong line stand out; they are one."""
    assert len(lines_of(tone(400, 500.0))) == 1
    # and use up what a stretch may tell
    assert np.array(lines_of(tone(400, 500.0) + tone(900, 60.0))) / RESOLUTION == pytest.approx([400.0], abs=0.05)


def test_of_one_stretch_three_lines_are_taken(known):
    residual = sum(tone(k + 0.5, power) for k, power in ((200, 30.0), (500, 40.0)))
    assert len(lines_of(residual)) == 2  # two bins alike of the stronger, one of the other
    lines = lines_of(*(tone(k, 25.0) for k in (200, 500, 800)))
    assert len(lines) == 3


@pytest.mark.parametrize(("bins", "count"), [(1.9, 1), (2.1, 2)])
def test_lines_nearer_than_two_bins_are_one(bins, count, known):
    assert len(lines_of(tone(300, 60.0), tone(300 + bins, 50.0))) == count
    assert len(lines_of(tone(300, 60.0), tone(300 - bins, 50.0))) == count


def test_the_shortest_record_sets_how_near_lines_may_be(known):
    """Half as long, it tells lines no nearer than two of its bins; one of 64 samples tells nothing and sets nothing."""
    lines = tone(300, 60.0), tone(303, 50.0)
    assert len(lines_of(*lines)) == 2
    assert len(lines_of(*lines, 1e-9 * noise(n=N // 2))) == 1
    assert len(lines_of(*lines, 1e-9 * noise(n=64))) == 2
    assert len(lines_of(*lines, 1e-9 * noise(n=65))) == 1


@pytest.mark.parametrize(("place", "count"), [(1.0, 0), (3.0, 1), (5.0, 1)])
def test_what_is_slower_than_three_bins_is_drift(place, count, known):
    lines = lines_of(tone(place, 18.0))
    assert len(lines) == count
    assert all(line == pytest.approx(place * RESOLUTION, abs=1.2 * RESOLUTION) for line in lines)


def test_the_highest_bin_is_no_line(known):
    """It has no neighbour to place it by."""
    assert lines_of(np.sqrt(40.0 / N) * (-1.0) ** np.arange(N)) == ()


@pytest.mark.parametrize(("n", "seen"), [(64, False), (65, True)])
def test_a_short_segment_shows_no_line_and_stops_nobody(n, seen, known):
    place = 12 * N / n  # a line in the middle of twelve bins of the short one
    assert bool(lines_of(tone(place, 60.0, n=n))) is seen
    assert len(lines_of(tone(place, 60.0, n=n), tone(200, 300.0))) == 1 + seen


def test_the_loudest_line_is_first_though_its_harmonics_stand_out_more(monkeypatch):
    """Friction makes them of a tone; where the noise is low they stand out of it by more."""

    def falling(residuals, model, data):
        steps = np.where(np.arange(N // 2 + 1) < 300, 100.0, 1.0)
        return [NoiseSpectrum(steps, N)]

    monkeypatch.setattr("dashpot.diagnose.search.starts.noise_spectra", falling)
    residual = tone(150, 4000.0) + sum(tone(150 * k, 2000.0 / k) for k in (3, 5, 7, 9))
    lines = np.array(lines_of(*[residual])) / RESOLUTION
    assert lines[0] == pytest.approx(150.0, abs=0.05)
    assert lines[1:] == pytest.approx([450.0, 750.0, 1050.0], abs=0.05)
    # where it does not stand out it is none
    quiet = np.array(lines_of(tone(150, 1000.0) + tone(450, 500.0))) / RESOLUTION
    assert quiet == pytest.approx([450.0], abs=0.05)

"""What hides within noise of one per cent: the sides of a division contradict each other, and honest ones do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.lies import STANDS, Lie, told
from dashpot.examples.odd_chains import gain_walks, on_force, on_response, saturates
from dashpot.identify.faults.contradiction import covering
from dashpot.identify.faults.inconsistent_recording import blame
from dashpot.identify.faults.unlike_parts import _chance, divisions_of, unlike_in_words, unlike_parts
from dashpot.identify.fit.likelihood import maximum_likelihood
from dashpot.identify.identification import identify
from dashpot.identify.signals.odds import ABOVE_NOISE, BY_CHANCE
from dashpot.model import Oscillator
from scipy.stats import kstest

#: Noise of one per cent of the strong sweep's motion.
NOISY = replace(STANDS["built-in"], noise=4.5e-5)
QUICK = replace(NOISY, cycles=60.0, fs=300.0, noise=2e-5)
LIES = {
    "gain walks": on_response(gain_walks(0.03)),
    "saturates": on_response(saturates(0.03)),
    "force saturates": on_force(saturates(0.03)),
}


def fitted(stand, change=None, seed=1):
    """The fit of recordings of which the last lies, and these."""
    recordings = told(stand, None if change is None else Lie("", "", 2, change), seed)
    model = Oscillator.from_values(stand.values)
    return maximum_likelihood(model, recordings, doubted=False, near=True), recordings


def most_off(fit) -> float:
    parameters = fit.oscillator.parameters()
    return max(abs(p.value - NOISY.values[name]) / p.std for name, p in parameters.items() if p.std)


@pytest.mark.parametrize("kind", LIES)
def test_what_noise_hides_is_found_and_covered(kind):
    fit, recordings = fitted(NOISY, LIES[kind])
    assert most_off(fit) > 5.0
    found = unlike_parts(fit, recordings)
    assert found.chance < 1e-6
    # of two driven recordings that have another mass either may be right
    assert found.division.recording == (1 if kind == "force saturates" else 2)
    assert found.name == ("viscous" if kind == "saturates" else "mass")
    assert most_off(covering(fit, found.shifts)) < 5.0
    words = unlike_in_words(found, fit, recordings)
    assert "strong.csv" in words
    assert "contradict" in words
    assert f"{found.name} {'more' if found.difference > 0 else 'less'} by " in words
    said = blame(fit, recordings, asked=False, alone=None)
    assert said.notes == (words,)
    assert most_off(said.fit) < 5.0


def test_of_honest_recordings_chance_is_spread_evenly(monkeypatch):
    """The test is exact: its chances are uniform, those of each division by itself."""
    chances: list[float] = []

    def kept(*given):
        chances.append(_chance(*given))
        return chances[-1]

    monkeypatch.setattr("dashpot.identify.faults.unlike_parts._chance", kept)
    for seed in range(8):
        fit, recordings = fitted(QUICK, seed=seed)
        assert blame(fit, recordings, asked=False, alone=None).notes == ()
    assert min(chances) * 9 > BY_CHANCE
    whole = np.array(chances).reshape(8, 9)[:, 1]  # of the decay against the rest: independent from seed to seed
    assert kstest(whole, "uniform").pvalue > 0.01


def test_chance_is_that_of_chi_squared():
    assert _chance(np.eye(2), np.array([2.0, 0.0]), np.eye(2)) == pytest.approx(np.exp(-2.0))
    assert _chance(np.eye(2), np.array([2.0, 0.0]), 4.0 * np.eye(2)) == pytest.approx(np.exp(-0.5))
    assert _chance(np.diag([4.0, 0.0]), np.array([4.0, 0.0]), np.eye(2)) == pytest.approx(0.0455, abs=1e-3)
    assert _chance(np.zeros((2, 2)), np.zeros(2), np.eye(2)) == 1.0


def test_every_side_is_asked_for():
    fit, _ = fitted(QUICK)
    segments, shown = [s.segment for s in fit.segments], [s.simulated for s in fit.segments]
    divisions = divisions_of(segments, shown)
    kinds = [(division.recording, division.kind) for division in divisions]
    driven = [(place, kind) for place in (1, 2) for kind in ("later", "larger", "whole")]
    assert kinds == [(0, "later"), (0, "whole"), *driven, (None, "free")]
    for division in divisions:
        inside = [division.inside(segment, made) for segment, made in zip(segments, shown, strict=True)]
        held = sum(int(np.sum(one)) for one in inside)
        of_it = [s.n for s in segments if division.recording in (None, s.recording)]
        if division.kind in ("later", "larger"):
            assert held == pytest.approx(sum(of_it) / 2, rel=0.05)
        assert 0 < held < sum(s.n for s in segments)
    free = divisions_of([s for s in segments if s.force is None], shown[:1])
    assert [(division.recording, division.kind) for division in free] == [(0, "later")]


def test_what_is_a_little_more_than_noise_is_asked_where_no_part_is_to_blame():
    """Beyond 1.1 times the noise by chance alone: no part stands out, and the halves contradict each other."""
    slow = replace(STANDS["slow"], noise=13 * STANDS["slow"].noise)
    found = identify(told(slow, Lie("", "", 2, LIES["gain walks"]), 2))
    assert max(s.over_noise for s in found.fit.segments) > ABOVE_NOISE
    assert any("strong.csv: it contradicts decay.csv, weak.csv: there mass less by" in note for note in found.notes)

"""What hides within noise of one per cent: the sides of a division contradict each other, and honest ones do not."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from dashpot.examples.lies import STANDS, Lie, odd_lies, told
from dashpot.examples.odd_chains import gain_walks, on_force, on_response, saturates
from dashpot.identify.faults.bent_channel import Bent, FoundBent
from dashpot.identify.faults.contradiction import covering
from dashpot.identify.faults.inconsistent_recording import explain_residual
from dashpot.identify.faults.unlike_parts import (
    Unlike,
    _chance,
    divisions_of,
    shifts_of,
    unlike_in_words,
    unlike_parts,
)
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


@cache
def hidden(kind):
    """The fit of recordings of which one lies in that way, these, and what is found."""
    fit, recordings = fitted(NOISY, LIES[kind])
    return fit, recordings, unlike_parts(fit, recordings)


def most_off(fit) -> float:
    parameters = fit.oscillator.parameters()
    return max(abs(p.value - NOISY.values[name]) / p.std for name, p in parameters.items() if p.std)


@pytest.mark.parametrize("kind", LIES)
def test_what_noise_hides_is_found_and_covered(kind):
    fit, recordings, found = hidden(kind)
    assert most_off(fit) > 5.0
    assert found[0].chance < 1e-6
    assert any(one.recording == 2 for one in found)
    assert most_off(covering(fit, shifts_of(found))) < 3.0
    words = unlike_in_words(found, fit, recordings)
    assert "strong.csv" in words
    assert "contradict" in words
    said = explain_residual(fit, recordings, asked=False, alone=None)
    assert said.notes == (words,)
    assert most_off(said.fit) < 3.0


@pytest.mark.parametrize("kind", LIES)
def test_its_size_is_told(kind):
    """Of a channel that is bent, where that is the likeliest or as likely as what is."""
    shape, force, size = {
        "gain walks": ("walks", False, 0.03),
        "saturates": ("saturates", False, -0.03),
        "force saturates": ("saturates", True, -0.03),
    }[kind]
    bent = [one for one in hidden(kind)[2] if isinstance(one, FoundBent)]
    (own,) = [one for one in bent if one.fault == replace(one.fault, recording=2, shape=shape, force=force)]
    assert abs(own.size - size) < 3.0 * own.error
    assert own.error < 0.2 * abs(size)


def test_sides_of_a_recording_are_told_in_words():
    fit, recordings, found = hidden("saturates")
    whole = next(one for one in found if isinstance(one, Unlike))
    words = unlike_in_words([whole], fit, recordings)
    assert f"{whole.name} {'more' if whole.difference > 0 else 'less'} by " in words


def test_what_explains_as_well_shares_the_doubt():
    bent = [FoundBent(Bent(place), 0.1, 0.01, (np.array([shift]),), 1e-9) for place, shift in ((1, 3.0), (2, 4.0))]
    np.testing.assert_allclose(sum(float(s[0]) ** 2 for s in shifts_of(bent)), 0.5 * (3.0**2 + 4.0**2))
    np.testing.assert_allclose(shifts_of([bent[0], replace(bent[1], chance=1e-3)])[0], [3.0], rtol=1e-5)


@pytest.mark.parametrize("name", ["force gain by sign", "saturates by 3 %"])
def test_a_bent_channel_that_is_more_than_noise_is_named(name):
    """Which of two channels the linear response does not say: the likelier fit does."""
    slow = replace(STANDS["slow"], noise=13 * STANDS["slow"].noise)
    lie = next(lie for lie in odd_lies(slow) if lie.name == name)
    recordings = told(slow, lie, 2)
    model = Oscillator.from_values(slow.values)
    fit = maximum_likelihood(model, recordings, doubted=False, near=True)
    assert max(s.over_noise for s in fit.segments) > ABOVE_NOISE
    (note,) = explain_residual(fit, recordings, asked=False, alone=None).notes
    assert note.startswith("strong.csv: its ")
    assert lie.is_named(note)


def test_of_honest_recordings_chance_is_spread_evenly(monkeypatch):
    """The test is exact: its chances are uniform, those of each division by itself."""
    chances: list[float] = []

    def kept(*given):
        chances.append(_chance(*given))
        return chances[-1]

    monkeypatch.setattr("dashpot.identify.faults.unlike_parts._chance", kept)
    for seed in range(8):
        fit, recordings = fitted(QUICK, seed=seed)
        assert explain_residual(fit, recordings, asked=False, alone=None).notes == ()
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


def test_a_side_without_samples_is_not_asked_for():
    """Within less than a cycle no part of a driven motion moves farther than the rest."""
    fit, _ = fitted(QUICK)
    segments, shown = [s.segment for s in fit.segments[1:]], [np.zeros(s.segment.n) for s in fit.segments[1:]]
    assert {division.kind for division in divisions_of(segments, shown)} == {"later", "whole"}


def test_a_motion_within_the_noise_is_no_smaller_motion():
    """What a model shows there is the force's noise, of which it makes any mass."""
    fit, _ = fitted(QUICK)
    driven = [s for s in fit.segments if s.segment.force is not None]
    segments, shown = [s.segment for s in driven], [s.simulated for s in driven]
    quiet = [np.where(np.arange(made.size) < 0.6 * made.size, 0.0, made) for made in shown]
    held = [replace(s, response=made + s.response - own) for s, made, own in zip(segments, quiet, shown, strict=True)]
    assert "larger" in {division.kind for division in divisions_of(segments, shown)}
    assert "larger" not in {division.kind for division in divisions_of(held, quiet)}


def test_what_is_a_little_more_than_noise_is_asked_where_no_part_is_to_blame():
    """Beyond 1.1 times the noise by chance alone: no part stands out, and the halves contradict each other."""
    slow = replace(STANDS["slow"], noise=13 * STANDS["slow"].noise)
    found = identify(told(slow, Lie("", "", 2, LIES["gain walks"]), 2))
    assert max(s.over_noise for s in found.fit.segments) > ABOVE_NOISE
    assert any("strong.csv: it contradicts decay.csv, weak.csv: there mass less by" in note for note in found.notes)

"""What of a recording is no free motion: one sentence, with its times."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.identify.motion.decay import Blow, Decay, FreeMotion
from dashpot.identify.motion.envelope import Envelope
from dashpot.identify.motion.excluded_ranges import left_out
from dashpot.recording import Recording

N, FS, PERIOD, FLOOR = 3000, 100.0, 100, 0.1


def recording(force=None):
    return Recording("run", FS, np.sin(np.arange(N)), force, start=10.0)


def sizes(**level):
    """Envelope (n,) at half its floor, but for samples: s1200=0.5."""
    size = np.full(N, 0.5 * FLOOR)
    for sample, value in level.items():
        size[int(sample[1:])] = value
    return size


def said(size, *decays, force=None, blows=()):
    motion = FreeMotion(tuple(Decay(*decay) for decay in decays), blows)
    return left_out(recording(force), Envelope(size, PERIOD, FLOOR, 0.01), motion)


def gaps(size, *decays, force=None):
    """What is left out, without the sentence around it."""
    sentences = said(size, *decays, force=force)
    return sentences[0].partition("left out: ")[2] if sentences else ""


def test_nothing_is_said_where_nothing_moves_freely():
    assert said(sizes()) == ()


def test_the_whole_sentence():
    assert said(sizes(), (500, 1500)) == (
        "run: free motion is used, 15 to 25 s; left out: 10 to 15 s (at rest or held)",
    )
    assert said(sizes(s100=1.0), (500, 1500), (1800, 2900))[0] == (
        "run: free motion is used, 15 to 25 s and 28 to 39 s; left out: "
        "10 to 15 s (moved by something that was not recorded)"
    )


@pytest.mark.parametrize(("level", "moved"), [(1.9, False), (2.1, True)])
def test_what_moves_is_twice_above_the_end_of_a_decay(level, moved):
    assert ("moved by" in gaps(sizes(s100=level * FLOOR), (500, 1500))) is moved
    assert ("at rest" in gaps(sizes(s100=level * FLOOR), (500, 1500))) is not moved


@pytest.mark.parametrize(("sample", "counts"), [(0, True), (299, True), (300, False), (499, False)])
def test_what_is_let_go_may_move_two_cycles_before(sample, counts):
    size = sizes()
    size[sample] = 1.0
    assert ("moved by" in gaps(size, (500, 1500))) is counts


@pytest.mark.parametrize(("sample", "counts"), [(1500, False), (1599, False), (1600, True), (2999, True)])
def test_a_decay_reaches_a_cycle_into_what_follows(sample, counts):
    size = sizes()
    size[sample] = 1.0
    assert gaps(size, (0, 1500)) == ("25 to 40 s (moved by something that was not recorded)" if counts else "")


@pytest.mark.parametrize(("sample", "counts"), [(1599, False), (1600, True), (1799, True), (1800, False)])
def test_between_two_decays_both_hold(sample, counts):
    size = sizes()
    size[sample] = 1.0
    assert ("moved by" in gaps(size, (0, 1500), (2000, 3000))) is counts


def test_between_two_near_decays_nothing_is_seen_to_move():
    """A cycle after the first and two before the second: none is left of two cycles."""
    size = sizes()
    size[1500:1700] = 1.0
    assert gaps(size, (0, 1500), (1700, 3000)) == ""
    size[1499] = 1.0
    assert gaps(size, (0, 1500), (1700, 3000)) == "25 to 27 s (stopped, at rest or held)"


@pytest.mark.parametrize(("level", "stopped"), [(1.4, False), (1.6, True)])
def test_a_decay_that_ends_above_the_noise_was_stopped(level, stopped):
    size = sizes(s1499=level * FLOOR, s1500=10.0)  # what follows does not say it
    assert gaps(size, (0, 1500)) == ("25 to 40 s (stopped, at rest or held)" if stopped else "")
    moved = sizes(s1499=level * FLOOR, s2500=1.0)
    assert ("stopped, moved by" in gaps(moved, (0, 1500))) is stopped


def test_before_the_first_decay_nothing_was_stopped():
    assert gaps(sizes(s2999=1.0), (500, 3000)) == "10 to 15 s (at rest or held)"


@pytest.mark.parametrize(("start", "words"), [(100, False), (101, True)])
def test_a_cycle_is_not_worth_a_word(start, words):
    assert (gaps(sizes(), (start, 3000)) != "") is words


def test_what_a_recorded_force_drives_was_not_left_out():
    drive = np.sin(0.05 * np.arange(N))
    assert said(sizes(s100=1.0), (500, 1500), force=drive) == ()
    silent = np.random.default_rng(0).standard_normal(N)
    assert "moved by" in gaps(sizes(s100=1.0), (500, 1500), force=silent)


def test_what_is_said_of_blows():
    once, twice, cut = Blow(100, 110), Blow(300, 340, contacts=2), Blow(500, 510, clipped=True)
    assert said(sizes(s50=1.0), (510, 900), blows=(once,)) == ()
    assert said(sizes(), blows=(once, twice, Blow(400, 410, contacts=3))) == (
        "run: the hammer hit more than once at 13, 14 s",
    )
    assert said(sizes(), (510, 900), blows=(once, cut)) == (
        "run: the force of the blow at 15 s is clipped; the ringing after it is used, the blow is not",
    )
    assert len(said(sizes(), blows=(twice, cut))) == 2


def test_what_is_clipped_is_not_called_moved():
    swings = 1.5 * np.sin(0.2 * np.arange(N)) + 1e-3 * np.random.default_rng(1).standard_normal(N)
    cut = Recording("run", FS, np.where(np.arange(N) < 500, np.clip(swings, -1.0, 1.0), 0.5 * swings), start=10.0)
    motion = FreeMotion((Decay(500, 1500),))
    said = left_out(cut, Envelope(sizes(s100=1.0, s2000=1.0), PERIOD, FLOOR, 0.01), motion)
    assert said[0].endswith("left out: 10 to 15 s (clipped), 25 to 40 s (moved by something that was not recorded)")

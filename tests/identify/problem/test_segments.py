"""Recordings cut where the physics changes hands."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from dashpot.identify.motion.blows import ContactForce
from dashpot.identify.problem.segments import Segment, cut, pace_of, stretches
from dashpot.recording import Recording
from dashpot.simulate.force import staircase, straight_lines

FS, PACE = 200.0, 2 * np.pi * 5.0
CYCLE = round(FS * 2 * np.pi / PACE)


def wave(n, amplitude=1e-3, noise=1e-6, frequency=5.0):
    t = np.arange(n) / FS
    return amplitude * np.sin(2 * np.pi * frequency * t) + noise * np.random.default_rng(n).standard_normal(n)


def free(cycles, noise=1e-6, **more):
    return Recording("free", FS, wave(round(cycles * CYCLE), noise=noise), free=True, **more)


def driven(cycles, frequency=5.0, **more):
    n = round(cycles * CYCLE)
    return Recording("driven", FS, wave(n, frequency=frequency), wave(n, 1.0, 1e-3, frequency), **more)


def segment(n=100, force=None, **more):
    given = {"recording": 0, "start": 50, "stop": 50 + n, "dt": 1 / FS, "time": 3.0, "pace": PACE}
    return Segment(response=wave(n), force=force, **(given | more))


# One segment ---------------------------------------------------------------------------------------------------------


def test_what_a_segment_is():
    assert segment(100).n == 100
    assert [segment(quantity=q).order for q in ("displacement", "velocity", "acceleration")] == [0, 1, 2]
    n = 4000
    noisy = replace(segment(n), response=wave(n, noise=1e-4))
    assert noisy.noise == pytest.approx(1e-4, rel=0.1)


def test_a_part_is_the_same_samples_at_the_same_time():
    force = np.arange(100.0)
    whole = segment(100, straight_lines(force, 1 / FS), rests=True)
    part = whole.part(20, 60)
    assert (part.start, part.stop, part.n) == (70, 110, 40)
    assert np.array_equal(part.response, whole.response[20:60])
    assert part.time == pytest.approx(3.0 + 20 / FS)
    assert part.force is not None
    assert np.array_equal(part.force.pieces[:, 0], force[20:59])
    assert not part.rests
    assert whole.part(0, 60).rests
    assert not replace(whole, rests=False).part(0, 60).rests
    assert segment(100).part(20, 60).force is None


def test_a_search_may_take_the_force_in_a_third_of_the_pieces():
    smooth = cut([driven(20)], PACE)[0]
    assert smooth.force is not None
    assert smooth.coarse_force is not None
    assert smooth.force.fine == 3  # 30 points a cycle at three times 5 Hz of 200
    assert smooth.coarse_force.fine == 1
    assert smooth.coarse_force.pieces.shape[0] * 3 == smooth.force.pieces.shape[0]
    assert segment().coarse_force is None


def test_stretches_are_what_follows_without_a_gap():
    force = staircase(np.ones(10))
    a, b, c = segment(start=0, stop=10), segment(start=10, stop=20), segment(start=21, stop=30)
    d, e = segment(start=30, stop=40, force=force), segment(start=40, stop=50, force=force)
    f, g = segment(start=50, stop=60, force=force, recording=1), segment(start=60, stop=70, force=force, recording=1)
    assert stretches([a, b, c, d, e, f, g]) == [(0, 1), (2,), (3, 4), (5, 6)]
    assert stretches([e, d]) == [(0,), (1,)]
    assert stretches([]) == []


# The pace ------------------------------------------------------------------------------------------------------------


def test_a_rig_swings_at_its_own_frequency():
    fast = driven(20, 5.0)  # 4 s
    slow = 2 * np.pi * 10 / fast.duration
    assert pace_of([fast], 1.01 * slow) == 1.01 * slow  # ten swings in the longest recording
    assert pace_of([fast], 0.99 * slow) == pytest.approx(PACE, rel=1e-3)
    assert pace_of([fast.slice(0, 400), fast], 1.01 * slow) == 1.01 * slow
    assert pace_of([free(20)], 0.5 * slow) == 0.5 * slow  # nothing drives it
    still = replace(fast, force=np.zeros(fast.n))
    assert pace_of([still], 0.5 * slow) == 0.5 * slow
    # the fastest of what drives, and only where it is faster than twice the rig
    assert pace_of([fast, driven(20, 8.0)], 0.9 * slow) == pytest.approx(2 * np.pi * 8.0, rel=1e-3)
    near = driven(8, 5.0)
    assert pace_of([near], 0.55 * PACE) == 0.55 * PACE
    assert pace_of([near], 0.45 * PACE) == pytest.approx(PACE, rel=5e-3)


# Cutting -------------------------------------------------------------------------------------------------------------


def test_a_free_recording_is_one_segment():
    (found,) = cut([free(10, start=7.0)], PACE)
    assert (found.start, found.stop, found.time, found.dt, found.pace) == (0, 10 * CYCLE, 7.0, 1 / FS, PACE)
    assert found.force is None
    assert not found.rests
    assert not found.slide
    assert found.quantity == "displacement"


@pytest.mark.parametrize(("cycles", "count"), [(0.9, 0), (1.2, 1)])
def test_what_is_driven_or_free_throughout_needs_a_cycle(cycles, count):
    assert len(cut([driven(10), driven(cycles)], PACE)) == 1 + count
    assert len(cut([free(10), free(cycles)], PACE)) == 1 + count


def off_and_on(before, ringing=12.0):
    """Driven for some cycles, then ringing."""
    n, m = round(before * CYCLE), round(ringing * CYCLE)
    force = np.concatenate([wave(n, 1.0, 0.0), np.zeros(m)]) + 1e-4 * np.random.default_rng(1).standard_normal(n + m)
    t = np.arange(n + m) / FS
    fall = np.where(t < n / FS, 1.0, np.exp(-1.5 * (t - n / FS)))
    x = 1e-3 * fall * np.sin(PACE * t) + 1e-6 * np.random.default_rng(2).standard_normal(n + m)
    return Recording("switched", FS, x, force, start=5.0)


def test_a_stretch_of_three_cycles_stands_alone():
    before = 3.4
    push, ring = cut([off_and_on(before)], PACE)
    assert (push.start, push.force is None, ring.force) == (0, False, None)
    assert ring.start == pytest.approx(before * CYCLE, abs=3)
    assert ring.time == pytest.approx(5.0 + ring.start / FS)


def test_a_shorter_one_goes_on_with_the_decay_that_it_set_going():
    recording = off_and_on(2.7)
    (both,) = cut([recording], PACE)
    assert both.start == 0
    assert both.stop > 6 * CYCLE
    pushed = both.force.pieces[:: both.force.fine, 0]
    off = round(2.7 * CYCLE) + 3
    assert np.any(pushed[: off - 6])
    assert not np.any(np.abs(pushed[off + CYCLE :]) > 1e-6 * np.max(np.abs(pushed)))


def test_a_silent_force_drives_nothing():
    noise = 1e-3 * np.random.default_rng(3).standard_normal(10 * CYCLE)
    silent = replace(free(10), force=noise)
    assert [s.force for s in cut([silent], PACE)] == [None]
    assert [s.force for s in cut([replace(silent, force=0 * noise)], PACE)] == [None]
    assert cut([Recording("nothing", FS, wave(10 * CYCLE), np.zeros(10 * CYCLE))], PACE) == ()


@pytest.mark.parametrize(("level", "count"), [(0.7, 0), (3.0, 1)])
def test_where_nothing_moves_there_is_nothing_to_fit(level, count):
    still = free(40, noise=1.0)
    still = replace(still, response=level * wave(still.n, 1.0, 0.0) + wave(still.n, 0.0, 1.0))
    assert len(cut([still], PACE)) == count


def test_the_force_runs_as_the_recording_says():
    held, smooth = (cut([driven(10, hold=hold)], PACE)[0].force for hold in ("zero", None))
    assert held is not None
    assert smooth is not None
    assert (held.hold, held.fine) == ("zero", 1)
    assert (smooth.hold, smooth.fine) == ("smooth", 3)
    assert cut([driven(10)], PACE, 1.0)[0].force.fine == 1  # pyright: ignore[reportOptionalMemberAccess]


def test_what_is_driven_from_rest_begins_so():
    n = 20 * CYCLE
    random = np.random.default_rng(6)
    grown = np.clip((np.arange(n) - 3 * CYCLE) / n, 0, None)
    begun = Recording("begun", FS, grown * wave(n, 1e-2, 0.0) + 1e-6 * random.standard_normal(n), wave(n, 1.0, 1e-3))
    assert [s.rests for s in cut([begun], PACE)] == [True]
    assert [s.rests for s in cut([driven(20)], PACE)] == [False]
    let_go = replace(begun, force=None, free=True)
    assert [s.rests for s in cut([let_go], PACE)] == [False]


def hammered(damping):
    """A recording of one blow upon a mass at rest, and where that is; damping in 1/s."""
    n, at = 30 * CYCLE, 6 * CYCLE
    force = 1e-4 * np.random.default_rng(1).standard_normal(n) + 0.3
    force[at : at + 5] += 50.0 * np.sin(np.pi * (np.arange(5) + 0.5) / 5)
    t = (np.arange(n) - at) / FS
    x = np.where(t > 0, 1e-3 * np.exp(-damping * t) * np.sin(PACE * t), 0.0)
    x = x + 1e-6 * np.random.default_rng(2).standard_normal(n)
    return Recording("hammer", FS, x, force), at


def test_a_hammers_blow_goes_with_what_it_set_going():
    recording, at = hammered(1.0)
    (struck,) = cut([recording], PACE)
    assert isinstance(struck.force, ContactForce)
    assert struck.rests
    assert at - CYCLE // 4 - 2 <= struck.start < at
    assert struck.stop > at + 6 * CYCLE  # to the noise, and not four cycles
    assert struck.after is None


@pytest.mark.parametrize(("damping", "used"), [(20.0, True), (22.0, False)])
def test_a_blow_that_sets_one_and_a_half_cycles_going_is_used(damping, used):
    """They ring for a little more and a little less until the noise; from rest, they cost no initial values."""
    recording, at = hammered(damping)
    found = cut([recording], PACE)
    assert len(found) == used
    assert all(s.rests and s.start < at < s.stop and s.force is not None for s in found)


def test_a_slide_is_cut_into_cycles_of_what_drives_it():
    """A motion at 5 Hz of a mass on a spring of 0.05 Hz."""
    slide = driven(7.4)
    found = cut([slide], 0.01 * PACE)
    assert [s.recording for s in found] == [0] * 7
    assert [s.n for s in found] == pytest.approx([slide.n / 7] * 7, abs=1)
    assert (found[0].start, found[-1].stop) == (0, slide.n)
    assert all(a.stop == b.start for a, b in pairwise(found))
    assert all(s.slide and s.pace == pytest.approx(PACE, rel=5e-3) for s in found)
    assert not cut([slide], PACE)[0].slide

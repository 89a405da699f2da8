"""What each step of a diagnosis has of its time."""

from __future__ import annotations

import pytest
from dashpot.diagnose import time_allowed
from dashpot.diagnose.time_allowed import DELIVERED, REFITTED, SEARCHED, TRIED, TimeAllowed, part_at


@pytest.mark.parametrize(
    ("after", "searching", "checking"),
    [(0.0, True, True), (49.0, True, True), (51.0, False, True), (66.0, False, False)],
)
def test_the_search_ends_before_the_checks(monkeypatch, after, searching, checking):
    monkeypatch.setattr(time_allowed.time, "monotonic", lambda: 1000.0 + after)
    allowed = TimeAllowed(100.0, begun=1000.0)
    assert (allowed.searching, allowed.checking) == (searching, checking)


def test_without_a_limit_nothing_is_left_out():
    assert TimeAllowed().searching
    assert TimeAllowed().checking


def test_progress_never_goes_back_and_a_search_has_its_part_of_the_time(monkeypatch):
    now = [1000.0]
    monkeypatch.setattr(time_allowed.time, "monotonic", lambda: now[0])
    said: list[float] = []
    progress = TimeAllowed(100.0, begun=1000.0).forward(lambda _what, part: said.append(part))
    for seconds, part in [(0.0, 0.05), (10.0, 0.6), (20.0, 0.1), (60.0, 0.3), (61.0, REFITTED), (90.0, 1.0)]:
        now[0] = 1000.0 + seconds
        progress("asked", part)
    assert said == pytest.approx([0.0, 0.2 * SEARCHED, 0.4 * SEARCHED, SEARCHED, REFITTED, 1.0])
    assert SEARCHED < REFITTED < DELIVERED < TRIED < 1.0
    steps = [part_at(step, False) for step in (SEARCHED, REFITTED, DELIVERED, TRIED)]
    assert steps == sorted(steps)
    assert part_at(SEARCHED, True) == SEARCHED < steps[0]
    assert steps[-1] < 1.0


def test_without_a_limit_progress_is_what_is_done(monkeypatch):
    said: list[float] = []
    progress = TimeAllowed().forward(lambda _what, part: said.append(part))
    for part in (0.05, 0.8, 0.1, 0.85):
        progress("asked", part)
    assert said == [0.05, 0.8, 0.8, 0.85]

"""Where a response has no derivative: differences that disagree, on either side of what is allowed."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.identify.problem.jumps import _jumps, _most_telling, left_out, smooth_stretches

N, CYCLE = 400, 20


def jumping(disagree: float, *, size: float = 1.0, visible: float = 0.0) -> np.ndarray:
    """Where a derivative of that size jumps whose differences disagree at one sample by that part of it."""
    effect = np.full(N, 1.0)
    effect[200:] = size
    apart = np.zeros(N)
    apart[300] = disagree * size
    return _jumps(apart, effect, CYCLE, visible)


@pytest.mark.parametrize(("disagree", "jumps"), [(0.295, False), (0.305, True)])
def test_differences_that_disagree_by_three_tenths_are_no_derivative(disagree, jumps):
    where = np.flatnonzero(jumping(disagree))
    assert where.size == (CYCLE if jumps else 0)
    assert not jumps or (abs(where[0] - 290) <= 1 and abs(where[-1] - 309) <= 1)  # half a cycle on either side


@pytest.mark.parametrize(("size", "jumps"), [(0.9e-3, False), (2e-3, True)])
def test_what_is_small_beside_the_largest_effect_is_no_jump(size, jumps):
    """A thousandth of it, and three tenths of itself."""
    assert bool(np.any(jumping(1.0, size=size))) is jumps


@pytest.mark.parametrize(("visible", "jumps"), [(0.71, False), (0.69, True)])
def test_what_rounding_makes_is_no_jump(visible, jumps):
    assert bool(np.any(jumping(1.0, visible=visible - 1e-3))) is jumps


def test_the_run_that_tells_most_is_kept():
    good = np.array([1, 1, 0, 1, 1, 1, 0, 1], bool)
    silent, loud = np.zeros(8), np.array([0, 0, 0, 0, 0, 0, 0, 9.0])
    assert _most_telling(good, [silent], 0) == (3, 6)  # none tells anything: the longest
    assert _most_telling(good, [np.ones(8)], 0) == (3, 6)
    assert _most_telling(good, [np.ones(8), loud], 0) == (7, 8)
    assert _most_telling(good, [np.ones(8), loud], 2) == (3, 6)  # the last is too short
    assert _most_telling(np.ones(4, bool), [np.ones(4)], 2) == (0, 4)
    assert _most_telling(np.zeros(4, bool), [np.ones(4)], 2) == (0, 0)


class Segment(SimpleNamespace):
    def part(self, begin, end):
        return Segment(**(vars(self) | {"begin": begin, "n": end - begin}))


def smoothed(*jumps_at: int | None, sizes: tuple[int, ...] = (30 * CYCLE,), effects: tuple[float, ...] = (1.0,)):
    """What is kept of segments, 30 cycles unless said, on which a parameter has such effects and may jump at a sample.

    Of each where it begins, its samples and its initial state.
    """
    segments = tuple(Segment(n=n, cycle=CYCLE, response=np.ones(n), noise=0.1, recording=0, begin=0) for n in sizes)
    rows = [np.full((1, n), effect) for n, effect in zip(sizes, effects, strict=True)]

    def simulate(i, state, sides=None):
        by = float(state.values[0]) - 1.0
        made = np.ones(sizes[i]) + by * rows[i][0]
        if by < 0.0 and jumps_at[i] is not None:
            made[jumps_at[i]] = 1.0
        return made

    problem = SimpleNamespace(
        segments=segments,
        free=(0,),
        scale=np.ones(1),
        residuals_with_derivatives=lambda _, single: (None, rows),
        simulate=simulate,
        sides=lambda _: None,
        map=lambda function, items: [function(item) for item in items],
        states=lambda i, state: np.arange(sizes[i])[:, None],
        core=SimpleNamespace(initial=lambda along: along + 0.5),
    )
    from dashpot.identify.problem.output_error import State

    state = State(np.ones(1), np.zeros((len(sizes), 1)), np.zeros(0))
    kept, after = smooth_stretches(problem, state)  # pyright: ignore[reportArgumentType]
    return [(segment.begin, segment.n, float(at)) for segment, at in zip(kept, after.initial[:, 0], strict=True)]


def test_of_a_segment_the_longest_smooth_stretch_is_kept_with_the_state_it_begins_in():
    assert smoothed(None) == [(0, 600, 0.0)]
    [(begin, n, state)] = smoothed(5 * CYCLE)
    assert begin == pytest.approx(5.5 * CYCLE, abs=2)
    assert (begin + n, state) == (600, begin + 0.5)
    [(begin, n, state)] = smoothed(25 * CYCLE)
    assert (begin, state) == (0, 0.0)
    assert n == pytest.approx(24.5 * CYCLE, abs=2)


@pytest.mark.parametrize(("cycles", "kept"), [(19, False), (22, True)])
def test_a_smooth_stretch_has_ten_cycles_or_all_stays_as_it_was(cycles, kept):
    n = cycles * CYCLE
    assert (smoothed(n // 2, sizes=(n,))[0][1] < n) is kept


@pytest.mark.parametrize(("effect", "kept"), [(0.5, True), (0.6, False)])
def test_a_blow_too_short_to_be_cut_is_kept_where_its_jump_says_a_hundredth_or_less(effect, kept):
    """One cycle of twenty samples about the jump, beside 4 and 30 cycles that are smooth: 0.8 and 1.1 % of them."""
    found = smoothed(2 * CYCLE, None, sizes=(5 * CYCLE, 30 * CYCLE), effects=(effect, 1.0))
    assert found == ([(0, 5 * CYCLE, 0.0)] if kept else []) + [(0, 30 * CYCLE, 0.0)]


@pytest.mark.parametrize("force", [None, "a force"])
def test_what_was_left_out_is_said_of_its_recording(force):
    """A larger force helps where there is one."""
    before = [SimpleNamespace(n=n, dt=0.1, recording=i, force=force) for i, n in enumerate((100, 50))]
    after = [SimpleNamespace(n=60, dt=0.1, recording=0, force=force), before[1]]
    (sentence,) = left_out(before, after, ["a", "b"])  # pyright: ignore[reportArgumentType]
    assert sentence.startswith("a: 4 of 10 s were left out")
    assert ("a larger force" in sentence) is (force is not None)

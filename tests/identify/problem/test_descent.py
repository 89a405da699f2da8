"""The search step by step: what it promises, that it can be left and gone on with, and bounds."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.identify.problem.descent import Descent, cost_of, repeated, search
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.signals.noise_spectrum import white


class Line:
    """A problem whose response is linear in two shared unknowns: (n,) = rows.T @ values."""

    def __init__(self, bounds: np.ndarray | None = None) -> None:
        random = np.random.default_rng(1)
        self.rows = random.standard_normal((2, 50))
        self.measured = np.array([1.0, -2.0]) @ self.rows + 0.01 * random.standard_normal(50)
        self.free, self.shared, self.bounds = (0, 1), 2, bounds
        self.segments, self.memory = (), FREE
        self.core = SimpleNamespace(parameter_names=("omega0", "stiffness"))

    def residuals(self, state):
        return (self.measured - state.values @ self.rows,)

    def derivatives(self, state, residuals, *, single=False):
        return [self.rows.copy()]

    def residuals_with_derivatives(self, state, *, single=False):
        residuals = self.residuals(state)
        return residuals, self.derivatives(state, residuals, single=single)

    def map(self, function, items):
        return [function(item) for item in items]


def begun(bounds: np.ndarray | None = None) -> Descent:
    from dashpot.identify.problem.output_error import State

    return Descent(Line(bounds), State(np.zeros(2), np.zeros((1, 0))))  # type: ignore[arg-type]


def test_a_linear_problem_keeps_its_promise_in_one_step():
    descent = begun()
    (expected,) = descent.expected
    assert descent.step(1e-3)
    assert descent.residuals[0] == pytest.approx(expected, abs=1e-3 * np.std(descent.problem.measured))
    while not descent.resting:
        descent.step(1e-3)
    assert descent.state.values == pytest.approx([1.0, -2.0], abs=0.01)


def test_it_rests_where_nothing_more_is_promised():
    descent = begun()
    while not descent.resting:
        descent.step(1e-6)
    taken, cost = descent.taken, descent.cost
    assert not descent.step(1e-6)
    assert (descent.taken, descent.cost) == (taken + 1, cost)


def test_a_parameter_at_its_bound_promises_nothing_beyond_it():
    low = np.array([[-np.inf, 0.0], [np.inf, np.inf]])  # the second would be -2
    descent = begun(low)
    problem = descent.problem
    (expected,) = descent.expected
    alone = problem.measured - problem.rows[0] * (problem.rows[0] @ problem.measured) / np.sum(problem.rows[0] ** 2)
    assert expected == pytest.approx(alone, abs=1e-9)
    while not descent.resting:
        descent.step(1e-6)
    assert descent.state.values[1] == 0.0
    assert descent.residuals[0] == pytest.approx(alone, abs=1e-3)


def test_other_weights_start_from_where_it_is():
    descent = begun()
    descent.step(1e-3)
    values = descent.state.values.copy()
    noise = [white(descent.residuals[0])]
    descent.weigh_by(noise)
    assert np.array_equal(descent.state.values, values)
    assert descent.cost == cost_of(descent.residuals, noise)
    assert cost_of((np.array([np.nan]),), None) == np.inf


def test_the_cost_of_white_noise_is_concentrated_over_its_level():
    residual = np.array([1.0, -3.0, 2.0])
    assert cost_of((residual,), None) == pytest.approx(1.5 * np.log(14.0 / 3.0))
    assert cost_of((residual,), [white(residual)]) == pytest.approx(1.5)


def test_an_upper_bound_holds_too():
    low = np.array([[-np.inf, -np.inf], [0.0, np.inf]])  # the first would be 1
    descent = begun(low)
    while not descent.resting:
        descent.step(1e-6)
    assert descent.state.values[0] == 0.0
    assert descent.state.values[1] == pytest.approx(
        descent.problem.rows[1] @ descent.problem.measured / np.sum(descent.problem.rows[1] ** 2), abs=1e-3
    )


def test_every_segment_finds_its_own_initial_state():
    from dashpot.identify.problem.output_error import State

    class WithStart(Line):
        """The line, and a decay that begins somewhere."""

        start = np.exp(-np.arange(50) / 10)

        def residuals(self, state):
            return (self.measured + 0.5 * self.start - state.values @ self.rows - state.initial[0] @ [self.start],)

        def derivatives(self, state, residuals, *, single=False):
            return [np.vstack([self.rows, self.start])]

    descent = Descent(WithStart(), State(np.zeros(2), np.zeros((1, 1))))  # type: ignore[arg-type]
    while not descent.resting:
        descent.step(1e-6)
    assert descent.state.initial[0, 0] == pytest.approx(0.5, abs=0.02)
    assert descent.taken < 6


class Springs(Line):
    """Two springs, whose sum is known a hundred times as well as their difference; the first by its frequency."""

    def __init__(self, names: tuple[str, str], sure: float) -> None:
        super().__init__()
        self.core = SimpleNamespace(parameter_names=names)
        self.known = np.array([[sure, sure], [1.0, -1.0]]).T @ self.rows
        self.simulated = 0

    def residuals(self, state):
        self.simulated += 1
        return ((np.array([0.25, 6.75]) - np.array([state.values[0] ** 2, state.values[1]])) @ self.known,)

    def derivatives(self, state, residuals, *, single=False):
        return [self.known * np.array([[2.0 * state.values[0]], [1.0]])]


@pytest.mark.parametrize(("names", "soon"), [(("omega0", "stiffness"), True), (("speed", "stiffness"), False)])
def test_where_a_spring_hands_its_stiffness_on_a_step_of_the_natural_frequency_is_one_of_the_stiffness(names, soon):
    """Straight in both stiffnesses, bent in the natural frequency: each step there is off by its square."""
    from dashpot.identify.problem.output_error import State

    descent = Descent(Springs(names, 1e2), State(np.array([2.0, 3.0]), np.zeros((1, 0))), [white(np.ones(50))])  # type: ignore[arg-type]
    while descent.cost > 1e-3 and descent.taken < 20:
        descent.step(1e-6)
    assert (descent.taken < 5) is soon
    assert descent.state.values == pytest.approx([0.5, 6.75], rel=2e-2)


def test_a_step_that_keeps_its_promise_is_tried_once():
    from dashpot.identify.problem.output_error import State

    problem = Springs(("omega0", "stiffness"), 1.0)
    descent = Descent(problem, State(np.array([0.55, 6.0]), np.zeros((1, 0))), [white(np.ones(50))])  # type: ignore[arg-type]
    before = problem.simulated
    descent.step(1e-6)
    assert problem.simulated == before + 1
    assert descent.state.values[0] != pytest.approx(0.5, rel=1e-6)  # in the natural frequency, which bends


class Wall(Line):
    """No step leads anywhere."""

    def __init__(self, size: float) -> None:
        super().__init__()
        self.size, self.tried = size, []

    def residuals(self, state):
        self.tried.append(np.array(state.values))
        return (self.measured * (2.0 if len(self.tried) > 1 else 1.0) * self.size,)


def test_what_was_tried_in_vain_is_not_tried_again_a_hair_shorter():
    from dashpot.identify.problem.output_error import State

    descent = Descent(Wall(1.0), State(np.array([50.0, 1.0]), np.zeros((1, 0))), [white(np.ones(50))])  # type: ignore[arg-type]
    assert not descent.step(1e-2)
    steps = [np.linalg.norm(values - [50.0, 1.0]) for values in descent.problem.tried[1:]]
    assert 2 <= len(steps) <= 6
    assert all(after < 0.97 * before for before, after in pairwise(steps))  # a tenth less of a promise


@pytest.mark.parametrize(("begin", "tries"), [(50.0, 1), (1e-2, 2)])
def test_the_square_of_the_frequency_is_tried_where_it_makes_a_difference(begin, tries):
    """A step of two is bent at a hundredth, and straight at fifty, by what a tolerance of ten notices."""
    from dashpot.identify.problem.output_error import State

    descent = Descent(Wall(1.0), State(np.array([begin, 1.0]), np.zeros((1, 0))), [white(np.ones(50))])  # type: ignore[arg-type]
    descent.step(10.0)
    first = [values for values in descent.problem.tried[1:3] if abs(values[1] + 1.0) < 0.5]
    assert len(first) == tries


class Circle(Line):
    """The point of a circle next to one that lies far inside, by its angle: what is left is bent by nine tenths."""

    def __init__(self) -> None:
        super().__init__()
        self.free, self.shared = (0,), 1
        self.inside = np.repeat([0.1, 0.0], 25)

    def residuals(self, state):
        return (self.inside - np.repeat([np.cos(state.values[0]), np.sin(state.values[0])], 25),)

    def derivatives(self, state, residuals, *, single=False):
        return [np.repeat([[-np.sin(state.values[0]), np.cos(state.values[0])]], 25, axis=1)]


def test_steps_that_see_a_tenth_of_the_way_are_lengthened():
    """Each goes a tenth of the way to the angle of zero: eight plain ones leave 43 % of it."""
    from dashpot.identify.problem.output_error import State

    begin = State(np.array([0.05]), np.zeros((1, 0)))
    descent = Descent(Circle(), begin, [white(np.ones(50))])  # type: ignore[arg-type]
    for _ in range(8):
        descent.step(1e-9)
    assert abs(descent.state.values[0]) < 1e-4


def moved(motion, residual):
    """A segment, and what is left of its motion."""
    return SimpleNamespace(response=motion + residual), residual


def test_what_is_left_where_the_motion_is_counts_as_many_times_less():
    """In a tenth of the band ten times, in another tenth as white noise does."""
    random = np.random.default_rng(2)
    lines, n = np.zeros(20_001, complex), 40_000
    lines[2000:4000] = random.standard_normal((2000, 2)) @ [1.0, 1j]
    motion = np.fft.irfft(lines, n)
    lines[2000:4000] = random.standard_normal((2000, 2)) @ [1.0, 1j]
    there, elsewhere = np.fft.irfft(lines, n), np.fft.irfft(np.roll(lines, 5000), n)
    noise = random.standard_normal(n)

    def of(*pairs):
        segments, residuals = zip(*(moved(*pair) for pair in pairs), strict=True)
        return repeated(segments, residuals)

    assert of((motion, noise)) == pytest.approx(1.0, abs=0.05)
    assert of((motion, there)) == pytest.approx(10.0, rel=0.05)
    assert of((motion, elsewhere)) == 1.0
    assert of((motion, there), (motion[:20_000], noise[:20_000])) == pytest.approx((2 * 10.0 + 1.0) / 3, rel=0.05)
    assert of((np.zeros(8), np.zeros(8))) == of((np.zeros(8), np.full(8, np.inf))) == 1.0
    assert of((motion, 1e78 * there)) == 1.0  # a motion that runs away leaves what no number is the square of


@pytest.mark.parametrize(("off", "moves"), [(0.1, True), (0.015, False)])
def test_the_tolerance_of_a_search_counts_what_is_left_where_the_motion_is(off, moves):
    """A residual of one line among the three of the motion: a gain of 0.25 counts for less than a tenth of that."""
    from dashpot.identify.problem.output_error import State

    problem = Line()
    problem.of_parameters = lambda information: information
    turns = 2 * np.pi * np.arange(200) / 200
    problem.rows = np.stack([np.cos(3 * turns), np.sin(3 * turns)]) * (1.5 + np.sin(turns))  # three lines each
    problem.measured = problem.rows[0] + 0.5 * np.sin(4 * turns)
    problem.segments = (SimpleNamespace(response=problem.measured, slide=True, after=None),)
    best = np.linalg.lstsq(problem.rows.T, problem.measured)[0]
    start = State(best + np.array([off, 0.0]), np.zeros((1, 0)))
    found = search(problem, start, tolerance=0.05, most=1)  # type: ignore[arg-type]
    assert np.any(found.state.values != start.values) == moves
    known = search(problem, start, [white(0.5 * np.sin(4 * turns))], tolerance=0.05, most=1)  # type: ignore[arg-type]
    assert np.any(known.state.values != start.values)  # each sample of noise that is known to be white counts

"""The Levenberg-Marquardt search, one step at a time: it can be left, and gone on with where it was left.

Levenberg (1944), Marquardt (1963). Every step knows beforehand what the linearised response expects of it, so that of
many searches those that promise nothing can be left alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...simulate.work import TOTAL
from ..signals.noise_spectrum import NoiseSpectrum
from ..signals.registry import budget, numerics
from .limits import KEPT_PROMISE
from .normal_equations import Block, held_at, promise, shared_information, solve
from .output_error import OutputError, blocks_of
from .search_point import Outcome, State
from .segments import Segment
from .state_from_previous_segment import continued_from_previous

_DAMPED = numerics(
    8.0, "times", why="by which a rejected step is damped more, and by as much more each further time (Nielsen 1999)"
)
_LESS = numerics(0.9, "of a promise", why="what is tried next promises less: damped by 1e-12 or by 1e-6 it is the same")
_EASED = numerics(10.0, "times", why="the next step is damped less after one that kept its promise")
_LARGEST = numerics(1e12, "damping", why="beyond it nothing of a step is left")
_SHORTENED = budget(6, "steps", why="tried in one direction: from a damping of 1e-12 to beyond one")
_FLAT = numerics(0.5, "of the curvature", why="below it steps are lengthened: they would take half of the way or less")
_LONGEST = numerics(8.0, "times", why="a step is lengthened at most")
_STRAIGHT = numerics(1e-3, "log-likelihood a sample", why="promised by a step over which the logarithm is straight")
MOST_STEPS = budget(40, "steps", why="a search takes ten to twenty")


class Descent:
    """A search of one problem and where it has come to.

    Args:
        problem: simulates, and knows its derivatives.
        state: where it starts.
        noise: one spectrum per segment; None takes each segment's noise for white, with the level that the residual
            itself shows (the likelihood concentrated over the levels).
        residuals: at ``state``, where they are known already.

    Attributes:
        state, residuals, cost: the best so far; ``cost`` is the negative log-likelihood but for what does not depend
            on the parameters.
        taken: steps tried.
        resting: whether it has come to rest: no step promises, or keeps, more than the tolerance.
    """

    def __init__(
        self,
        problem: OutputError,
        state: State,
        noise: Sequence[NoiseSpectrum] | None = None,
        residuals: tuple[np.ndarray, ...] | None = None,
    ) -> None:
        TOTAL.fit()
        self.problem = problem
        self.noise = noise
        self.state = state
        self.residuals = problem.residuals(state) if residuals is None else residuals
        self.cost = cost_of(self.residuals, noise)
        self.taken, self.resting = 0, False
        self._damping = 1e-4
        names = problem.core.parameter_names
        self._natural_frequency = names.index("omega0") if "omega0" in names else None
        self._stretch = 1.0
        self._sure = True  # that the next step is taken, so that its run may carry the derivatives there along
        self._rows: list[np.ndarray] | None = None
        self._blocks: list[Block] | None = None
        self._expected: tuple[np.ndarray, ...] | None = None

    @property
    def blocks(self) -> list[Block]:
        """Normal matrix and gradient of each segment, here."""
        if self._blocks is None:
            rows, self._rows = self._rows, None
            if rows is None:
                rows = self.problem.derivatives(self.state, self.residuals, single=True)
            self._blocks = blocks_of(self.problem, rows, self.residuals, self.noise, consumed=True)
        return self._blocks

    @property
    def expected(self) -> tuple[np.ndarray, ...]:
        """What the whole next step would leave if the response were linear: one (n,) array a segment."""
        if self._expected is None:
            rows, self._rows = self._rows, None
            if rows is None:
                rows = self.problem.derivatives(self.state, self.residuals)
            if self._blocks is None:
                self._blocks = blocks_of(self.problem, rows, self.residuals, self.noise)
            shared, own = self._solved(0.0)
            self._expected = tuple(
                residual - np.concatenate([shared, initial]) @ row
                for residual, initial, row in zip(self.residuals, own, rows, strict=True)
            )
        return self._expected

    def weigh_by(self, noise: Sequence[NoiseSpectrum]) -> None:
        """Go on with other noise."""
        self.noise, self.cost, self.resting = noise, cost_of(self.residuals, noise), False
        self._blocks = self._expected = None

    def step(self, tolerance: float, *, last: bool = False) -> bool:
        """Take one step; gives whether it gained anything.

        A step that leads nowhere is tried once more, with the natural frequency's part taken in its square
        (``State.stepped``), before it is shortened.

        Args:
            tolerance: the search rests when the next step promises a smaller gain of log-likelihood; a gain of 0.5 is
                a step of one standard error.
            last: whether nothing is asked of where it leads, so that no derivatives are wanted there.
        """
        self.taken += 1
        more, tried = _DAMPED, np.inf
        for _ in range(_SHORTENED):
            shared, own, gain = self._next(tolerance, _LESS * tried)
            if gain < tolerance:
                self.resting = True
                return False
            long, self._stretch = self._stretch, 1.0
            rows: list[np.ndarray] | None
            trial, residuals, cost, rows = self._tried(long * shared, long * own, derived=self._sure and not last)
            if long > 1.0 and not self.cost - cost > gain:
                continue  # the plain one promises as much
            if not cost < self.cost and self._is_bent(shared, tolerance):
                rows = None
                trial, residuals, cost, _ = self._tried(shared, own, self._natural_frequency)
            if cost < self.cost:
                better = self.cost - cost > KEPT_PROMISE * gain
                self._stretch = self._asked_by(gain, self.cost - cost, long)
                self._damping = max(self._damping / _EASED, 1e-12) if better else self._damping * 2.0
                self.state, self.residuals, self.cost, self._rows = trial, residuals, cost, rows
                self._blocks, self._expected, self._sure = None, None, better
                return True
            self._damping, more, tried, self._sure = self._damping * more, more * _DAMPED, gain, False
        self.resting = True  # no step in any direction helps: the maximum, to the precision of the derivatives
        return False

    def _asked_by(self, gain: float, gained: float, long: float) -> float:
        """How long the next step is to be, by what one that promised a gain did gain when it was taken so long.

        What a wrong model leaves bends the likelihood against the derivatives, which steps do not see (Dennis, Gay,
        Welsch 1981). Where that takes most of the curvature away each step is too short, by about the same.
        """
        if gain > _STRAIGHT * sum(residual.size for residual in self.residuals):
            return 1.0  # the likelihood is no parabola over such a step
        curvature = (2.0 * long - gained / gain) / long**2
        return 1.0 if curvature > _FLAT else 1.0 / max(curvature, 1.0 / _LONGEST)

    def _next(self, tolerance: float, most: float) -> tuple[np.ndarray, np.ndarray, float]:
        """The next step that promises no more than so much, or less than the tolerance; with what it promises."""
        while True:
            shared, own = self._solved(self._damping)
            if np.all(np.isfinite(shared)) and np.all(np.isfinite(own)):
                gain = 0.5 * promise(self.blocks, shared, own)
                if gain <= max(most, tolerance) or not gain >= tolerance:
                    return shared, own, gain
            elif self._damping > _LARGEST:  # derivatives too large to be solved for
                return shared, own, 0.0
            self._damping *= _DAMPED

    def _is_bent(self, shared: np.ndarray, tolerance: float) -> bool:
        """Whether it matters if the natural frequency or its square goes straight: they part by the step's square."""
        if self._natural_frequency not in self.problem.free:
            return False
        place = self.problem.free.index(self._natural_frequency)
        apart = shared[place] ** 2 / (2.0 * self.state.values[self._natural_frequency])
        return bool(apart**2 * sum(float(normal[place, place]) for normal, _ in self.blocks) > 2 * tolerance)

    def _tried(
        self, shared: np.ndarray, own: np.ndarray, squared: int | None = None, *, derived: bool = False
    ) -> tuple[State, tuple[np.ndarray, ...], float, list[np.ndarray] | None]:
        """Where a step leads, within the bounds, what it leaves there, its cost; if ``derived`` the derivatives."""
        problem = self.problem
        state = self.state.stepped(problem.free, shared, own, squared)
        if problem.bounds is not None:
            state = replace(state, values=np.clip(state.values, *problem.bounds))
        state = continued_from_previous(problem, state)
        if derived:
            residuals, rows = problem.residuals_with_derivatives(state, single=True)
        else:
            residuals, rows = problem.residuals(state), None
        return state, residuals, cost_of(residuals, self.noise), rows

    def _solved(self, damping: float) -> tuple[np.ndarray, np.ndarray]:
        """The next step, without those parameters that would leave their bounds from where they are."""
        blocks = self.blocks
        problem = self.problem
        shared, own = solve(blocks, damping, problem.shared)
        if problem.bounds is None:
            return shared, own
        places = list(problem.free)
        low, high = problem.bounds[:, places]
        here = self.state.values[places]
        step = shared[: len(places)]
        stopped = ((here <= low) & (step < 0)) | ((here >= high) & (step > 0))
        if not np.any(stopped):
            return shared, own
        return solve([held_at(block, np.flatnonzero(stopped)) for block in blocks], damping, problem.shared)


def cost_of(residuals: Sequence[np.ndarray], noise: Sequence[NoiseSpectrum] | None) -> float:
    """Negative log-likelihood but for what does not depend on the parameters; inf where a residual is not finite.

    Concentrated over a white level of each segment where ``noise`` is None.
    """
    if not all(np.all(np.isfinite(residual)) for residual in residuals):
        return np.inf
    if noise is None:
        with np.errstate(over="ignore"):  # a motion that runs away costs without end
            return sum(0.5 * r.size * float(np.log(max(np.mean(r**2), np.finfo(float).tiny))) for r in residuals)
    return sum(0.5 * float(np.vdot(lines := s.lines(r), lines)) for r, s in zip(residuals, noise, strict=True))


def repeated(segments: Sequence[Segment], residuals: Sequence[np.ndarray]) -> float:
    """How many samples of what is left count as one witness of a parameter; 1 in white noise, and at least.

    What is left has more power where the motion is than elsewhere, and derivatives are where the motion is: by the
    ratio of the two the variance of a gradient is larger than white noise of the same power makes it (Huber 1967, in
    the frequency domain). By no more than what is left is like itself, the sum of the squares of its autocorrelation
    (Bartlett 1946), so that noise of a slight colour counts nearly as white noise does. The mean over all segments, by
    their length.
    """
    from scipy import fft

    if not all(np.all(np.isfinite(residual)) for residual in residuals):
        return 1.0
    worth = 0.0
    for segment, residual in zip(segments, residuals, strict=True):
        motion = segment.response - residual
        left, moved = (np.abs(np.asarray(fft.rfft(signal))) ** 2 for signal in (residual, motion - np.mean(motion)))
        power, shared = float(np.mean(left)), float(np.mean(left)) * float(np.mean(moved))
        there, alike = 1.0, 1.0
        if shared > 0.0 and power * power < np.inf:  # of a motion that runs away a square may be beyond all numbers
            there = float(np.mean(left * moved)) / shared
            alike = float(np.mean(left**2)) / (2.0 * power**2)  # the lines of white noise scatter as exponentials do
        worth += residual.size * max(min(there, alike), 1.0)
    return worth / sum(residual.size for residual in residuals)


def search(
    problem: OutputError,
    state: State,
    noise: Sequence[NoiseSpectrum] | None = None,
    *,
    tolerance: float = 1e-3,
    most: int = MOST_STEPS,
    informed: bool = True,
    tempered: bool = True,
    residuals: tuple[np.ndarray, ...] | None = None,
) -> Outcome:
    """Minimise the negative log-likelihood from ``state``.

    Args:
        problem: what is fitted.
        state: where to start.
        noise: one spectrum per segment; None takes each segment's noise for white, with the level that the residual
            itself shows (the likelihood concentrated over the levels).
        tolerance: the search is over when the next step promises a smaller gain of log-likelihood; a gain of
            0.5 is a step of one standard error.
        most: steps it may take.
        informed: whether the information at the end is wanted where the last step was the last allowed.
        tempered: whether, where the noise is taken for white and what is left is not, a gain counts for as many times
            less as more is left where the motion is (``repeated``).
        residuals: at ``state``, where they are known already.
    """
    descent = Descent(problem, state, noise, residuals)
    while descent.taken < most and not descent.resting:
        worth = tolerance
        if tempered and noise is None:
            worth *= repeated(problem.segments, descent.residuals)
        descent.step(worth, last=descent.taken + 1 == most and not informed)
    information = np.zeros((len(problem.free), len(problem.free)))
    if informed or descent.resting:
        information = problem.of_parameters(shared_information(descent.blocks, problem.shared))
    return Outcome(descent.state, descent.cost, information, descent.residuals, descent.taken, descent.resting)

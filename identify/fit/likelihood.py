"""Maximum likelihood for any structure, over all recordings jointly; it survives a model that is not exact.

The model is the recorded rig's but for a latent force (``prediction``). With a long enough memory of the model the
likelihood is that of output error with the noise's own spectrum (Whittle 1953), which reaches the Cramér-Rao bound
where regressions on differentiated data are biased by any noise; with a short one it is that of prediction over a
cycle, which every start survives. The search runs from prediction to simulation, each time from where the last ended.
The answer is that of simulation where the model keeps step with the recordings; what the most likely memory says
otherwise is then in the standard errors. Where no simulation keeps step, the answer is that of the most likely memory.

The map from what was measured to the prediction errors is causal with a unit diagonal, whatever the gain, so that
likelihoods of different memories are those of the same data and may be compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from ...errors import BadInput
from ...model import Oscillator
from ...recording.recording import Recording
from ..problem.data import Data, data_of
from ..problem.descent import search
from ..problem.jumps import left_out, smooth_stretches
from ..problem.last_swings import with_last_swings
from ..problem.offset import Offset
from ..problem.output_error import OutputError, State
from ..problem.segments import Segment
from ..problem.structure import Structure
from ..signals.odds import ABOVE_NOISE
from .choose_noise_model import linear_state, plain_cost
from .climb import best_climb, from_near
from .from_prediction import from_prediction, keeps_step
from .offsets import kept_offsets, zeros_of
from .reported_result import Fit, ended
from .reweighted_fit import over_noise


def maximum_likelihood(
    start: Oscillator,
    recordings: Sequence[Recording],
    fixed: Sequence[str] = (),
    data: Data | None = None,
    *,
    doubted: bool = True,
    near: bool = False,
    drifts: Sequence[Offset] = (),
    others: Callable[[], Iterable[Oscillator]] = tuple,
) -> Fit:
    """Find the parameters of ``start``'s structure that make the recordings most likely.

    Args:
        start: structure, with any laws of the library, and start values; ``mass`` None where no recording has a force.
        recordings: of one rig, all of the same quantity.
        fixed: names of parameters that keep their values.
        data: the recordings as they are fitted, where they have been cut before.
        doubted: whether a simulation that keeps step is held against predictions, for the standard errors, and its
            search ended by simulations as they are delivered; fits that are only compared need neither.
        near: whether ``start`` was found from these very recordings: then nothing has to lead to it, and where it keeps
            step no linear rig is asked for.
        drifts: of sensors, where they are known from another fit: a further mode would take one for a slow one.
        others: more models of the same structure to start from, asked for where the first explains little.

    Raises:
        BadInput: where nothing in the recordings can be simulated.
    """
    data = data or data_of(recordings, start, coarse=False)
    structure = Structure(start, data, fixed, (*zeros_of(data, recordings, start), *drifts))
    problem = structure.problem.coarsely()
    climb = from_near(problem, structure.state(None)) if near else None
    near = climb is not None and keeps_step(problem.segments, problem.residuals(climb.state))
    climb = climb or best_climb(problem, structure.state(None), others)
    reached, free, rungs, iterations = climb.problem, climb.state, climb.rungs, climb.iterations
    notes = [] if climb.whole else [_beyond(reached.segments, problem.segments, recordings)]
    problem, free = kept_offsets(reached, free, start)
    if any(offset.channel == "drift" for offset in problem.offsets):
        try:
            free, rungs, steps = from_prediction(problem, free)  # what drifted may have misled the search
            iterations += steps
        except BadInput:  # with that taken off nothing simulates: it was the model's lack and no drift
            problem, free = _without_drift(problem, free)
    plain, steps = np.inf, 0
    if not near:
        free, plain, steps = _beside_linear(problem, free, start, recordings)
    iterations += steps
    if doubted and problem.free:
        problem = problem.over(with_last_swings(problem, free, recordings))
    smooth, begun = smooth_stretches(problem, free)
    jumps = left_out(problem.segments, smooth, [recording.name for recording in recordings])
    notes += jumps
    if jumps:
        problem = problem.over(smooth)  # what has no derivative may have held the search back
        free, rungs, steps = from_prediction(problem, begun)
        iterations += steps
        free, plain, steps = _beside_linear(problem, free, start, recordings)
        iterations += steps
    fit = ended(problem.coarsely(not doubted), free, start, recordings, rungs, plain, notes, doubted=doubted)
    return replace(fit, iterations=fit.iterations + iterations)


def _without_drift(problem: OutputError, state: State) -> tuple[OutputError, State]:
    """The problem and the point of its search without the drift of any sensor."""
    kept = [index for index, offset in enumerate(problem.offsets) if offset.channel != "drift"]
    return problem.with_offsets([problem.offsets[index] for index in kept]), replace(state, offsets=state.offsets[kept])


def _beside_linear(
    problem: OutputError, state: State, start: Oscillator, recordings: Sequence[Recording]
) -> tuple[State, float, int]:
    """The simulation beside the best linear rig's, which it must not leave more than; that one's cost, and the steps.

    Only where more than noise is left: else there is nothing better. Nor is there where no parameter is free.
    """
    if not problem.free:
        return state, np.inf, 0
    residuals = problem.residuals(state)
    if max(over_noise(problem, residuals, state, start, recordings)) <= ABOVE_NOISE:
        return state, np.inf, 0
    plain = linear_state(problem, state, start)
    if plain is None:
        return state, np.inf, 0
    cost = plain_cost(problem.residuals(plain))
    if not cost < plain_cost(residuals):
        return state, cost, 0
    outcome = search(problem, plain, tolerance=1.0)
    return outcome.state, cost, outcome.iterations


def _beyond(reached: Sequence[Segment], whole: Sequence[Segment], recordings: Sequence[Recording]) -> str:
    """Which ends of decays no model of the structure was found to simulate."""
    ends = [
        f"{recordings[part.recording].name} from {part.time + part.n * part.dt:.4g} s"
        for part, all_of_it in zip(reached, whole, strict=True)
        if part.n < all_of_it.n
    ]
    return f"no model of this structure that fits the beginning simulates the end of {', '.join(ends)}; it was left out"

"""What a fit costs that survives a wrong model: its seconds beside those of plain output error, in one run.

    python benchmarks/wrong_model.py [REPEATS]

Sixty cycles of the built-in rig with something more in it that the model lacks, let go and driven through its
resonance, from the recording to the model. Plain output error is the same simulation from the same start values, with
the same weights and standard errors, but without the way from prediction to simulation, the linear rig beside it, what
predictions say otherwise, and the question how the force runs between samples. Prints the seconds of either (medians),
their ratio, and what either leaves of the motion.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify import identify
from dashpot.identify.fit.reweighted_fit import reweighted
from dashpot.identify.fit.scatter import noise_on_forces, scatter
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.output_error import MOST_STEPS
from dashpot.identify.problem.replay import replay
from dashpot.identify.problem.settle import settled
from dashpot.identify.problem.structure import Structure
from dashpot.identify.start.start import hilbert_start
from dashpot.model import Oscillator, oscillator_with
from dashpot.recording import Recording
from dashpot.simulate.core import core_of, internal_step
from dashpot.simulate.force import force_between

CYCLES, FS, NOISE, AMPLITUDE = 60, 500.0, 1e-5, 8e-3
DRAWS = 60
SECONDS = CYCLES * 2 * np.pi / TRUTH["omega0"]
#: What is missing, with its parameters: each changes the motion by some per cent.
MISSING = {
    "quadratic-drag": {"coefficient": 20.0},
    "quintic-stiffness": {"coefficient": 2e11},
    "softening-stiffness": {"stiffness": 800.0, "width": 2e-3},
    "stribeck": {"excess": 0.3, "speed": 0.05, "exponent": 1.0},
}


def recorded(effect: str, values: dict[str, float], *, driven: bool) -> Recording:
    """A decay or a sweep of the rig with the effect, simulated as dashpot does."""
    known = {f"{effect}.{name}": value for name, value in values.items()}
    rig = oscillator_with(TRUTH | known, effects=(effect,))
    n = round(SECONDS * FS)
    t = np.arange(n) / FS
    pace = TRUTH["omega0"] / (2 * np.pi)
    force = 3.0 * np.sin(2 * np.pi * (0.5 * pace * t + 0.5 * pace * t**2 / SECONDS)) if driven else None
    pushed = None if force is None else force_between(force, 1 / FS, "smooth", 8 * pace)
    step = internal_step(rig, rig.values(), AMPLITUDE)
    begin = np.array([0.0 if driven else AMPLITUDE, 0.0])
    core = core_of(rig)
    moved = core.record(np.array(list(rig.values().values())), begin, pushed, n, 1 / FS, step, quantity="displacement")
    return Recording(effect, FS, moved + NOISE * np.random.default_rng(n).standard_normal(n), force)


def output_error(recordings: Sequence[Recording]) -> Oscillator:
    """The minimum of the weighed simulation error next to the start values, with what its standard errors take."""
    estimate = hilbert_start(recordings)
    start = Oscillator.from_values({name: getattr(estimate, name) for name in TRUTH})
    structure = Structure(start, data_of(recordings, start, coarse=False))
    problem = structure.problem
    answer, _ = reweighted(problem, settled(problem, structure.state(None)), start, recordings, np.inf, MOST_STEPS)
    state = answer.outcome.state
    levels = noise_on_forces(problem, state, answer.outcome.residuals, recordings)
    scatter(problem, state, answer.noise, levels, DRAWS, remainders=answer.remainders, recordings=recordings)
    values = dict(zip(start.parameters(), map(float, state.values), strict=True))
    return Oscillator.from_values(values)


def timed(fit: Callable[[], Oscillator], repeats: int) -> tuple[float, Oscillator | None]:
    """Median of the seconds, and the answer; None where it ended in an error."""
    seconds, answer = [], None
    for _ in range(repeats):
        began = time.perf_counter()
        try:
            answer = fit()
        except BadInput:
            answer = None
        seconds.append(time.perf_counter() - began)
    return float(np.median(seconds)), answer


def left(model: Oscillator | None, recording: Recording) -> float:
    """Per cent of the motion that a free simulation leaves."""
    if model is None:
        return np.nan
    response = np.asarray(recording.response)
    return 100 * float(np.std(replay(model, recording) - response) / np.std(response))


def main() -> None:
    """Print a line an effect and kind of motion."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    ratios = []
    for effect, values in MISSING.items():
        for driven in (False, True):
            recording = recorded(effect, values, driven=driven)
            identify([recording])  # compiles and imports
            # what is known of a recording is kept with it
            ours, survives = timed(lambda r=recording: identify([replace(r)]).oscillator, repeats)
            plain, other = timed(lambda r=recording: output_error([replace(r)]), repeats)
            ratios.append(ours / plain)
            print(
                f"{effect}, {'sweep' if driven else 'decay'}: {ours:.2f} s beside {plain:.2f} s, "
                f"{ratios[-1]:.2f} times; leaves {left(survives, recording):.3g} % of the motion, "
                f"plain {left(other, recording):.3g} %",
                flush=True,
            )
    print(f"median ratio {np.median(ratios):.2f}, largest {max(ratios):.2f}")


if __name__ == "__main__":
    main()

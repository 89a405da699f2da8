"""The Jacobian of any layout of unknowns is what plain central differences of the simulation give.

A layout: which parameters are free, which zeros and drifts of the sensors, which segments begin at rest, how far the
model predicts, and whether a record is taken for a long one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from dashpot.examples.truth import TRUTH
from dashpot.examples.virtual_recording import recording_of
from dashpot.identify.problem import output_error
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.prediction import FREE
from dashpot.identify.problem.structure import Structure
from dashpot.model import Oscillator
from hypothesis import strategies as st

#: Without what jumps: a central difference has to exist at each sample.
SMOOTH = TRUTH | {"preload": 0.0, "dry": 0.0}
MODEL = Oscillator.from_values(SMOOTH)
NAMES = ("mass", "omega0", "cubic", "viscous")
RECORDINGS = (
    recording_of(SMOOTH, sweep=(1.0, 5.0, 20.0), begin=(1e-3, 0.0), fs=500.0, seconds=2.0, name="moving"),
    recording_of(SMOOTH, sweep=(1.0, 5.0, 20.0), fs=500.0, seconds=2.0, seed=1, name="from rest"),
    recording_of(SMOOTH, begin=(4e-3, 0.0), fs=500.0, seconds=2.0, seed=2, name="decay"),
)
DATA = data_of(RECORDINGS, MODEL, coarse=False)
SCALES = {"force": 1e-3, "response": 1e-5, "drift": 1e-5}
#: A difference quotient over a step of 1e-5 of a value, against a central one.
NEAR = 1e-3

layouts = st.fixed_dictionaries(
    {
        "free": st.sets(st.sampled_from(NAMES)),
        "offsets": st.sets(st.tuples(st.integers(0, 2), st.sampled_from(sorted(SCALES)))),
        "order": st.randoms(use_true_random=False),
        "memory": st.sampled_from([FREE, 4.0, 12.0]),
        "long": st.booleans(),
        "backwards": st.booleans(),
    }
)


def problem_of(layout):
    chosen = sorted((r, c) for r, c in layout["offsets"] if c != "force" or RECORDINGS[r].force is not None)
    layout["order"].shuffle(chosen)
    offsets = [Offset(r, c, SCALES[c], SCALES[c] * (k + 1), 1.0) for k, (r, c) in enumerate(chosen)]
    fixed = [name for name in MODEL.parameters() if name not in layout["free"]]
    segments = DATA.segments[::-1] if layout["backwards"] else DATA.segments
    structure = Structure(MODEL, replace(DATA, segments=segments), fixed, offsets)
    return structure.problem.predicting(layout["memory"]), structure.state(None)


def plain(problem, state, i):
    """(unknowns, n) central differences of a segment's response, each unknown moved in the state itself."""
    segment, rows = problem.segments[i], []

    def difference(field, place, size):
        ahead, back = (getattr(state, field).copy() for _ in range(2))
        ahead[place] += 1e-4 * size
        back[place] -= 1e-4 * size
        made = [problem.simulate(i, replace(state, **{field: moved})) for moved in (ahead, back)]
        return (made[0] - made[1]) / (2e-4 * size)

    for place in problem.free:
        rows.append(difference("values", place, max(abs(state.values[place]), problem.scale[place])))
    for place, offset in enumerate(problem.offsets):
        rows.append(difference("offsets", place, max(offset.scale, abs(state.offsets[place]))))
    for place in range(problem.core.states):
        own = place in problem.free_states(segment)
        size = max(problem.state_scale[place], abs(state.initial[i, place]))
        rows.append(difference("initial", (i, place), size) if own else np.zeros(segment.n))
    return np.array(rows)


def test_any_layout_has_the_jacobian_of_plain_central_differences(every, monkeypatch):
    usual = output_error.LONG

    def holds(layout):
        monkeypatch.setattr(output_error, "LONG", 100 if layout["long"] else usual)
        problem, state = problem_of(layout)
        residuals = problem.residuals(state)
        expected = [plain(problem, state, i) for i in range(len(problem.segments))]
        for _ in range(2):  # computed, and once more from what was kept
            for found, rows in zip(problem.derivatives(state, residuals), expected, strict=True):
                size = np.max(np.abs(rows), axis=1, keepdims=True)
                assert found.shape == rows.shape
                assert np.all(np.abs(found - rows) <= NEAR * size + 1e-12)

    every(layouts, holds)

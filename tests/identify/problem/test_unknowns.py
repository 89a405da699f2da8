"""The unknowns of a problem stand in the order of the rows of its derivatives, and each has a row of its own."""

from __future__ import annotations

import numpy as np
import pytest
from dashpot.examples.truth import TRUTH
from dashpot.identify.faults.fault import ZeroStep
from dashpot.identify.faults.fault_score import with_sizes
from dashpot.identify.problem.data import data_of
from dashpot.identify.problem.offset import Offset
from dashpot.identify.problem.search_point import State
from dashpot.identify.problem.structure import Structure
from dashpot.identify.problem.unknowns import Unknown, Unknowns
from dashpot.model import Oscillator
from dashpot.recording import Recording

FS = 500.0
OFFSETS = (Offset(0, "response", 1e-5), Offset(1, "response", 1e-5), Offset(1, "force", 1e-2))


@pytest.fixture(scope="module")
def found():
    """A problem of a decay, and of a sweep from rest, with zeros; its state, and its unknowns."""
    t = np.arange(1500) / FS
    decay = Recording("decay", FS, 8e-3 * np.exp(-2 * t) * np.cos(80 * t), None, free=True)
    moved = np.concatenate([np.zeros(500), 1e-3 * np.sin(60 * t[:1000])])
    force = np.concatenate([np.zeros(500), np.sin(60 * t[:1000])])
    model = Oscillator.from_values(TRUTH)
    data = data_of([decay, Recording("sweep", FS, moved, force)], model, coarse=False)
    structure = Structure(model, data, ("cubic", "preload"), OFFSETS)
    state = structure.state(None)
    return structure.problem, state, Unknowns.of(structure.problem, state)


def test_shared_unknowns_are_parameters_and_then_zeros(found):
    problem, _, unknowns = found
    kinds = [unknown.kind for unknown in unknowns.shared]
    assert kinds == ["parameter"] * len(problem.free) + ["chain"] * len(OFFSETS)
    names = [unknown.name for unknown in unknowns.shared]
    assert names[: len(problem.free)] == [problem.core.parameter_names[place] for place in problem.free]
    assert names[-1] == "force of recording 2"
    mass = unknowns.shared[names.index("mass")]
    assert 0 < mass.low < TRUTH["mass"] < mass.high
    assert mass.size == pytest.approx(TRUTH["mass"])


def test_a_segment_has_the_initial_states_that_it_does_not_know(found):
    problem, _, unknowns = found
    for i, segment in enumerate(problem.segments):
        assert [unknowns.index(own) - problem.shared for own in unknowns.initial(i)] == list(
            problem.free_states(segment)
        )
        assert all((own.kind, own.segment) == ("initial", i) for own in unknowns.initial(i))


def moved_by(problem, i, k, state, step):
    """The point with the unknown of row k, of one segment where it is its own, moved."""
    values, initial, offsets = state.values.copy(), state.initial.copy(), state.offsets.copy()
    if k < len(problem.free):
        values[problem.free[k]] += step
    elif k < problem.shared:
        offsets[k - len(problem.free)] += step
    else:
        initial[i, k - problem.shared] += step
    return State(values, initial, offsets)


def test_each_unknown_has_the_row_of_its_own_derivative(found):
    """Moved by a small step it changes the response by that row, and by no other."""
    problem, state, unknowns = found
    residuals = problem.residuals(state)
    rows = problem.derivatives(state, residuals)
    for unknown in unknowns:
        k = unknowns.index(unknown)
        for i in range(len(problem.segments)) if unknown.segment is None else [unknown.segment]:
            step = 1e-6 * unknown.size
            moved = problem.residuals(moved_by(problem, i, k, state, step))[i]
            expected = (residuals[i] - moved) / step
            assert np.linalg.norm(rows[i][k] - expected) <= 1e-3 * np.linalg.norm(expected) + 1e-12


def test_unknowns_are_told_apart_by_name(found):
    problem, state, unknowns = found
    faulty = problem.with_faults([ZeroStep(0, 1.0), ZeroStep(0, 2.0)])
    more = Unknowns.of(faulty, with_sizes(faulty, state))
    assert len(set(more.shared)) == faulty.shared
    assert [more.index(unknown) for unknown in more.shared] == list(range(faulty.shared))
    with pytest.raises(ValueError, match="not in tuple"):
        unknowns.index(Unknown("parameter", "no such thing"))

"""Laws with which whole recordings are told worse in one run than without."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from dashpot.diagnose import in_one_run
from dashpot.diagnose.in_one_run import left_of, told_best_in_one_run
from dashpot.diagnose.search.candidate import Candidate

MOTION = np.sin(0.1 * np.arange(400))
THREE, TWO = ("a", "b", "c"), ("a", "b")


def candidate(laws, stage="judged"):
    return Candidate(laws, SimpleNamespace(model=laws), stage=stage)


@pytest.fixture
def leaving(monkeypatch):
    """``leaving(parts)``: what each structure leaves of the motion of two recordings, of one size or of two."""

    def set_up(parts):
        def judged(model, _data):
            sizes = np.broadcast_to(parts[model], 2)
            return SimpleNamespace(residuals=[size * MOTION for size in sizes])

        monkeypatch.setattr(in_one_run, "judged", judged)
        return SimpleNamespace(segments=[SimpleNamespace(response=scale * MOTION) for scale in (1.0, 5.0)])

    return set_up


def test_each_recording_counts_by_the_part_of_its_own_motion(leaving):
    whole = leaving({TWO: (0.1, 0.5)})
    about = np.log(np.mean(MOTION**2) / np.var(MOTION))
    assert left_of(candidate(TWO), whole) == pytest.approx(2 * math.log(0.1) + about)


@pytest.mark.parametrize(("with_it", "kept"), [(0.0501, THREE), (0.0499 * 1.005, THREE), (0.0506, TWO), (0.5, TWO)])
def test_a_law_goes_with_which_the_whole_is_told_worse_by_what_matters(leaving, with_it, kept):
    whole = leaving({THREE: with_it, TWO: 0.05, ("b", "c"): 0.2, ("a",): 0.3, ("b",): 0.4})
    known = [candidate(TWO), candidate(("b", "c")), candidate(("a",)), candidate(("b",))]
    search = SimpleNamespace(candidates={c.laws: c for c in known})
    assert told_best_in_one_run(candidate(THREE), search, whole).laws == kept
    assert (THREE in search.candidates) is (kept == TWO)


def test_one_after_another_goes_and_one_stays(leaving):
    whole = leaving({THREE: 0.4, TWO: 0.3, ("a",): 0.2})
    search = SimpleNamespace(candidates={laws: candidate(laws) for laws in (TWO, ("a",), ())})
    assert told_best_in_one_run(candidate(THREE), search, whole).laws == ("a",)


@pytest.mark.parametrize("stage", ["left", "simulated"])
def test_what_was_never_weighed_replaces_nothing(leaving, stage):
    whole = leaving({THREE: 0.4, TWO: 0.1})
    search = SimpleNamespace(candidates={TWO: candidate(TWO, stage)})
    assert told_best_in_one_run(candidate(THREE), search, whole).laws == THREE

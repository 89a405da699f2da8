"""One run that is there twice among several recordings, whole or in part, is found; honest repeats are not."""

from __future__ import annotations

from dataclasses import replace

import dashpot
import numpy as np
import pytest
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.identify.identification import belong_together
from dashpot.recording import Recording
from dashpot.recording.checks import overlapping
from dashpot.recording.continuity import in_both

FS, N = 500.0, 3000
MODEL = dashpot.Model.from_values(TRUTH)
T = np.arange(N) / FS


def run(seed: int, name: str = "run.csv", noise: float = 1e-6) -> Recording:
    """A driven record: the same force and motion each time, and noise of its own."""
    random = np.random.default_rng(seed)
    response = 5e-3 * np.sin(60 * T) + noise * random.standard_normal(N)
    return Recording(name, FS, response, np.sin(60 * T + 1.0) + 1e-3 * random.standard_normal(N))


@pytest.mark.parametrize(
    ("change", "begin"),
    [
        (lambda r: r.slice(1000, N), 2.0),
        (lambda r: r.slice(1000, 1200), 2.0),
        (lambda r: replace(r.slice(1000, N), start=0.0), 0.0),
        (lambda r: replace(r.slice(1000, N), response=np.round(r.slice(1000, N).response, 9)), 2.0),
        (lambda r: replace(r, response=0.001 * (1000.0 * r.response)), 0.0),
    ],
    ids=["half", "short", "shifted", "rounded", "in mm"],
)
def test_what_is_there_twice_is_found(change, begin):
    other = replace(change(run(1)), name="again.csv")
    (problem,) = overlapping([run(0, "first.csv"), run(1), run(2, "last.csv"), other])
    assert problem.severity == "error"
    assert problem.sentence.startswith(f"again.csv: the {other.n} samples from {begin:.6g} s on are those of run.csv")
    with pytest.raises(BadInput, match="one run would count twice"):
        belong_together([run(1), other])


def test_honest_repeats_and_neighbouring_parts_are_not():
    whole = run(1)
    parts = [replace(whole.slice(a, a + 1000), name=f"{a}.csv") for a in (0, 1000, 2000)]
    assert overlapping([run(seed, f"{seed}.csv") for seed in range(8)]) == []
    assert overlapping(parts) == []


@pytest.mark.parametrize("noise", [0.0, 1e-12], ids=["computed", "below six digits"])
def test_what_has_no_noise_may_repeat(noise):
    assert overlapping([run(1, noise=noise), run(2, "again.csv", noise=noise)]) == []


def test_copies_are_found_before_anything_is_computed_of_them(monkeypatch):
    monkeypatch.setattr("dashpot.identify.motion.modes.modes_of", lambda *_, **__: pytest.fail("computed first"))
    copies = [replace(run(1, noise=0.0), name=f"{i}.csv") for i in range(30)]
    for call in (dashpot.identify, lambda given: dashpot.diagnose(MODEL, given)):
        with pytest.raises(BadInput, match=r"^1\.csv is given twice"):
            call(copies)


def test_a_force_that_is_commanded_alike_is_no_repeat():
    runs = [replace(run(seed, f"{seed}.csv"), force=np.sin(60 * T)) for seed in range(3)]
    assert overlapping(runs) == []


def test_places_are_those_of_the_block():
    random = np.random.default_rng(0)
    first, second, third = (random.standard_normal((2, 500)) for _ in range(3))
    third[:, 40:140] = first[:, 300:400]
    assert in_both([first, second, third]) == (0, 2, 300, 40, 100)
    assert in_both([first, second]) is None
    assert in_both([]) is None
    assert in_both([first[:, :20], third[:, :20]]) is None

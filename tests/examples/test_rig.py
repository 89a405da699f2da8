"""The recordings in the repository are what the stands give."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from dashpot.examples import recordings
from dashpot.examples.rig import DT, FORCE_NOISE, KINDS, SENSOR_NOISE, STANDS, force, main, paper_stand, record

QUANTUM = {"force": 1e-5, "displacement": 1e-8}


def made_again() -> list[object]:
    """Of each stand the shortest recording, and for `make test-all` the others."""
    return [
        pytest.param(stand, kind, marks=() if kind == "bursts" else pytest.mark.long)
        for stand in STANDS
        for kind in KINDS
    ]


@pytest.mark.parametrize(("stand", "kind"), made_again())
def test_recordings_are_made_again(stand, kind):
    path = recordings(stand)[kind]
    with gzip.open(path, "rt") as file:
        header = file.readline().strip()
        stored = np.loadtxt(file, delimiter=",")
    made = record(stand, kind)
    assert header == "time_s,force_N,displacement_m"
    assert stored.shape == made.shape
    assert np.abs(stored[:, 0] - made[:, 0]).max() < 1e-9
    # One step of the last digit, for a mathematics library that rounds differently.
    assert np.abs(stored[:, 1] - made[:, 1]).max() < 1.01 * QUANTUM["force"]
    assert np.abs(stored[:, 2] - made[:, 2]).max() < 1.01 * QUANTUM["displacement"]


def test_the_command_writes_the_same_bytes_twice(tmp_path, monkeypatch):
    monkeypatch.setattr("dashpot.examples.rig.KINDS", ("bursts",))
    main([str(tmp_path / "a")])
    main([str(tmp_path / "b")])
    for stand in STANDS:
        first, second = ((tmp_path / run / stand / "bursts.csv.gz").read_bytes() for run in "ab")
        assert first == second


def test_noise_has_the_stated_size():
    table = record("paper-stand", "bursts")
    pieces = force("bursts")
    assert np.std(table[:, 1] - pieces[:, 0]) == pytest.approx(FORCE_NOISE * 1.15, rel=0.03)
    assert np.std(table[:, 2] - paper_stand(pieces)) == pytest.approx(SENSOR_NOISE, rel=0.03)


@pytest.mark.parametrize("kind", KINDS)
def test_force_polynomials_join(kind):
    pieces = force(kind)
    ends = pieces.sum(axis=1)[:-1]
    assert np.abs(ends - pieces[1:, 0]).max() < 1e-11
    if kind != "bursts":
        slopes = (pieces * np.arange(pieces.shape[1])).sum(axis=1)[:-1]
        assert np.abs(slopes - pieces[1:, 1]).max() < 1e-11


def test_bursts_leave_decays_of_eight_to_nine_millimetres():
    x = paper_stand(force("bursts"))
    for start in range(0, 20_000, 5000):
        decay = x[start + 1500 : start + 5000]
        assert 8e-3 < np.abs(decay[:80]).max() < 9e-3
        assert np.all(decay[-100:] == 0.0)  # at rest on preload and friction before the next burst


def test_sweeps_run_from_5_to_20_hz():
    samples = force("sweep_high")[:, 0]
    crossings = np.nonzero((samples[:-1] < 0) & (samples[1:] >= 0))[0] * DT
    assert 1 / np.diff(crossings)[0] == pytest.approx(5.0, abs=0.1)
    assert 1 / np.diff(crossings)[-1] == pytest.approx(20.0, abs=0.5)


def test_unknown_stand_is_named():
    with pytest.raises(ValueError, match="paper-stand"):
        recordings("no-such-stand")

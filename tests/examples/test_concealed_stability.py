"""Recordings told a little differently, and how names that stay are counted."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.examples.concealed.make import write_recording
from dashpot.examples.concealed.scoreboard import page
from dashpot.examples.concealed.stability import CHANGES, samples_a_cycle, stability, stability_target
from dashpot.recording import read

FS, N = 800.0, 1600
T = np.arange(N) / FS
NAMES = ["a.csv.gz", "b.csv.gz"]


def changed(folder, change: str, per_cycle: float = 50.0):
    table = np.column_stack([T + 0.1234567891, np.cos(T), 5e-3 * np.sin(2 * np.pi * FS / per_cycle * T)])
    for name in NAMES:
        write_recording(folder / name, table)
    order = CHANGES[change](folder, NAMES)
    return table, order, [read(folder / name) for name in NAMES]


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_keeps_the_numbers_and_tells_them_differently(tmp_path, change):
    table, order, recordings = changed(tmp_path, change)
    taken = {"shifted start": slice(5, None), "every second sample": slice(None, None, 2)}.get(change, slice(None))
    for recording in recordings:
        assert np.asarray(recording.response) == pytest.approx(table[taken, 2], rel=1e-6, abs=1e-9)
        assert np.asarray(recording.force) == pytest.approx(table[taken, 1], rel=1e-6)
        assert recording.fs == pytest.approx(FS / (2 if change == "every second sample" else 1), rel=1e-6)
    assert order == (NAMES[::-1] if change == "order of the files" else NAMES)


def test_the_clock_loses_three_digits(tmp_path):
    import gzip

    changed(tmp_path, "clock's last digits")
    first = gzip.decompress((tmp_path / NAMES[0]).read_bytes()).decode().splitlines()[1]
    assert first.startswith("0.123457,")


def test_few_samples_are_not_thinned(tmp_path):
    assert samples_a_cycle(np.sin(2 * np.pi * T * 16.0 + 0.1)) == pytest.approx(50.0, rel=0.02)
    table, _, recordings = changed(tmp_path, "every second sample", per_cycle=30.0)
    assert len(np.asarray(recordings[0].response)) == len(table)


def test_names_that_stay_are_counted_for_each_change_and_all(tmp_path):
    rigs = ["rig_001", "rig_002", "rig_003"]

    def diagnosed(folder, rig, *names, verdict="missing-physics"):
        (folder / rig).mkdir(parents=True)
        effects = [{"effect": name, "odds": 9.0} for name in names]
        content = {"verdict": verdict, "effects": effects, "fit": {"holdout": []}}
        (folder / rig / "diagnosis.json").write_text(json.dumps(content))

    for rig in rigs:
        diagnosed(tmp_path / "results", rig, "stribeck")
        for change in CHANGES:
            if (rig, change) == ("rig_002", "shifted start"):
                diagnosed(tmp_path / "changed" / change, rig, "clearance")
            elif (rig, change) == ("rig_001", "order of the files"):
                diagnosed(tmp_path / "changed" / change, rig, "stribeck", verdict="unexplained")
            elif rig != "rig_003":
                diagnosed(tmp_path / "changed" / change, rig, "stribeck")
    diagnosed(tmp_path / "changed" / "clock's last digits", "rig_003", "stribeck")
    found = stability(tmp_path / "results", tmp_path / "changed", rigs)
    counted = {change: (row["right"], row["of"]) for change, row in found["changes"].items()}
    assert counted == {
        "clock's last digits": (3, 3),
        "order of the files": (1, 2),
        "shifted start": (1, 2),
        "every second sample": (2, 2),
    }
    assert (found["all"]["right"], found["all"]["of"]) == (1, 3)
    (line,) = stability_target(found)
    assert (line["value"], line["met"]) == (pytest.approx(1 / 3), False)
    board = {"rigs": [], "seed": 1, "scale": "nominal", "targets": [line], "singles": None, "rows": []}
    html = page(board | {"recorded": [], "calibration": [], "dirty": None, "stability": found})
    assert '<td>shifted start</td><td class="n">1</td><td class="n">2</td>' in html

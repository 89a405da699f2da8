"""The seal, the score and its page, on truths and diagnoses made by hand."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import pytest
from dashpot.examples.concealed.answer import read_answer
from dashpot.examples.concealed.score import score, summary
from dashpot.examples.concealed.scoreboard import page
from dashpot.examples.concealed.seal import SealBroken, open_sealed, seal, sha256

FLOOR = 0.01


def concealed(kind: str, *effects: str, twins: tuple[str, ...] = ()) -> dict[str, Any]:
    records = {name: {"noise_floor": FLOOR} for name in ("sweep_high", "holdout_multisine", "holdout_sweep")}
    variants = ["" for _ in effects]
    return {"kind": kind, "effects": [*effects], "variants": variants, "twins": [*twins], "recordings": records}


def suite(*rigs: dict[str, Any], scale: str = "nominal") -> dict[str, Any]:
    return {"seed": 1, "scale": scale, "rigs": {f"rig_{i:03d}": rig for i, rig in enumerate(rigs, start=1)}}


def said(
    *effects: str | tuple[str, ...], verdict: str = "", after: float = FLOOR, odds: float = 1e4, **more: Any
) -> dict[str, Any]:
    """A diagnosis; an effect with its group is a tuple that begins with the effect."""
    groups = [effect if isinstance(effect, tuple) else (effect,) for effect in effects]
    held = ("holdout_multisine.csv.gz", after), ("/somewhere/holdout_sweep.csv.gz", FLOOR)
    rows = [{"file": file, "nrmse_before": 0.2, "nrmse_after": value, "noise_floor": 0.5} for file, value in held]
    return {
        "format": "dashpot-diagnosis/1",
        "verdict": verdict or ("missing-physics" if effects else "consistent"),
        "effects": [{"effect": first, "indistinguishable_from": rest, "odds": odds} for first, *rest in groups],
        "fit": {"train": [], "holdout": rows},
    } | more


def scored(folder: Path, truth: dict[str, Any], *answers: dict[str, Any] | None) -> dict[str, Any]:
    for name, answer in zip(truth["rigs"], answers, strict=True):
        if answer is not None:
            (folder / name).mkdir()
            (folder / name / "diagnosis.json").write_text(json.dumps(answer))
    return score(truth, folder)


def reached(board: dict[str, Any]) -> dict[str, tuple[float, bool]]:
    return {target["target"]: (target["value"], target["met"]) for target in board["targets"]}


FIRST, ALONE, GROUP = "effect named first", "effect named first and alone", "effect in the group named"
CLOSE, ALARMS = "held-out NRMSE within 1.03 noise floors, of those named", "false alarms where nothing is missing"
SURE = "right, of what is named with more than 95 %"
OPEN, SMALL = "other physics left unexplained", "small effects found, alone or in a group"


def test_the_seal_opens_with_its_hash_only(tmp_path):
    path, truth = tmp_path / "truth.sealed", suite(concealed("none"))
    known = seal(path, truth)
    assert known == sha256(path)
    assert open_sealed(path, known) == truth
    assert seal(tmp_path / "again", truth) == known
    changed = json.loads(gzip.decompress(path.read_bytes())) | {"seed": 2}
    path.write_bytes(gzip.compress(json.dumps(changed).encode(), mtime=0))
    with pytest.raises(SealBroken, match="changed after the suite was made"):
        open_sealed(path, known)


def test_the_perfect_diagnosis_meets_every_target(tmp_path):
    truth = suite(
        concealed("single", "stribeck"),
        concealed("none"),
        concealed("open", "sensor-play"),
        concealed("open", "rattling-mass"),
        concealed("two", "clearance", "quadratic-drag"),
    )
    open_answers = said(verdict="unexplained"), said("hysteresis", remainder="an even harmonic")
    board = scored(
        tmp_path,
        truth,
        said("stribeck"),
        said(),
        *open_answers,
        said("quadratic-drag", ("two-sided-stop", "clearance")),
    )
    expected = ((FIRST, 1), (ALONE, 1), (GROUP, 1), (CLOSE, 1), (SURE, 1), (ALARMS, 0), (OPEN, 1))
    assert reached(board) == {name: (value, True) for name, value in expected}
    rows = {row["name"]: row for row in board["rows"]}
    assert rows["stribeck"]["strict"] == rows["stribeck"]["alone"] == rows["stribeck"]["group"] == 1
    assert rows["stribeck"]["held_out"] == {"before": pytest.approx(20), "after": pytest.approx(1), "close": 1}
    assert rows["two effects"]["both"] == 1
    assert rows["physics of no list"]["unexplained"] == 2


def test_the_wrong_diagnosis_misses_every_target(tmp_path):
    truth = suite(
        concealed("single", "stribeck"),
        concealed("none"),
        concealed("open", "sensor-play"),
        concealed("two", "clearance", "quadratic-drag"),
        concealed("single", "sensor-lag"),
    )
    board = scored(
        tmp_path,
        truth,
        said("cubic-damping", ("hysteresis", "stribeck")),
        said("sensor-offset"),
        said("hysteresis", remainder=None),
        said("quadratic-drag", "sensor-lag"),
        said(("sensor-lag", "time-delay"), after=0.02),
    )
    # sensor-lag is the first named on one of the two rigs, with a rival; three of the six that were named are right
    expected = ((FIRST, 0.5), (ALONE, 0), (GROUP, 0.5), (CLOSE, 0), (SURE, 0.5), (ALARMS, 1), (OPEN, 0))
    assert reached(board) == {name: (value, False) for name, value in expected}
    rows = {row["name"]: row for row in board["rows"]}
    assert rows["stribeck"]["missed"] == rows["stribeck"]["more_named"] == 1
    assert rows["stribeck"]["group"] == 0  # the second effect's group does not count
    assert (rows["two effects"]["both"], rows["two effects"]["one"]) == (0, 1)
    assert rows["sensor-lag"]["alone"] == 0
    assert rows["sensor-lag"]["held_out"]["after"] == pytest.approx(2)  # the worse of the two records


def test_the_calibration_counts_what_was_said_with_each_probability(tmp_path):
    truth = suite(*(concealed("single", "stribeck") for _ in range(4)), concealed("open", "x"))
    answers = [said("stribeck", odds=1e4), said("clearance", odds=30.0), said(("clearance", "stribeck"), odds=30.0)]
    curve = scored(tmp_path, truth, *answers, said("stribeck", odds=3.0), said("stribeck", odds=30.0))["calibration"]
    assert curve == [
        {"above": 0.5, "below": 0.9, "named": 1, "right": 1},
        {"above": 0.95, "below": 0.99, "named": 2, "right": 1},
        {"above": 0.999, "below": 1.0, "named": 1, "right": 1},
    ]


def test_a_group_is_a_hit_of_its_own_kind(tmp_path):
    truth = suite(
        concealed("single", "constant-force", twins=("asymmetric-friction",)), concealed("single", "clearance")
    )
    board = scored(tmp_path, truth, said(("asymmetric-friction", "constant-force")), said("two-sided-stop"))
    first, second = board["rigs"]
    assert (first["strict"], first["group"], first["twin"]) == (False, True, True)
    assert (second["strict"], second["group"], second["twin"]) == (False, False, False)
    assert board["singles"]["twin"] == 1


def test_missing_and_broken_diagnoses_count_as_misses(tmp_path):
    truth = suite(concealed("single", "stribeck"), concealed("single", "stribeck"), concealed("none"))
    answers = said("stribeck"), None, {"verdict": "consistent", "effects": None}
    board = scored(tmp_path, truth, *answers)
    assert board["singles"]["failed"] == 1
    assert reached(board)[FIRST] == (0.5, False)
    problems = [rig["answer"]["problem"] for rig in board["rigs"]]
    assert problems[:2] == ["", "no diagnosis.json"]
    assert problems[2].startswith("diagnosis.json cannot be read: TypeError")
    (tmp_path / "d.json").write_text(json.dumps(said("stribeck", after=float("nan"))))
    assert "nan is no positive number" in read_answer(tmp_path / "d.json").problem
    (tmp_path / "d.json").write_text("{")
    assert "JSONDecodeError" in read_answer(tmp_path / "d.json").problem


def test_small_rigs_have_a_target_of_their_own(tmp_path):
    truth = suite(concealed("single", "stribeck"), concealed("single", "sensor-lag"), scale="small")
    board = scored(tmp_path, truth, said(("time-delay", "sensor-lag")), said(("time-delay", "sensor-lag")))
    assert reached(board) == {SMALL: (0.5, True)}


def test_the_page_shows_every_rig_and_needs_nothing_else(tmp_path):
    truth = suite(
        concealed("single", "stribeck"),
        concealed("none"),
        concealed("two", "clearance", "sensor-lag"),
        concealed("open", "x"),
    )
    board = scored(tmp_path, truth, said("<b>"), None, said("clearance"), said(verdict="unexplained"))
    board["recorded"] = [
        {
            "name": "a stand",
            "verdict": "missing-physics",
            "laws": ["viscoelastic"],
            "records": [["sweep", True, 0.123, 0.0456, 0.01], ["multisine", False, None, 0.02, 0.01]],
            "tests": [["test arrow", 5.4, 0.26, "mV"]],
            "seconds": 12.0,
        }
    ]
    html = page(board, "0123abcd")
    for words in (
        "rig_001",
        "rig_004",
        "missed",
        "failed",
        "one found",
        "left unexplained",
        "0123abcd",
        "&lt;b&gt;",
        "12.30 %",
        "0.26 mV",
    ):
        assert words in html
    assert "<b>" not in html
    assert not any(word in html for word in ("http", "<script", "<link", "src="))
    lines = summary(board)
    assert "missed effect named first and alone: 0 % (target 92 %)" in lines
    assert "1 rigs with two effects: both found in 0, one in 1" in lines

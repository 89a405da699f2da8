"""The score of dirty rigs on outcomes made by hand, where every figure is known."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from dashpot.examples.concealed.dirty_score import share
from dashpot.examples.concealed.score import score, summary
from dashpot.examples.concealed.scoreboard import page

LAW = 0.05  # held-out NRMSE of the exact law


def rig(*effects: str, own: tuple[str, ...] = (), experiment: str = "shaker") -> dict[str, Any]:
    records = {name: {"noise_floor": 0.01, "reachable": LAW} for name in ("holdout_multisine", "holdout_sweep")}
    dirt = {"imperfections": [{"name": "lens"}, {"name": "sway"}], "own": [*own], "left_over_noise": 5.0, "share": 0.8}
    return {
        "kind": "single" if effects else "none",
        "effects": [*effects],
        "variants": ["" for _ in effects],
        "twins": [],
        "experiment": experiment,
        "quantity": "displacement",
        "dirt": dirt,
        "recordings": records | {"sweep_high": {"noise_floor": 0.01}},
    }


def said(*effects: str | tuple[str, ...], chance: float = 0.9, after: float = LAW) -> dict[str, Any]:
    groups = [effect if isinstance(effect, tuple) else (effect,) for effect in effects]
    rows = [("holdout_multisine.csv.gz", after), ("holdout_sweep.csv.gz", LAW)]
    return {
        "verdict": "missing-physics" if effects else "consistent",
        "effects": [{"effect": e, "indistinguishable_from": rest, "probability": chance} for e, *rest in groups],
        "fit": {"holdout": [{"file": file, "nrmse_before": 0.2, "nrmse_after": value} for file, value in rows]},
    }


def scored(folder: Path, *pairs: tuple[dict[str, Any], dict[str, Any] | None]) -> dict[str, Any]:
    rigs = {f"rig_{i:03d}": truth for i, (truth, _) in enumerate(pairs, start=1)}
    for name, (_, answer) in zip(rigs, pairs, strict=True):
        if answer is not None:
            (folder / name).mkdir()
            (folder / name / "diagnosis.json").write_text(json.dumps(answer))
    return score({"seed": 1, "scale": "nominal", "dirty": len(rigs), "rigs": rigs}, folder)


def figures(board: dict[str, Any]) -> dict[str, tuple[int, int]]:
    return {key: (one["right"], one["of"]) for key, one in board["dirty"]["figures"].items()}


def test_a_share_has_its_binomial_error():
    assert share(80, 100)["share"] == 0.8
    assert share(80, 100)["error"] == pytest.approx(0.04, rel=0.02)
    assert share(0, 100)["error"] == pytest.approx(0.007, rel=0.02)  # no certainty of a hundred
    assert share(0, 0)["share"] is None


def test_first_alone_and_in_the_group(tmp_path):
    drag = rig("quadratic-drag", own=("hysteresis",))
    board = scored(
        tmp_path,
        (drag, said("quadratic-drag")),
        (drag, said("quadratic-drag", "hysteresis")),  # the dirt's own law is there
        (drag, said("quadratic-drag", "stribeck")),
        (drag, said(("quadratic-drag", "cubic-damping"))),
        (drag, said(("cubic-damping", "quadratic-drag"))),
        (drag, said("hysteresis")),
        (drag, said()),
        (drag, None),
    )
    assert figures(board)["first"] == (4, 8)
    assert figures(board)["alone"] == (2, 8)
    assert figures(board)["group"] == (5, 8)
    assert board["dirty"]["rigs"]["rig_003"]["false_names"] == ["stribeck"]
    assert board["dirty"]["rigs"]["rig_002"]["false_names"] == []
    rows = board["dirty"]["confusion"]
    assert dict(zip(rows["said"], rows["rows"]["quadratic-drag"], strict=True)) == {
        "quadratic-drag": 4,
        "cubic-damping": 1,
        "hysteresis": 1,
        "consistent": 1,
        "failed": 1,
    }


def test_where_there_is_dirt_alone_only_its_own_law_or_a_shape_may_be_named(tmp_path):
    nothing = rig(own=("stiffness-drift",))
    answers = [
        said("stiffness-drift"),
        said("free/x-v"),
        said("stribeck"),
        said(("stiffness-drift", "clearance")),
        said(),
    ]
    board = scored(tmp_path, *((nothing, answer) for answer in answers))
    assert figures(board)["false"] == (2, 5)
    assert figures(board)["first"] == (0, 0)
    by_name = {target["target"]: target for target in board["targets"]}
    one = by_name["a false name where there is dirt alone"]
    assert (one["value"], one["met"]) == (0.4, False)
    assert "effect named first" not in by_name


def test_held_out_is_held_against_the_exact_law_in_the_worse_recording(tmp_path):
    drag = rig("quadratic-drag")
    pairs = [(drag, said("quadratic-drag", after=after)) for after in (LAW, 1.29 * LAW, 1.31 * LAW)]
    board = scored(tmp_path, *pairs, (drag, None))
    assert figures(board)["reached"] == (2, 4)
    assert board["dirty"]["rigs"]["rig_003"]["reached"] == pytest.approx(1.31)
    assert board["dirty"]["rigs"]["rig_001"]["reached"] == pytest.approx(1.0)
    assert board["dirty"]["rigs"]["rig_004"]["reached"] is None


def test_reliability_has_five_bins_with_as_many_names_each(tmp_path):
    drag = rig("quadratic-drag")
    pairs = []
    for i in range(50):  # stated 0.50 to 0.99; right in 0, 2, 5, 8, 10 of ten
        right = i % 10 < (0, 2, 5, 8, 10)[i // 10]
        pairs.append((drag, said("quadratic-drag" if right else "stribeck", chance=0.5 + i / 100)))
    board = scored(tmp_path, *pairs)
    bins = board["dirty"]["reliability"]
    assert [part["right"] for part in bins] == [0, 2, 5, 8, 10]
    assert [part["of"] for part in bins] == [10] * 5
    assert [part["stated"] for part in bins] == pytest.approx([0.545, 0.645, 0.745, 0.845, 0.945])
    assert board["dirty"]["figures"]["reliable"]["share"] == pytest.approx(0.545)  # of the first
    assert figures(board)["sure"] == (4, 4)  # above 0.95


def test_twins_and_own_laws_are_right_and_shapes_do_not_count(tmp_path):
    load = rig("constant-force") | {"twins": ["asymmetric-friction"]}
    drag = rig("quadratic-drag", own=("hysteresis",))
    board = scored(
        tmp_path,
        (load, said("asymmetric-friction", chance=0.96)),
        (drag, said("hysteresis", chance=0.97)),
        (drag, said("free/x", chance=0.98)),
        (drag, said("clearance", chance=0.99)),
    )
    assert figures(board)["sure"] == (2, 3)


def test_the_page_and_the_summary_show_it(tmp_path):
    board = scored(
        tmp_path,
        *((rig("quadratic-drag", experiment=e), said("quadratic-drag")) for e in ("shaker", "shaker", "hammer")),
        (rig(), said("stribeck")),
    )
    text = summary(board)
    assert "met    effect named first: 100 ± 17 % (target 80 %)" in text
    assert "missed a false name where there is dirt alone: 100 ± 31 % (at most 3 %)" in text
    assert "right in" in text
    html = page(board, "f00")
    assert html.count("<circle") == len(board["dirty"]["reliability"])
    assert re.search(r"<td>hammer, displacement</td><td class=\"n\">1 of 1</td>", html)
    assert "lens, sway" in html
    assert "Reliability" not in page({**board, "dirty": None}, "f00")

"""``dashpot hilbert``: curves, laws and page from recordings, as a program and a person read them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from dashpot.cli import main
from dashpot.examples import recordings
from dashpot.examples.truth import TRUTH
from dashpot.hilbert import FILES


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hilbert") / "curves"
    main(["hilbert", str(recordings("paper-stand")["bursts"]), "-o", str(folder)])
    return folder


def refuse(constant: str) -> None:
    raise ValueError(f"{constant} is no JSON")


def test_all_files_are_written(folder):
    assert sorted(path.name for path in folder.iterdir()) == sorted(FILES)


def test_the_laws_are_the_stands(folder):
    """Eqs. 6 and 7 of FREEVIB, and FORCEVIB's mass; in strict JSON."""
    found = json.loads((folder / "hilbert.json").read_text("utf-8"), parse_constant=refuse)
    both = {}
    for law in found["freevib"]["laws"]:
        both |= law["parameters"]
    for name, within in (("omega0", 1e-4), ("viscous", 1e-3), ("preload", 5e-3), ("dry", 0.02), ("cubic", 0.05)):
        assert both[name]["value"] == pytest.approx(TRUTH[name], rel=within), name
        assert 0.0 < both[name]["std"] < within * TRUTH[name]
    mass = found["forcevib"]["mass"]
    assert abs(mass["value"] - TRUTH["mass"]) < 2 * mass["std"] < 0.01 * TRUTH["mass"]


def test_the_curves_keep_their_time(folder):
    """Four decays; A falls as viscous friction has it, but for the dry friction at the end."""
    table = np.genfromtxt(folder / "curves.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    free = table[table["method"] == "freevib"]
    assert sorted(set(free["stretch"])) == [1, 2, 3, 4] or len(set(free["stretch"])) == 4
    first = free[free["stretch"] == free["stretch"][0]]
    loud = first[first["amplitude_m"] > 1.5e-3]
    rate = np.polyfit(loud["time_s"], np.log(loud["amplitude_m"]), 1)[0]
    assert rate == pytest.approx(-0.5 * TRUTH["viscous"], rel=0.02)
    assert np.all(np.diff(first["phase_rad"]) > 0)
    assert first["decrement"][0] == pytest.approx(
        2 * math.pi * 2.5 / (2 * math.pi * first["frequency_Hz"][0]), rel=0.05
    )


def test_what_cannot_be_evaluated_is_refused_and_nothing_written(tmp_path, capsys):
    record = tmp_path / "noise.csv"
    noise = np.random.default_rng(1).standard_normal(4000)
    rows = "\n".join(f"{i / 500:.3f},{y:.6f}" for i, y in enumerate(noise))
    record.write_text(f"time_s,displacement_m\n{rows}\n", "utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["hilbert", str(record), "-o", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert capsys.readouterr().err.startswith("dashpot: ")
    assert not (tmp_path / "out").exists() or not any((tmp_path / "out").iterdir())

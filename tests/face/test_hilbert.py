"""``dashpot hilbert``: curves, laws and page from recordings, as a program and a person read them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from dashpot.commands.cli import main
from dashpot.errors import BadInput
from dashpot.examples import recordings
from dashpot.examples.truth import TRUTH
from dashpot.face.hilbert import FILES, run
from dashpot.recording import Recording


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


def test_every_mode_by_itself_with_the_share_left_aside(tmp_path, capsys):
    """Each of two modes has its own frequency and damping."""
    t = np.arange(8000) / 1000
    modes = ((12.0, 0.9, 4e-3), (47.0, 1.6, 1.5e-3))
    x = sum(a * np.exp(-h * t) * np.cos(2 * np.pi * f * t) for f, h, a in modes)
    x = x + 1e-6 * np.random.default_rng(5).standard_normal(t.size)
    record, out = tmp_path / "decay.csv", tmp_path / "out"
    np.savetxt(record, np.column_stack([t, x]), delimiter=",", header="time_s,x_m", comments="")
    main(["hilbert", str(record), "-o", str(out), "--mode", "all", "--json"])
    told = json.loads(capsys.readouterr().out, parse_constant=refuse)
    assert [entry["mode"] for entry in told["modes"]] == [1, 2]
    assert 0 <= told["left_aside"] < 0.01
    for entry, (frequency, damping, _) in zip(told["modes"], modes, strict=True):
        assert sorted(path.name for path in (out / f"mode-{entry['mode']}").iterdir()) == sorted(FILES)
        law = {k: v["value"] for law in entry["freevib"]["laws"] for k, v in law["parameters"].items()}
        assert law["omega0"] == pytest.approx(np.hypot(2 * np.pi * frequency, damping), rel=1e-4)
        assert law["viscous"] == pytest.approx(2 * damping, rel=5e-3)
    powers = [a**2 / (4 * h) for _, h, a in modes]
    assert [entry["share"] for entry in told["modes"]] == pytest.approx(np.divide(powers, sum(powers)), abs=0.02)


def test_where_no_mode_can_be_evaluated_all_is_refused(tmp_path):
    still = Recording("ramp", 1000.0, np.linspace(0.0, 1e-3, 3000))
    with pytest.raises(BadInput, match="No mode can be evaluated by itself"):
        run([still], "all", tmp_path / "out", lambda _: None)
    assert not (tmp_path / "out").exists()

"""Virtual rigs: every effect is drawn, simulated and recorded; the same seed gives the same bytes."""

from __future__ import annotations

import ast
import gzip
from pathlib import Path

import numpy as np
import pytest
from dashpot.examples import concealed
from dashpot.examples.concealed import virtual
from dashpot.examples.concealed.effects import EFFECTS, SINGLE, UNLISTED
from dashpot.examples.concealed.make import main, make
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.recordings import EXPERIMENTS, run
from dashpot.examples.concealed.seal import NAME, open_sealed
from dashpot.examples.concealed.suite import COUNTS, Spec, specs
from dashpot.examples.concealed.virtual import draw
from dashpot.recording import read

SHORT = (40.0, 60.0)  # natural cycles
NOTHING = Spec("none", (), (), "white", 0)
DESIGN = {  # the names of the design's table
    *(
        "quadratic-stiffness",
        "quintic-stiffness",
        "softening-stiffness",
        "clearance",
        "one-sided-stop",
        "two-sided-stop",
    ),
    *("constant-force", "quadratic-drag", "cubic-damping", "displacement-dependent-damping", "stribeck"),
    *("asymmetric-friction", "hysteresis", "viscoelastic", "attached-resonator", "actuator-lag", "actuator-saturation"),
    *("actuator-dead-zone", "actuator-backlash", "sensor-lag", "sensor-nonlinearity", "sensor-offset", "time-delay"),
    *("stiffness-drift", "tonal-disturbance"),
}
SINGLES = [Spec("single", (e.name,), (v,), "white", 0) for e in SINGLE.values() for v in e.variants]
OTHERS = [Spec("open", (name,), ("",), "white", 0) for name in UNLISTED]

TRAINING, RECORDINGS = EXPERIMENTS["shaker"].training, EXPERIMENTS["shaker"].recordings


def label(spec: Spec) -> str:
    return "-".join(word for word in (*spec.effects, *spec.variants) if word)


def test_every_effect_of_the_design_is_there():
    assert set(EFFECTS) == DESIGN
    assert not DESIGN & set(UNLISTED)


@pytest.mark.parametrize("spec", SINGLES + OTHERS, ids=label)
def test_every_effect_draws_a_rig_that_is_fit_for_a_test(spec):
    rig = draw(spec, 11, cycles=SHORT)
    tables, truth = record(rig)
    assert set(tables) == set(RECORDINGS)
    assert truth["effects"] == list(spec.effects)
    assert 0.5 < truth["recordings"]["sweep_high"]["amplitude_m"] / truth["working_amplitude_m"] < 2.0
    assert np.all(tables["ringdown"][:, 1] == 0.0)
    for name, table in tables.items():
        assert np.all(np.isfinite(table))
        error = np.sqrt(np.mean((table[:, 2] - rig.responses[name].shown) ** 2)) / table[:, 2].std()
        assert error == pytest.approx(truth["recordings"][name]["noise_floor"])
    base = {"mass": 1.0} | rig.base.parameters
    plain = [run(lambda *_: base, rig.base, name, rig.plans[name], rig.level).shown for name in TRAINING]
    difference = [np.mean((rig.responses[name].shown - x) ** 2) for name, x in zip(TRAINING, plain, strict=True)]
    assert np.sqrt(max(difference)) > rig.base.noise


@pytest.mark.parametrize("kind", ["white", "ar1", "pink", "quantised"])
def test_noise_has_the_stated_size(kind):
    rig = draw(Spec("none", (), (), kind, 0), 3, cycles=SHORT)
    tables, truth = record(rig)
    for name, table in tables.items():
        noise = table[:, 2] - rig.responses[name].shown
        if name != "ringdown" or kind != "quantised":  # a coarse converter shows no noise of a rig at rest
            assert np.sqrt(np.mean(noise**2)) == pytest.approx(rig.base.noise, rel=0.25)
    assert 0.001 <= rig.base.noise / rig.base.amplitude <= 0.005
    table = tables["sweep_high"]
    peak = np.abs(rig.responses["sweep_high"].force).max()
    assert np.std(table[:, 1] - rig.responses["sweep_high"].force) == pytest.approx(1e-3 * peak, rel=0.1)
    if kind == "quantised":
        steps = table[:, 2] / truth["noise"]["step"]
        assert np.abs(steps - steps.round()).max() < 1e-9
    if kind in {"ar1", "pink"}:
        assert np.corrcoef(noise[1:], noise[:-1])[0, 1] > 0.5


def test_bases_keep_their_ranges():
    rigs = [virtual.draw_base(np.random.default_rng(i)) for i in range(300)]
    frequencies = np.array([rig.omega for rig in rigs]) / (2 * np.pi)
    assert 3 <= frequencies.min() < 4
    assert 45 < frequencies.max() <= 60
    assert all(23.4 < rig.fs / f < 96 for rig, f in zip(rigs, frequencies, strict=True))
    assert all(285 < rig.length * f < 630 for rig, f in zip(rigs, frequencies, strict=True))
    for name in ("dry", "preload", "cubic"):
        values = np.array([rig.parameters[name] for rig in rigs])
        assert 0.03 < np.mean(values == 0) < 0.4
        assert np.abs(values / [rig.spring for rig in rigs]).max() <= (0.02 if name != "cubic" else np.inf)


def test_a_small_rig_is_the_nominal_one_with_a_fifth_of_the_effect():
    spec = Spec("single", ("clearance",), ("",), "white", 0)
    nominal, small = (draw(spec, 5, scale, SHORT).rig("ringdown", 1.0) for scale in ("nominal", "small"))
    assert small.pop("clearance_stiffness") == pytest.approx(nominal.pop("clearance_stiffness") / 5)
    assert small == nominal


def test_an_effect_that_cannot_be_seen_is_drawn_again(monkeypatch):
    monkeypatch.setattr(virtual, "VISIBLE", 1e6)
    with pytest.raises(RuntimeError, match="none of 3 rigs"):
        draw(SINGLES[0], 1, cycles=SHORT, attempts=3)


def test_the_phase_of_a_hum_differs_between_records():
    rig = draw(Spec("single", ("tonal-disturbance",), ("",), "white", 0), 1, cycles=SHORT)
    assert len({rig.rig(name, 1.0)["tone_phase"] for name in RECORDINGS}) == len(RECORDINGS)


def test_suites_have_what_they_promise():
    suite = specs(4)
    assert {kind: sum(spec.kind == kind for spec in suite) for kind in COUNTS} == COUNTS
    for name, effect in EFFECTS.items():
        mine = [spec for spec in suite if spec.kind == "single" and spec.effects == (name,)]
        assert len(mine) >= 2
        assert {spec.variants[0] for spec in mine} == set(effect.variants)
    assert {spec.noise for spec in suite if spec.kind == "none"} == {"white", "ar1", "pink", "quantised"}
    assert all(EFFECTS[a].path != EFFECTS[b].path for a, b in (s.effects for s in suite if s.kind == "two"))
    assert sorted(spec.effects[0] for spec in specs(4, scale="small")) == sorted(EFFECTS)
    assert specs(4) == suite
    assert specs(5) != suite
    assert specs(4, short=6) == suite[:6]
    with pytest.raises(ValueError, match="no kind of rig named friction"):
        specs(4, ["friction"])


def test_the_same_seed_gives_the_same_bytes_and_the_folder_tells_nothing(tmp_path):
    kinds = ["sensor-offset", "constant-force", "none"]
    hashes = [
        make(tmp_path / name, seed, kinds, 1, short=2, cycles=SHORT) for name, seed in (("a", 7), ("b", 7), ("c", 8))
    ]
    assert hashes[0] == hashes[1] != hashes[2]
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*") if path.is_file())
    expected = [Path(f"rig_00{i}", f"{name}.csv.gz") for i in (1, 2) for name in RECORDINGS]
    assert files == sorted([*expected, Path(NAME)])
    for path in files:
        assert (tmp_path / "a" / path).read_bytes() == (tmp_path / "b" / path).read_bytes()
    truth = open_sealed(tmp_path / "a" / NAME, hashes[0])
    assert set(truth["rigs"]) == {"rig_001", "rig_002"}
    with gzip.open(tmp_path / "a/rig_001/sweep_high.csv.gz", "rt") as file:
        assert file.readline() == "time_s,force_N,displacement_m\n"
        table = np.loadtxt(file, delimiter=",")
    rig = truth["rigs"]["rig_001"]
    assert np.abs(np.diff(table[:, 0]) * rig["fs_hz"] - 1).max() < 1e-4
    assert np.ptp(table[:, 2]) / 2 == pytest.approx(rig["recordings"]["sweep_high"]["amplitude_m"], rel=0.1)


def test_the_command_says_what_is_wrong(tmp_path, capsys):
    assert main([str(tmp_path), "--kinds", "friction"]) == 2
    assert "no kind of rig named friction" in capsys.readouterr().err
    (tmp_path / "mine.txt").write_text("mine")
    assert main([str(tmp_path), "--kinds", "none"]) == 2
    assert "not empty" in capsys.readouterr().err


def test_the_rigs_share_no_code_with_the_product():
    folder = Path(concealed.__file__).parent
    allowed = {"__future__", "numpy", "jinja2"}
    for path in folder.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                assert node.level <= 1, f"{path.name}:{node.lineno} imports from outside"
                names = [str(node.module)] if node.level == 0 else []
            for name in names:
                top = name.split(".")[0]
                assert top in allowed or top in __import__("sys").stdlib_module_names, f"{path.name} imports {name}"


@pytest.mark.parametrize("experiment", ["hammer", "random"])
@pytest.mark.parametrize("sensor", ["displacement", "acceleration"])
def test_rigs_are_also_tried_by_hammer_and_at_random_with_either_sensor(tmp_path, experiment, sensor):
    make(tmp_path, 3, ["none"], short=1, cycles=SHORT, trial=virtual.Trial(experiment, sensor))
    files = {path.name.removesuffix(".csv.gz"): path for path in (tmp_path / "rig_001").iterdir()}
    assert set(files) == set(EXPERIMENTS[experiment].recordings)
    recordings = {name: read(path) for name, path in files.items()}
    assert {recording.quantity for recording in recordings.values()} == {sensor}
    forces = {name: np.asarray(r.force) for name, r in recordings.items() if r.force is not None}
    strong, weak = EXPERIMENTS[experiment].training[:2]
    assert np.max(forces[strong]) > 1.5 * np.max(forces[weak])
    if experiment == "hammer":  # hits that push, with rest between
        assert min(force.min() / force.max() for force in forces.values()) > -0.02
        assert all(np.mean(force > 0.1 * force.max()) < 0.02 for force in forces.values())
    else:
        assert abs(np.mean(forces[strong] ** 4) / np.mean(forces[strong] ** 2) ** 2 - 3.0) < 0.7  # nearly Gaussian


def test_a_sweep_held_out_has_its_part_of_the_strong_ones_force_whichever_way_it_runs():
    """Linear or logarithmic, one of them either: the level was set on the strong sweep."""
    kinds = set()
    for number in range(14):
        rig = draw(Spec("none", (), (), "white", number), 12, cycles=SHORT)
        strong, last = (rig.plans[name].drive for name in ("sweep_high", "holdout_sweep"))
        assert 0.5 <= last.peak / strong.peak <= 0.8
        kinds.add(strong.kind == last.kind)
    assert kinds == {True, False}

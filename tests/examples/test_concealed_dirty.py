"""Dirty rigs: every experiment in turn, the exact law's remainder in its range, the seal, and going on after a stop."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from dashpot.examples.concealed import dirty, make
from dashpot.examples.concealed.base import Base
from dashpot.examples.concealed.dirty import IMPERFECTIONS, LEAST, MOST, SHARE, TRIALS, candidate, draw_dirty
from dashpot.examples.concealed.engine import Drive, simulate
from dashpot.examples.concealed.exact_law import Dirty, exact_law, left, without_effect
from dashpot.examples.concealed.pace import remaining
from dashpot.examples.concealed.record import record
from dashpot.examples.concealed.recordings import _stops, run
from dashpot.examples.concealed.seal import NAME, open_sealed
from dashpot.examples.concealed.suite import Spec
from dashpot.examples.concealed.virtual import Trial, draw
from dashpot.recording import read

SHORT = (30.0, 40.0)  # natural cycles
W, A, FS, N = 2 * np.pi * 10.0, 5e-3, 800.0, 4000
PLAIN = {"mass": 2.0, "omega2": W**2, "viscous": 0.1 * W, "omega": W, "amplitude": A, "force": W**2 * A}


def test_a_force_that_is_not_recorded_moves_the_mass_as_one_that_is():
    force = np.cumsum(np.random.default_rng(1).normal(size=N))
    lines = np.column_stack([force, np.diff(force, append=force[-1])])
    driven = simulate(PLAIN, Drive("straight", 1.0, ramp=0.0, lines=lines), 0.0, FS, N)
    hidden = simulate(PLAIN, Drive("none"), 0.0, FS, N, rest=force)
    assert np.abs(hidden.x - driven.x).max() < 1e-9 * np.abs(driven.x).max()
    assert np.abs(driven.force - force).max() < 1e-12 * np.abs(force).max()
    assert not hidden.force.any()


def test_a_hand_is_a_spring_and_a_damper_from_its_time_on():
    """Grasped long ago it is the linear rig that both make together: closed form, with what force it leans on."""
    hand = {"hand_at": -1.0, "hand_damping": 0.2 * W, "hand_stiffness": 0.5 * W**2, "hand_place": 0.3 * A}
    x = simulate(PLAIN | hand, Drive("none"), A, FS, N).x
    rate, omega, rest = 0.15 * W, W * np.sqrt(1.5 - 0.15**2), 0.1 * A
    t = np.arange(N) / FS
    exact = rest + (A - rest) * np.exp(-rate * t) * (np.cos(omega * t) + rate / omega * np.sin(omega * t))
    assert np.abs(x - exact).max() < 1e-9 * A


def test_every_experiment_comes_in_turn_and_every_fourth_rig_has_nothing_but_dirt():
    drawn = [candidate(5, number, 0) for number in range(2 * len(TRIALS) * 4)]
    assert set(Counter((trial.experiment, trial.quantity) for _, trial in drawn).values()) == {8}
    assert sum(spec.kind == "none" for spec, _ in drawn) == len(drawn) / 4
    assert len({spec.effects for spec, _ in drawn}) > 20
    undriven = {spec.effects[0] for spec, trial in drawn if spec.effects and trial.experiment == "decays"}
    assert not {name for name in undriven if name.startswith("actuator") or name in ("sensor-lag", "time-delay")}
    assert candidate(5, 1, 4)[0].effects != candidate(5, 1, 0)[0].effects == candidate(5, 1, 3)[0].effects


@pytest.mark.parametrize(
    "number", [0, 3, pytest.param(1, marks=pytest.mark.long), pytest.param(2, marks=pytest.mark.long)]
)
def test_a_dirty_rig_is_what_its_truth_says(number):
    rig = draw_dirty(3, number, SHORT)
    assert rig.dirt is not None
    assert 2 <= len(rig.dirt["imperfections"]) <= 4
    assert LEAST <= rig.dirt["left_over_noise"] <= MOST
    assert rig.spec.kind == ("none" if number == 3 else "single")
    assert rig.dirt["share"] is None if number == 3 else rig.dirt["share"] >= SHARE
    for one in rig.dirt["imperfections"]:
        row = IMPERFECTIONS[one["name"]]
        assert row.low <= one["size"] <= row.high
        assert not set(rig.spec.effects) & set(row.own)
    tables, truth = record(rig)
    assert set(tables) == set(rig.trial.plan.recordings)
    for name in rig.trial.plan.held_out:
        found = truth["recordings"][name]
        assert found["reachable"] > found["noise_floor"]
    again = record(draw_dirty(3, number, SHORT))[0]
    assert all(np.array_equal(tables[name], again[name]) for name in tables)


def test_decays_are_held_released_and_recorded_without_a_force(tmp_path):
    clean = draw(Spec("none", (), (), "white", 0), 3, cycles=SHORT, trial=Trial("decays", "displacement"))
    rig = dirty.soil(clean)
    assert rig.dirt is not None
    tables, _ = record(rig)
    for name, table in tables.items():
        held = rig.dirt["held"][name]
        assert table.shape == (clean.plans[name].samples + held, 2)
        assert np.ptp(rig.responses[name].shown[:held]) == 0.0
        assert held / clean.base.fs * clean.base.omega / (2 * np.pi) == pytest.approx(7.5, abs=4.7)
    path = tmp_path / "release_high.csv.gz"
    make.write_recording(path, tables["release_high"])
    assert read(path).force is None


def test_the_exact_law_leaves_nothing_of_a_clean_rig_and_what_it_cannot_explain_of_another():
    """Gain, clock and zero are the parameters' own; a tone in the sensor stays whole."""
    clean = draw(Spec("none", (), (), "white", 0), 7, cycles=SHORT)
    law, noise = exact_law(clean, clean.rig), clean.base.noise
    training = clean.trial.plan.training
    records = {name: Dirty(clean.responses[name], None, clean.plans[name].samples) for name in training}
    assert left(law, records, noise).rms < 1e-6 * noise

    def changed(change):
        return {
            name: replace(one, response=replace(one.response, shown=change(one.response.shown)))
            for name, one in records.items()
        }

    assert left(law, changed(lambda x: 1.003 * x + 20 * noise), noise).rms < 0.5 * noise
    size = 10 * noise * np.sqrt(2)
    tone = changed(lambda x: x + size * np.sin(0.31 * clean.base.omega * np.arange(len(x)) / clean.base.fs))
    found = left(law, tone, noise).rms / noise
    assert 5.0 < found < 10.1


def test_the_exact_law_follows_what_its_parameters_can_take():
    clean = draw(Spec("single", ("quadratic-drag",), ("",), "white", 0), 7, cycles=SHORT)
    law, noise = exact_law(clean, clean.rig), clean.base.noise
    other = {"omega2": 1.003, "mass": 1.01, "drag": 1.05}

    def rig(name: str, level: float) -> dict[str, float]:
        values = clean.rig(name, level)
        return values | {key: values[key] * factor for key, factor in other.items()}

    records = {}
    for name in clean.trial.plan.training:
        response = run(rig, clean.base, name, clean.plans[name], clean.level)
        records[name] = Dirty(response, None, len(response.shown))
    off = np.sqrt(
        np.mean([np.mean((one.response.shown - clean.responses[n].shown) ** 2) for n, one in records.items()])
    )
    found = left(law, records, noise)
    assert found.rms < 0.1 * noise < 0.1 * off
    changes = dict(zip(law.names, found.changes, strict=True))
    assert {key: changes[key] for key in other} == pytest.approx({k: v - 1 for k, v in other.items()}, abs=3e-3)
    base = exact_law(clean, without_effect(clean))
    assert "drag" not in base.names
    assert left(base, dirty._clean(clean), noise).rms > 3 * noise


def test_dirty_suites_go_on_where_they_stopped_and_are_the_same(tmp_path, capfd, monkeypatch):
    folder, seed = tmp_path / "a", 4
    (folder / "parts").mkdir(parents=True)
    make._one_dirty(folder, seed, 0, SHORT)
    before = (folder / "parts/rig_001.json").read_text()
    digest = make.make_dirty(folder, seed, 2, SHORT)
    said = capfd.readouterr().err
    assert "rig_002 made, none left" in said
    assert "rig_001" not in said
    truth = open_sealed(folder / NAME, digest)
    assert truth["dirty"] == 2
    assert set(truth["rigs"]) == {"rig_001", "rig_002"}
    assert truth["rigs"]["rig_001"]["dirt"]["imperfections"][0]["name"] in before
    assert {path.name for path in folder.iterdir()} == {"rig_001", "rig_002", NAME}
    with pytest.raises(FileExistsError, match="not empty"):
        make.make_dirty(folder, seed, 2, SHORT)


def test_the_time_that_is_left_comes_with_its_range():
    assert remaining([60.0], 10, 2) == "10 left"
    assert remaining([60.0] * 4, 0, 2) == "none left"
    assert remaining([60.0] * 4, 10, 2) == "10 left, about 5 min (5 to 5)"
    assert remaining([30.0, 90.0, 30.0, 90.0], 100, 2) == "100 left, about 50 min (21 to 79)"


def test_a_recording_of_a_decay_ends_where_dry_friction_has_stopped_the_rig():
    for zeta, dry in ((0.01, 0.01), (0.005, 0.02), (0.04, 0.002)):
        values = PLAIN | {"viscous": 2 * zeta * W, "dry": dry * W**2 * A}
        base = Base(W, A, zeta, values, FS, 10.0, 1e-5)
        x = simulate(values, Drive("none"), 0.7 * A, FS, N).x
        assert np.flatnonzero(np.diff(x))[-1] / FS == pytest.approx(_stops(base, 0.7), abs=0.6 * 2 * np.pi / W)
    assert _stops(Base(W, A, 0.01, PLAIN | {"dry": 0.0}, FS, 10.0, 1e-5), 1.0) == np.inf

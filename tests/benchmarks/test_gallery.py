"""The gallery of recordings: its catalogue, its own linear fit, and that it tells a refusal from a fault."""

from __future__ import annotations

import gzip
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dashpot.examples.oscillator import integrate
from dashpot.model.laws import LIBRARY
from dashpot.report.chart import Line

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
sys.path.append(str(BENCHMARKS))

from gallery import command, compare, examine, inputs, pictures, plain, run  # noqa: E402  (they lie beside the package, not in it)
from gallery.catalogue import ENTRIES, PROOF  # noqa: E402
from gallery.entry import VERDICTS, Bounds, Columns, Entry, Piece  # noqa: E402
from gallery.outcome import Effect, Errors, Outcome, as_json, from_json  # noqa: E402

DATA = inputs.data_folder()
needs_data = pytest.mark.skipif(
    not DATA.is_dir(), reason="the recordings are not here; set DASHPOT_DATA to their folder"
)
LINEAR = {"mass": 0.5, "omega0": 20.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.8, "dry": 0.0}
EFFECTS = {law.partition("/")[0] for law in LIBRARY}

# The catalogue -------------------------------------------------------------------------------------------------------


@needs_data
def test_every_recording_of_the_catalogue_is_there() -> None:
    here = {path.name for path in DATA.glob("*.csv.gz")}
    named = {piece.source for entry in ENTRIES.values() for piece in entry.pieces if "/" not in piece.source}
    assert named
    assert named <= here, "a recording that no entry names is welcome; an entry without its recording is not"


@pytest.mark.parametrize("entry", ENTRIES.values(), ids=ENTRIES)
def test_an_entry_is_consistent(entry: Entry) -> None:
    assert set(entry.documented) <= EFFECTS, "no such effect in the library"
    assert set(entry.bounds.verdicts) <= set(VERDICTS)
    assert (entry.columns is None) == (entry.kind == "imposed")
    assert entry.columns is None or (entry.columns.force is None) == (entry.kind == "free")
    assert len({piece.file for piece in entry.pieces}) == len(entry.pieces), "two pieces would be written to one file"
    assert all(piece.motion is None or 0 <= piece.motion[0] < piece.motion[1] for piece in entry.pieces)
    assert entry.linear or entry.documented or entry.kind == "imposed", "no answer would count as right"


@needs_data
@pytest.mark.parametrize("entry", ENTRIES.values(), ids=ENTRIES)
def test_the_columns_of_an_entry_are_in_its_files(entry: Entry) -> None:
    for piece in entry.pieces:
        with gzip.open(inputs.source(piece, DATA), "rt") as file:
            head = file.readline().strip().split(",")
        if entry.columns is not None and not piece.made:
            wanted = {entry.columns.response, entry.columns.force, entry.columns.time} - {None}
            assert wanted <= set(head)
        for option in ("--force", "--response"):
            if option in entry.options:
                assert entry.options[entry.options.index(option) + 1] in {*head, "none"}


def test_the_proof_names_entries() -> None:
    assert set(PROOF) <= set(ENTRIES)


def test_the_pendulum_below_the_plate_is_an_angle_in_the_plane_of_x(tmp_path: Path) -> None:
    entry = ENTRIES["magnet_pendulum_plate"]
    angle, across = np.array([0.3, -0.4, 0.1]), np.array([0.0, 0.1, -0.2])
    # a point on a sphere of 110 mm: turned by `across` out of the plane, then by `angle` in it
    x, y = 110 * np.cos(across) * np.sin(angle), 110 * np.sin(across)
    table = np.column_stack([[0.0, 0.1, 0.2], x * 654 / 148, y * 654 / 148])
    with gzip.open(tmp_path / "pixels.csv.gz", "wt") as file:
        np.savetxt(file, table, "%.9g", ",", header="time_s,x_px,y_px", comments="")
    piece = Piece("pixels.csv.gz", rows=(1, 3), name="angle.csv", made="plate-angle")
    inputs.prepare(replace(entry, training=(piece,)), tmp_path, tmp_path / "work")
    head, numbers = inputs.table(tmp_path / "work" / "angle.csv")
    assert head == ["time_s", "phi_rad"]
    np.testing.assert_allclose(numbers[:, 1], angle[1:], atol=1e-8)


# The plain fit -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("quantity", ["displacement", "velocity", "acceleration"])
def test_the_plain_fit_recovers_a_linear_decay_beside_an_offset(quantity: str) -> None:
    omega0, h, dt = 31.0, 0.4, 0.004
    t = dt * np.arange(2500)
    pole = complex(-h, np.sqrt(omega0**2 - h**2))
    order = ("displacement", "velocity", "acceleration").index(quantity)
    moved = (0.02 * pole**order * np.exp(pole * t)).real
    fit = plain.fit(dt, moved + 0.7 * np.std(moved), None, quantity)
    assert fit.omega0 == pytest.approx(omega0, rel=1e-6)
    assert fit.h == pytest.approx(h, rel=1e-4)
    assert fit.nrmse < 1e-6


def test_the_plain_fit_recovers_a_driven_linear_oscillator_and_tells_another_recording() -> None:
    dt = 0.005
    t = dt * np.arange(2000)
    force = np.sin(2 * np.pi * (1.0 * t + 0.3 * t**2))  # 1 to 7 Hz, through 3.2 Hz
    response, _ = integrate(LINEAR, force, dt)
    fit = plain.fit(dt, response, force)
    assert (fit.omega0, fit.h) == pytest.approx((LINEAR["omega0"], 0.5 * LINEAR["viscous"]), rel=2e-3)
    assert fit.gain == pytest.approx(1 / LINEAR["mass"], rel=2e-3)
    assert fit.nrmse < 2e-3
    other = np.random.default_rng(3).normal(size=1500).cumsum() / 30
    response, _ = integrate(LINEAR, other, dt)
    assert np.std(plain.held_out(fit, dt, response, other) - response) < 5e-3 * np.std(response)


def test_the_plain_fit_leaves_what_is_not_linear() -> None:
    t = 0.01 * np.arange(800)
    # a frequency that falls by a fifth with the amplitude, as that of a softening spring
    decay = np.exp(-0.3 * t)
    phase = np.cumsum(20.0 * (1 - 0.2 * decay**2)) * 0.01
    assert plain.fit(0.01, decay * np.cos(phase), None).nrmse > 0.1


# What a command said -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("exit_code", "err", "end"),
    [
        (0, "written: model.yaml\n", "done"),
        (1, "written: diagnosis\n", "done"),
        (2, "dashpot: a.csv: no column\n", "refused"),
        (1, "Traceback (most recent call last):\n  File\nValueError: no\n", "fault"),
        (2, "Traceback (most recent call last):\n  File\nValueError: no\n", "fault"),
        (-11, "", "fault"),
        (130, "", "fault"),
        (None, "12 % fit\n", "timeout"),
    ],
)
def test_a_refusal_is_no_fault_and_a_fault_no_refusal(exit_code: int | None, err: str, end: str) -> None:
    assert command.read_run(("identify",), exit_code, 1.0, err).end == end


def test_a_command_is_run_and_stopped_at_its_limit(tmp_path: Path) -> None:
    refused = command.run(["show", "absent.yaml"], tmp_path, 60.0)
    assert refused.end == "refused"
    assert "absent.yaml" in refused.last_line
    assert command.run(["demo"], tmp_path, 0.05).end == "timeout"
    assert "absent.yaml" in (tmp_path / "log.txt").read_text()


@pytest.fixture
def no_plain_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where only the verdict matters."""
    monkeypatch.setattr(examine, "_plain", lambda _entry, _work: {})


# Judged, compared, checked -------------------------------------------------------------------------------------------

ENTRY = Entry(
    "made",
    "a made recording",
    "free",
    (Piece("made.csv.gz"),),
    Columns("x_m"),
    "drag",
    documented=("quadratic-drag",),
)


def diagnosis(effect: str, *group: str, odds: float | None = None) -> dict[str, Any]:
    return {
        "verdict": "missing-physics",
        "sentence": "Something.",
        "effects": [{"effect": effect, "indistinguishable_from": list(group), "odds": odds}],
        "fit": {"train": [{"file": "made", "nrmse_before": 0.2, "nrmse_after": 0.1, "noise_floor": 0.01}]},
    }


@pytest.mark.parametrize(
    ("content", "right", "counts"),
    [
        (diagnosis("quadratic-drag"), True, "alone"),
        (diagnosis("quadratic-drag", "cubic-damping"), True, "in the group"),
        (diagnosis("cubic-damping", "quadratic-drag"), True, "in the group"),
        (diagnosis("stribeck"), False, "not documented"),
    ],
)
@pytest.mark.usefixtures("no_plain_fit")
def test_what_is_documented_counts_as_right(content: dict[str, Any], right: bool, counts: str, tmp_path: Path) -> None:
    outcome = examine.assemble(ENTRY, tmp_path, [command.read_run(("diagnose",), 0, 1.0, "")], content)
    assert outcome.right is right
    assert outcome.effects[0].counts == counts
    assert outcome.judged[0][:2] == ("made", "training")
    assert outcome.judged[0][2:] == pytest.approx((20.0, 10.0, 1.0))
    assert from_json(as_json(outcome)) == outcome


@pytest.mark.parametrize(
    ("exit_code", "err", "verdict"),
    [
        (2, "dashpot: no\n", "refused"),
        (None, "", "timeout"),
        (0, "", "fault"),
        (1, "Traceback (most recent call last)", "fault"),
    ],
)
@pytest.mark.usefixtures("no_plain_fit")
def test_no_diagnosis_is_said_with_its_reason(exit_code: int | None, err: str, verdict: str, tmp_path: Path) -> None:
    outcome = examine.assemble(ENTRY, tmp_path, [command.read_run(("identify",), exit_code, 1.0, err)], {})
    assert (outcome.verdict, outcome.right) == (verdict, False)
    imposed = replace(ENTRY, kind="imposed", columns=None)
    outcome = examine.assemble(imposed, tmp_path, [command.read_run(("identify",), exit_code, 1.0, err)], {})
    assert outcome.right is (verdict == "refused")


def inputs_of(folder: Path) -> None:
    """The file of ENTRY: a linear decay."""
    t = 0.01 * np.arange(600)
    table = np.column_stack([t, 0.01 * np.exp(-0.3 * t) * np.cos(20 * t)])
    with gzip.open(folder / "made.csv.gz", "wt") as file:
        np.savetxt(file, table, "%.9g", ",", header="time_s,x_m", comments="")


def outcome(
    verdict: str = "missing-physics", training: float | None = 2.0, holdout: float | None = 3.0, right: bool = True
):
    errors = (Errors("a", "training", 9.0, training), Errors("b", "holdout", None, holdout))
    effects = (Effect("quadratic-drag", None, (), "alone"),)
    return Outcome("made", verdict, right, "", {}, effects, errors, (), (("identify a", "done", 0, 1.5, ""),))


@pytest.mark.parametrize(
    ("new", "worse"),
    [
        (outcome(), ""),
        (outcome(training=2.03), ""),  # 1.5 %: another machine
        (outcome(training=2.05), "error in training 2 -> 2.05"),
        (outcome(training=1.0), ""),
        (outcome(holdout=None), "error held out 3 -> -"),
        (outcome("unexplained"), "missing-physics became unexplained"),
        (outcome("consistent"), ""),
        (outcome("refused"), "became refused"),
        (outcome(right=False), "no longer said"),
    ],
)
def test_what_got_worse_is_said(new: Outcome, worse: str) -> None:
    (change,) = compare.compare({"made": outcome()}, {"made": new})
    assert bool(change.worse) is bool(worse)
    assert worse in "; ".join(change.worse)
    assert ("Nothing got worse." in compare.text([change])) is not bool(worse)


def test_small_errors_and_a_better_verdict_are_no_worse() -> None:
    tiny = outcome(training=0.001), outcome(training=0.009)
    assert compare.compare({"made": tiny[0]}, {"made": tiny[1]})[0].worse == ()
    assert compare.compare({"made": outcome("fault")}, {"made": outcome("timeout")})[0].worse == ()
    assert "(new)" in compare.compare({}, {"made": outcome()})[0].row[0]


@pytest.mark.parametrize(
    ("bounds", "broken"),
    [
        (Bounds(), 0),
        (Bounds(training=2.0, holdout=3.0, verdicts=("missing-physics",)), 0),
        (Bounds(training=1.99), 1),
        (Bounds(holdout=2.99), 1),
        (Bounds(training=1.0, holdout=1.0, verdicts=("consistent", "unexplained")), 3),
    ],
)
def test_bounds(bounds: Bounds, broken: int) -> None:
    assert len(compare.broken(replace(ENTRY, bounds=bounds), outcome())) == broken


def test_a_figure_that_is_lacking_breaks_its_bound() -> None:
    assert compare.broken(replace(ENTRY, bounds=Bounds(holdout=5.0)), outcome(holdout=None))


def test_a_quick_look_asks_nothing_of_a_diagnosis_that_it_stopped() -> None:
    asked = replace(ENTRY, bounds=Bounds(training=5.0, holdout=5.0, verdicts=("consistent",)))
    stopped = outcome("timeout", holdout=None)
    assert len(compare.broken(asked, stopped)) == 2
    assert compare.broken(asked, stopped, quick=True) == []
    assert len(compare.broken(asked, outcome("timeout", training=6.0), quick=True)) == 1
    assert len(compare.broken(asked, outcome("refused", holdout=None), quick=True)) == 2


# The whole of it -----------------------------------------------------------------------------------------------------


def test_a_gallery_of_one_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    inputs_of(tmp_path)
    monkeypatch.setenv("DASHPOT_DATA", str(tmp_path))
    monkeypatch.setattr(examine, "SHORT", 0.05)  # the diagnosis does not come to an end, and that is shown as such
    folder = tmp_path / "out"
    asked = replace(ENTRY, quick=True, bounds=Bounds(training=1.0))
    entries = {"made": asked, "absent": replace(ENTRY, name="absent", quick=True, training=(Piece("absent.csv.gz"),))}
    assert run.main(["-o", str(folder), "--quick", "--check"], entries) == 0
    assert "absent.csv.gz not in" in capsys.readouterr().out
    (result,) = run.read(folder / run.JSON).values()
    assert result.verdict == "timeout"
    assert result.parameters["omega0"][0] == pytest.approx(20.0, rel=1e-3)
    assert result.errors[0].before is not None
    assert result.errors[0].before < 0.1
    assert result.errors[0].plain is not None
    assert result.errors[0].plain < 0.01
    page = (folder / run.PAGE).read_text()
    assert page.count("<figure ") == 1
    assert "timeout" in page

    again = ["-o", str(folder), "--page", "--compare", str(folder / run.JSON)]
    assert run.main(again, entries) == 0
    assert "Nothing got worse." in capsys.readouterr().out
    strict = {"made": replace(asked, bounds=Bounds(verdicts=("consistent",)))}
    assert run.main([*again, "--check"], strict) == 1
    assert "timeout, where consistent is asked for" in capsys.readouterr().out


def test_a_picture_is_in_the_unit_of_the_file_and_leaves_out_what_ran_away(tmp_path: Path) -> None:
    entry = replace(ENTRY, columns=Columns("x_mm"), training=(Piece("made.csv", motion=(2.0, 4.0)),))
    t = 0.01 * np.arange(600)
    x = 8.0 * np.exp(-0.3 * t) * np.cos(20 * t)
    part = slice(200, 400)
    np.savetxt(tmp_path / "made.csv", np.column_stack([t, x]), "%.9g", ",", header="time_s,x_mm", comments="")
    simulated = np.column_stack([t[part], 1e-3 * x[part], 1.1e-3 * x[part]])  # metres, as the commands write them
    run_away = np.where(t[part] > 3, np.nan, simulated[:, 2])
    for name, last in (("before", simulated[:, 2]), ("after", run_away)):
        rows = np.column_stack([simulated[:, :2], last])
        with gzip.open(tmp_path / f"{name}-made.csv.gz", "wt") as file:
            np.savetxt(file, rows, "%.9g", ",", header="time_s,displacement_m,simulated_displacement_m", comments="")
    near = pictures.draw(entry, entry.training[0], tmp_path).panels[2]
    lines = {mark.label: mark for mark in near.marks if isinstance(mark, Line)}
    assert set(lines) == {"measured", "identified"}
    assert lines["measured"].x[0] >= 2.0
    both = [line.y for line in lines.values()]
    np.testing.assert_allclose(both[1], 1.1 * both[0], atol=1e-6)


def test_a_wrong_name_or_file_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run.main(["nothing"])
    assert "known: pendulum_1" in capsys.readouterr().err
    (tmp_path / "old.json").write_text("[]")
    with pytest.raises(SystemExit):
        run.main(["-o", str(tmp_path), "--compare", str(tmp_path / "old.json"), "--page"])
    assert "is no dashpot-gallery/1" in capsys.readouterr().err


def test_the_proof_gets_its_rows() -> None:
    from dashpot.examples.concealed import scoreboard

    tested = Errors("arrow.csv", "test", 0.5, 0.4, None, 3e-4, 2e-4)
    judged = (("train", "training", 2.0, 1.0, 0.5), ("holdout", "holdout", None, 1.5, 0.5))
    row = run.proof_row(replace(outcome(), errors=(tested,), judged=judged))
    assert row["records"] == [["train", False, 0.02, 0.01, 0.005], ["holdout", True, None, 0.015, 0.005]]
    assert row["tests"] == [["test arrow", pytest.approx(0.3), pytest.approx(0.2), "mV"]]
    template = (Path(scoreboard.__file__).parent / "scoreboard.html.j2").read_text()
    assert all(f"one.{name}" in template for name in ("name", "verdict", "laws", "records", "tests", "seconds"))
    assert {"name", "verdict", "laws", "records", "tests", "seconds"} <= set(row)


def test_the_script_starts_as_the_proof_starts_it(tmp_path: Path) -> None:
    script = [sys.executable, "-P", str(BENCHMARKS / "recorded.py"), "--help"]
    said = subprocess.run(script, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert all(name in said for name in PROOF)

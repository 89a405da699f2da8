"""The commands of README.md and docs/, typed in an empty folder beside recordings, in order, do what is said."""

from __future__ import annotations

import gzip
import json
import re
import shlex
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from dashpot.commands.cli import cli
from dashpot.examples.force import chirp, multisine
from dashpot.examples.oscillator import integrate_pieces
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator, Response
from dashpot.model.file import load, save

ROOT = Path(__file__).resolve().parents[1]
PAGES = {
    page.relative_to(ROOT).as_posix(): page.read_text("utf-8")
    for page in [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md"))]
    if page.parent.name != "gallery"  # those are run when the site is built, tests/docs/test_gallery.py
}
FS, NOISE = 500.0, 1e-6
#: Recordings that the README's commands read.
RECORDED = {
    *("decays.csv", "sweep.csv.gz", "another.csv", "decay.csv", "more.csv"),
    *("sweep_high.csv", "sweep_low.csv", "multisine.csv", "decay_low.csv"),
}
#: Recordings that the tutorial's Python gets from the built-in stands.
COPIED = {
    *("bursts.csv.gz", "sweep_low.csv.gz", "sweep_high.csv.gz", "multisine.csv.gz"),
    *("play_bursts.csv.gz", "play_sweep_low.csv.gz", "play_sweep_high.csv.gz"),
}
#: Pages with a worked example, which makes its recordings in Python, and what these are.
WORKED = {
    "docs/noise.md": {"bursts.csv.gz", "sweep_low.csv.gz", "sweep_high.csv.gz", "multisine.csv.gz"}
    | {"play_bursts.csv.gz", "play_sweep_low.csv.gz"},
    "docs/diagnosis.md": {"sweep_high.csv.gz", "sweep_low.csv.gz", "ringdown.csv.gz"}
    | {"holdout_multisine.csv.gz", "holdout_sweep.csv.gz"},
}
#: Models that a page speaks of as there already.
MODELS = {"rig.yaml", "roll.yaml"}


def commands(page: str) -> list[list[str]]:
    """The lines of the page's console blocks, as a shell would split them, without their comments."""
    blocks = re.findall(r"```console\n(.*?)```", PAGES[page], re.DOTALL)
    lines = "".join(blocks).replace("\\\n", " ").splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def done(words, folder):
    """What the command printed, which ended well and wrote its files."""
    ended = typed(words, folder)
    assert ended.returncode == 0, f"{shlex.join(words)}: {ended.stdout}{ended.stderr}"
    for name in written(words):
        assert (folder / name).exists(), f"{shlex.join(words)} wrote no {name}"
    return ended.stdout


def written(words: list[str]) -> list[str]:
    """The files and folders that a command is told to write."""
    named = [after for word, after in pairwise(words) if word in ("-o", "--report", "--json", "--page")]
    return named + ([word for word in words[3:] if re.search(r"\.[a-z]", word)] if words[1] == "export" else [])


TUTORIAL = "docs/tutorial.md"
HOUSE = "docs/howto/fleet.md"
#: Pages whose commands are typed beside the README's recordings; fast ones, and those that identify or build.
TYPED = {
    "docs/hosts/joints.md": (),
    "docs/programs.md": (),
    "docs/control.md": pytest.mark.long,
    **{f"docs/hosts/{host}.md": pytest.mark.long for host in ("simulink", "openmodelica", "dymola", "amesim")},
    **{f"docs/howto/{path}.md": pytest.mark.long for path in ("vibration", "system", "control", "before")},
}


def makes_its_model(page: str) -> bool:
    """Whether the page identifies the model that its commands are about."""
    return any(words[:2] == ["dashpot", "identify"] for words in commands(page))


def typed(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run one command in the folder, the installed package in place of the script on the path."""
    assert words[0] == "dashpot"
    line = [sys.executable, "-P", "-m", "dashpot", *words[1:]]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)


def test_there_are_commands_to_run():
    assert {page for page in PAGES if commands(page)} == {
        *TYPED,
        *WORKED,
        "README.md",
        "docs/fleets.md",
        HOUSE,
        "docs/formats.md",
        "docs/laws.md",
        TUTORIAL,
    }
    assert [words[1] for words in commands("README.md") if words[0] == "make"] == ["demo", "test"]
    assert sum(words[0] == "dashpot" for words in commands("README.md")) == 6
    assert sum(words[0] == "dashpot" for words in commands("docs/laws.md")) == 3


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)])
def test_commands_and_options_exist_and_inputs_are_there_when_they_are_read(page):
    there = set(COPIED) if page == TUTORIAL else {*WORKED.get(page, {*RECORDED, "magnet.py", "fleet.yaml"})}
    there |= MODELS if page in TYPED and not makes_its_model(page) else set()
    for words in commands(page):
        if words[0] == "make":
            continue
        command = cli.commands[words[1]]
        known = {name for option in command.params for name in option.opts}
        assert {word for word in words if word.startswith("-")} <= known
        made = written(words)
        files = {word for word in words[2:] if re.fullmatch(r"[\w/]+\.(csv(\.gz)?|yaml|fmu|py)", word)}
        assert files - set(made) <= there, words
        there |= set(made)


def recording(force, start=0.0, seed=0):
    """Time, force and displacement of the paper's stand, by the integrator that shares no code with the product."""
    x = integrate_pieces(TRUTH, force, 1 / FS, start, 0.0)[0][: len(force)]
    x = x + NOISE * np.random.default_rng(seed).standard_normal(x.size)
    return np.column_stack([np.arange(x.size) / FS, force[:, 0], x])


def write(path: Path, table: np.ndarray, header: str) -> None:
    opener = gzip.open if path.suffix == ".gz" else open
    with opener(path, "wt") as file:
        np.savetxt(file, table, "%.9g", ",", header=header, comments="")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The recordings that the README names, made once."""
    folder = tmp_path_factory.mktemp("recorded")
    t, still = np.arange(round(12 * FS)) / FS, np.zeros((round(4 * FS), 2))
    lines, phases = np.arange(5.0, 20.0, 0.25), np.random.default_rng(7).uniform(0, 2 * np.pi, 60)
    forced = {
        "sweep.csv.gz": chirp(1.0, 8.0, 10.0 / 12, t, 1 / FS),
        "another.csv": chirp(0.6, 18.0, -10.0 / 12, t, 1 / FS),
        "more.csv": chirp(0.8, 9.0, 9.0 / 12, t, 1 / FS),
        "sweep_high.csv": chirp(1.0, 8.0, 10.0 / 12, t, 1 / FS),
        "sweep_low.csv": chirp(0.4, 8.0, 10.0 / 12, t, 1 / FS),
        "multisine.csv": multisine(0.08, lines, phases, t, 1 / FS),
    }
    free = {"decays.csv": 8e-3, "decay.csv": 7e-3, "decay_low.csv": 5e-3}
    for seed, (name, force) in enumerate(forced.items()):
        write(folder / name, recording(force, seed=seed), "time_s,force_N,displacement_m")
    for seed, (name, start) in enumerate(free.items()):
        table = recording(still, start, 10 + seed)
        write(folder / name, table[:, [0, 2]], "time_s,displacement_m")
    assert {path.name for path in folder.iterdir()} == RECORDED
    return folder


@pytest.fixture
def stand(tmp_path, recorded):
    """A folder with nothing but these recordings."""
    return Path(shutil.copytree(recorded, tmp_path / "stand"))


@pytest.mark.long
def test_the_commands_of_the_readme_do_what_it_says(stand):
    """Each ends with 0, as nothing is wrong with this rig, and leaves what it was told to write."""
    said = []
    for words in commands("README.md"):
        if words[0] == "make":
            continue  # tests/face/test_demo.py, tests/test_readme.py
        said.append(done(words, stand))
        if words[1] == "identify":
            check_identified(stand, words)
        if words[1] == "verify":
            assert json.loads((stand / "verify.json").read_text("utf-8"))["pass"] is True
    # nothing is missing: what the README says a diagnosis then says
    diagnosis = json.loads((stand / "diagnosis" / "diagnosis.json").read_text("utf-8"))
    assert diagnosis["verdict"] == "consistent"
    assert diagnosis["effects"] == []
    assert {row["file"] for row in diagnosis["fit"]["holdout"]} == {"multisine.csv", "decay_low.csv"}
    for row in [*diagnosis["fit"]["train"], *diagnosis["fit"]["holdout"]]:
        assert row["nrmse_before"] < 1.5 * row["noise_floor"], row["file"]
    assert said[-1].startswith("✓ Consistent.")


def check_identified(folder: Path, words: list[str]) -> None:
    """What an identification found of the stand, by its own standard errors."""
    model = load(folder / words[words.index("-o") + 1])
    fixed = {word.partition("=")[0] for word in words if "=" in word}
    for name, true in TRUTH.items():
        parameter = model.parameters()[name]
        if name in fixed:
            assert parameter.value == 0.0
        elif not fixed and parameter.std:
            assert abs(parameter.value - true) < 5 * parameter.std, f"{shlex.join(words)}: {name}"


@pytest.mark.parametrize("page", [pytest.param(page, marks=marks) for page, marks in TYPED.items()])
def test_the_commands_of_a_page_leave_what_they_were_told_to(page, tmp_path, request):
    """Beside the README's recordings, and where the page does not identify them, models of the stand and of a roll."""
    reads = any(word in RECORDED for words in commands(page) for word in words)
    stand = request.getfixturevalue("stand") if reads else tmp_path
    if not makes_its_model(page):
        save(Oscillator.from_values(TRUTH, name="rig"), stand / "rig.yaml")
        angle = Response("displacement", "rad")
        save(Oscillator.from_values(TRUTH, name="roll", response=angle, force_unit="N.m"), stand / "roll.yaml")
    for words in commands(page):
        done(words, stand)


@pytest.mark.long
def test_the_tutorial_does_what_it_says(tmp_path, monkeypatch):
    """Its Python and its commands, in the order of the page, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    for kind, block in re.findall(r"```(python|console)\n(.*?)```", PAGES[TUTORIAL], re.DOTALL):
        if kind == "python":
            exec(compile(block, TUTORIAL, "exec"), {})
        for words in map(shlex.split, block.splitlines()) if kind == "console" else ():
            if words[0] == "make":
                continue
            done(words, tmp_path)
            if "rig.yaml" in written(words):
                check_identified(tmp_path, words)
    assert {path.name for path in tmp_path.iterdir()} >= COPIED
    diagnosis = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text("utf-8"))
    assert [row["effect"] for row in diagnosis["effects"]] == ["actuator-backlash"]


@pytest.mark.long
@pytest.mark.parametrize("page", WORKED)
def test_a_worked_example_gives_what_the_page_says(page, tmp_path, monkeypatch):
    """In an empty folder; the figures that the page's text takes from the answers."""
    monkeypatch.chdir(tmp_path)
    for kind, block in re.findall(r"```(python|console)\n(.*?)```", PAGES[page], re.DOTALL):
        if kind == "python":
            exec(compile(block, page, "exec"), {})
        for words in map(shlex.split, block.splitlines()) if kind == "console" else ():
            done(words, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} >= WORKED[page]
    if page == "docs/noise.md":
        check_identified(tmp_path, ["-o", "rig.yaml"])
        over_noise = {name: left_of(tmp_path / name) for name in ("rig.yaml", "play.yaml")}
        assert max(over_noise["rig.yaml"]) < 1.1
        assert over_noise["play.yaml"] == pytest.approx([31, 20], rel=0.1)
    else:
        diagnosis = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text("utf-8"))
        assert [row["effect"] for row in diagnosis["effects"]] == ["quadratic-drag"]
        coefficient = diagnosis["effects"][0]["parameters"]["coefficient"]
        assert abs(coefficient["value"] - 17.579) < 4 * coefficient["std"]
        for row in diagnosis["fit"]["holdout"]:
            assert row["nrmse_after"] < 1.05 * row["noise_floor"] < 0.3 * row["nrmse_before"], row["file"]


def left_of(model: Path) -> list[float]:
    """What an identified model leaves of each of its recordings, in times the noise."""
    return [float(row["over_noise"]) for row in load(model).identified.recordings]


@pytest.mark.parametrize("page", ["docs/howto/control.md"])
def test_the_python_of_a_page_runs(page, capsys):
    for block in re.findall(r"```python\n(.*?)```", PAGES[page], re.DOTALL):
        exec(compile(block, page, "exec"), {})
        assert capsys.readouterr().out.strip()


@pytest.mark.long
def test_the_commands_on_formats_do_what_they_say(stand):
    before = sorted(stand.iterdir())
    decays, sweep, _ = (typed(words, stand) for words in commands("docs/formats.md"))
    assert "motion     decay" in decays.stdout
    assert json.loads(sweep.stdout)[0]["recordings"][0]["motion"] == "sweep"
    assert sorted(stand.iterdir()) == sorted([*before, stand / "look.html"])


def test_the_manifest_of_the_page_on_fleets_is_one(stand):
    from dashpot.fleet.manifest import read_manifest

    entries = read_manifest(manifest_of_the_page(stand)).entries
    assert [entry.name for entry in entries] == ["monday", "tuesday", "friday", "decay_low"]
    assert {Path(name).name for entry in entries for name in (*entry.recordings, *entry.holdout)} <= RECORDED


def manifest_of_the_page(folder: Path) -> Path:
    (text,) = re.findall(r"```yaml\n(.*?)```", PAGES["docs/fleets.md"], re.DOTALL)
    (folder / "fleet.yaml").write_text(text, encoding="utf-8")
    return folder / "fleet.yaml"


@pytest.mark.long
def test_the_commands_on_fleets_do_what_they_say(stand):
    """Nothing is wrong with this rig, and nothing changes: each ends with 0."""
    manifest_of_the_page(stand)
    said = [done(words, stand) for words in commands("docs/fleets.md")]
    assert said[0] == "4 rows: 4 good\n"
    assert said[1].startswith("stand: Nothing moved")
    assert said[-1].startswith("Nothing moved")


@pytest.mark.long
def test_the_commands_for_a_test_house_do_what_they_say(tmp_path, monkeypatch):
    """In an empty folder: one bad file spoils one row, and nothing changed."""
    monkeypatch.chdir(tmp_path)
    (python,) = re.findall(r"```python\n(.*?)```", PAGES[HOUSE], re.DOTALL)
    (manifest,) = re.findall(r"```yaml\n(.*?)```", PAGES[HOUSE], re.DOTALL)
    exec(compile(python, HOUSE, "exec"), {})
    (tmp_path / "fleet.yaml").write_text(manifest, encoding="utf-8")
    batch, watch, compare = commands(HOUSE)
    ended = typed(batch, tmp_path)
    assert ended.returncode == 1
    assert ended.stdout.splitlines()[-1] == "4 rows: 3 good, 1 bad-input"
    assert "broken.csv: line 3, column 'x_mm' holds 'no'" in ended.stdout + (ended.stderr or "")
    assert done(watch, tmp_path).startswith("stand: Nothing moved")
    models = [str(next(tmp_path.glob(word))) if "*" in word else word for word in compare]
    assert done(models, tmp_path).startswith("Nothing moved")


@pytest.mark.long
def test_bad_input_ends_with_2_and_nothing_is_written(stand):
    before = sorted(stand.iterdir())
    ended = typed(["dashpot", "identify", "absent.csv", "-o", "rig.yaml"], stand)
    assert ended.returncode == 2
    assert ended.stderr.strip().count("\n") == 0  # one sentence
    assert sorted(stand.iterdir()) == before


@pytest.mark.long
def test_bad_news_ends_with_1(stand):
    """A model of another rig does not pass its proof."""
    model = ["dashpot", "identify", "sweep.csv.gz", "-o", "rig.yaml", "--fix", "mass=0.3"]
    assert typed(model, stand).returncode in (0, 1)
    assert typed(["dashpot", "export", "rig.yaml", "rig.fmu"], stand).returncode == 0
    assert typed(["dashpot", "verify", "rig.fmu", "another.csv"], stand).returncode == 1


@pytest.mark.long
def test_the_commands_for_a_law_of_ones_own_do_what_they_say(tmp_path):
    """docs/laws.md, on a decay of its magnet by scipy."""
    from scipy.integrate import solve_ivp

    (example,) = re.findall(r"```python\n(.*?)```", PAGES["docs/laws.md"], re.DOTALL)[:1]
    (tmp_path / "magnet.py").write_text(example, encoding="utf-8")
    omega, viscous, strength, reach = 30.0, 0.8, 4.0, 3e-3

    def rate(_t, z):
        pull = strength * z[0] / reach * np.exp(-((z[0] / reach) ** 2))
        return [z[1], -viscous * z[1] - omega**2 * z[0] - pull]

    t = np.arange(round(8 * FS)) / FS
    x = solve_ivp(rate, (0, t[-1]), [9e-3, 0.0], t_eval=t, rtol=1e-10, atol=1e-14).y[0]
    x = x + NOISE * np.random.default_rng(5).standard_normal(t.size)
    write(tmp_path / "decay.csv", np.column_stack([t, x]), "time_s,displacement_m")
    said = [done(words, tmp_path) for words in commands("docs/laws.md")]
    match = re.search(r"magnet\.strength +(\S+) +± (\S+)", said[1])
    assert match
    assert float(match.group(1)) == pytest.approx(strength, rel=0.02)

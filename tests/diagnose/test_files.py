"""A diagnosis in one folder: what is written, what of an earlier one goes, and what is refused beforehand."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dashpot.diagnose.files import check_folder, experiment_csv, write_folder
from dashpot.diagnose.result import Diagnosis, Experiment
from dashpot.errors import BadInput
from dashpot.examples.truth import TRUTH
from dashpot.model import Oscillator
from dashpot.model.file import loads

BEFORE, MODEL = (Oscillator.from_values(TRUTH | {"viscous": viscous}) for viscous in (5.0, 4.0))
SIGNAL = np.array([0.0, 0.5, -0.25])


def experiment(signal: np.ndarray | None) -> Experiment:
    return Experiment("play it", "sweep", 0.5, (5.0, 20.0), 0.006, (), signal, 500.0)


def diagnosis(proposed: Experiment | None = None, sentence: str = "Nothing is missing.") -> Diagnosis:
    return Diagnosis("consistent", sentence, (), None, BEFORE, MODEL, (), (), proposed, None, (), ())


def test_everything_is_written_and_can_be_read_again(tmp_path):
    folder = tmp_path / "new" / "folder"
    said = diagnosis(experiment(SIGNAL), sentence="4.1 µm are missing.")
    written = write_folder(folder, said, "<p>déjà vu</p>", b"an FMU")
    names = ["diagnosis.json", "model.yaml", "model.fmu", "next_experiment.csv", "report.html"]
    assert written == [folder / name for name in names]
    assert sorted(path.name for path in folder.iterdir()) == sorted(names)  # nothing temporary stays
    text = (folder / "diagnosis.json").read_text(encoding="utf-8")
    assert json.loads(text) == said.as_json()
    assert "4.1 µm" in text  # for people too
    assert text.endswith("}\n")
    assert '\n  "verdict"' in text
    assert loads((folder / "model.yaml").read_text(encoding="utf-8")).values() == MODEL.values()
    assert (folder / "model.fmu").read_bytes() == b"an FMU"
    assert (folder / "report.html").read_text(encoding="utf-8") == "<p>déjà vu</p>"


def test_what_an_earlier_diagnosis_left_does_not_pass_for_this_ones(tmp_path):
    write_folder(tmp_path, diagnosis(experiment(SIGNAL)), "first", b"an FMU")
    written = write_folder(tmp_path, diagnosis(), "second", None)
    kept = ["diagnosis.json", "model.yaml", "report.html"]
    assert [path.name for path in written] == kept
    assert sorted(path.name for path in tmp_path.iterdir()) == kept
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == "second"


def test_the_force_to_play_stands_beside_its_time():
    assert experiment_csv(experiment(SIGNAL)) == "time_s,force\n0,0\n0.002,0.5\n0.004,-0.25\n"


@pytest.mark.parametrize("proposed", [None, experiment(None)])
def test_where_no_force_is_to_be_played_there_is_no_table(proposed):
    assert experiment_csv(proposed) is None


def test_a_folder_that_can_be_written_is_left_as_it_was(tmp_path):
    check_folder(tmp_path)
    assert list(tmp_path.iterdir()) == []
    check_folder(tmp_path / "new")
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_the_folders_place_is_refused_with_its_name(tmp_path):
    place = tmp_path / "result"
    place.write_text("", encoding="utf-8")
    with pytest.raises(BadInput, match=r"result: is a file; name a folder"):
        check_folder(place)


@pytest.mark.parametrize("name", ["diagnosis.json", "model.yaml", "model.fmu", "next_experiment.csv", "report.html"])
def test_a_folder_in_a_files_place_is_refused_before_any_work(tmp_path, name):
    (tmp_path / name).mkdir()
    with pytest.raises(BadInput, match=name):
        check_folder(tmp_path)

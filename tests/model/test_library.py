"""The library of laws: what takes a law refuses none halfway, and a model with laws goes to another process."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from dataclasses import replace

import pytest
from dashpot.errors import BadInput
from dashpot.model import Oscillator, oscillator_with
from dashpot.model.file import dumps, loads
from dashpot.model.laws import LIBRARY, MODES
from dashpot.model.library import KNOWN, find, take

PLAIN = {"mass": 0.3, "omega0": 60.0, "cubic": 0.0, "preload": 0.0, "viscous": 3.0, "dry": 0.0}
DRAG = {**PLAIN, "quadratic-drag.coefficient": 2.0}


def test_a_term_holds_the_law_of_its_name():
    model = oscillator_with(DRAG, ["quadratic-drag"])
    assert model.terms[0].law is find("quadratic-drag")
    assert model.terms[0].effect == "quadratic-drag"
    assert model == Oscillator.from_values(DRAG, laws=[LIBRARY["quadratic-drag"]])
    with pytest.raises(BadInput, match="did you mean quadratic-drag"):
        oscillator_with(DRAG, ["quadratic-darg"])


def test_a_model_with_laws_goes_to_another_process(tmp_path):
    """Pickled by the law's name, which a Python that has imported nothing of it finds."""
    model = oscillator_with(DRAG, ["quadratic-drag"])
    assert pickle.loads(pickle.dumps(model)) == model
    (tmp_path / "model").write_bytes(pickle.dumps(model))
    program = f"import pickle; print(pickle.load(open({str(tmp_path / 'model')!r}, 'rb')).terms[0].law.path)"
    run = subprocess.run([sys.executable, "-P", "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "dissipation\n"


def test_a_law_of_ones_own_goes_where_it_was_taken(monkeypatch):
    law = replace(LIBRARY["quadratic-drag"], name="drag-of-mine")
    monkeypatch.setitem(KNOWN, law.name, law)
    text = pickle.dumps(Oscillator.from_values({**PLAIN, "drag-of-mine.coefficient": 2.0}, laws=[law]))
    assert pickle.loads(text).terms[0].law is law
    monkeypatch.delitem(KNOWN, law.name)
    with pytest.raises(BadInput, match="'drag-of-mine' is not in the library"):
        pickle.loads(text)


def test_a_law_that_the_library_does_not_have_is_copied_as_a_value():
    law = replace(LIBRARY["quadratic-drag"], name="drag-of-mine")
    assert copy.deepcopy(law) == law
    assert copy.deepcopy(law) is not law


def test_of_two_laws_none_is_taken_where_one_fails():
    good = replace(LIBRARY["quadratic-drag"], name="drag-of-mine")
    bad = replace(good, name="drag-of-yours", force=lambda motion, p: p["coefficient"] * motion.v)
    with pytest.raises(BadInput, match=r"drag-of-yours.*does not come out in its unit"):
        take([good, bad], "mine.py")
    assert not {"drag-of-mine", "drag-of-yours"} & set(KNOWN)


def test_the_laws_of_the_package_are_data():
    with pytest.raises(TypeError):
        LIBRARY["mine"] = LIBRARY["quadratic-drag"]  # type: ignore[index]


@pytest.mark.parametrize("effect", MODES)
def test_further_modes_are_found_by_name_and_asked_for_by_no_diagnosis(effect):
    law = find(effect)
    assert pickle.loads(pickle.dumps(law)) is law
    assert effect not in KNOWN
    values = {"omega0": 1.0, "cubic": 0.0, "preload": 0.0, "viscous": 0.1, "dry": 0.0}
    values |= {f"{effect}.participation": 1.0, f"{effect}.frequency": 2.0, f"{effect}.viscous": 0.2}
    model = oscillator_with(values, [effect])
    assert loads(dumps(model)).values() == model.values()
